// Distances within a topological type of an index, and clusters by them.
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

/// Leaves out shapes without the vector asked for (no coordinates), which is logged. `clusters`: the tree is
/// cut into so many; 0: one.
TypeDistances distances_of(const IndexBucket& bucket, ShapeMetric metric, Linkage linkage,
                           std::size_t clusters);

}  // namespace ricci::app
