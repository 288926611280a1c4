// From shapes as stored to vectors that have distances.
#pragma once

#include <string>

#include "engine/shape_space/clustering.h"
#include "io/store/shape_index.h"

namespace ricci::app {

/// "spectrum", "coordinates"; "average", "single", "complete". Throw UsageError.
ShapeMetric parse_shape_metric(const std::string& text);
Linkage parse_linkage(const std::string& text);

/// Fingerprints or coordinates of a type.
ShapeVectors shape_vectors(const IndexBucket& bucket, ShapeMetric metric);

}  // namespace ricci::app
