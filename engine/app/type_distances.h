// Distances between the shapes of one topological type of an index.
#pragma once

#include <string>
#include <vector>

#include "engine/shape_space/clustering.h"
#include "io/store/shape_index.h"

namespace ricci::app {

/// The shapes of one type that have a distance, and everything said about them.
struct TypeDistances {
    std::string type;
    std::vector<std::string> names;
    DistanceMatrix matrix;
    Dendrogram tree;
    std::vector<std::size_t> order, clusters;
};

/// Distances of all pairs, their tree, and so many clusters (0: one). Shapes without the vector asked for (no
/// coordinates) are left out, which is logged. Uses as many threads as the caller may.
TypeDistances measure_distances(const IndexBucket& bucket, ShapeMetric metric, Linkage linkage,
                                std::size_t clusters);

}  // namespace ricci::app
