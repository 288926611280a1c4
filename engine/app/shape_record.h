// From a surface to what the index keeps of it.
#pragma once

#include <vector>

#include "engine/shape_space/shape_descriptor.h"
#include "io/store/shape_index.h"

namespace ricci::app {

/// Describes a surface at every resolution (face counts, 0: as it is). The finest is the record; where there
/// are several, all are kept in `resolutions`, ascending by faces. Whatever goes wrong is the record's status
/// and message; hash and component are the caller's to set.
ShapeRecord describe_to_record(const SurfaceMesh& mesh, const ShapeOptions& options,
                               const std::vector<Index>& resolutions);

}  // namespace ricci::app
