#include "engine/app/type_distances.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "engine/app/index_vectors.h"

namespace ricci::app {
namespace {

/// Leaves out shapes without the vector asked for (no coordinates), which is logged.
ShapeVectors known_vectors(const IndexBucket& bucket, ShapeMetric metric, std::vector<std::string>& names) {
    ShapeVectors all = shape_vectors(bucket, metric), known = all;
    known.values.clear();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::string name = shape_name(bucket.files[i], bucket.component[i], bucket.components[i]);
        const std::span<const double> row = all.row(i);
        if (!std::all_of(row.begin(), row.end(), [](double v) { return std::isfinite(v); })) {
            spdlog::warn("{}: has no {}, left out", name, name_of(metric));
            continue;
        }
        names.push_back(name);
        known.values.insert(known.values.end(), row.begin(), row.end());
    }
    return known;
}

}  // namespace

TypeDistances measure_distances(const IndexBucket& bucket, ShapeMetric metric, Linkage linkage,
                                std::size_t clusters) {
    TypeDistances d;
    d.type = type_name(bucket.genus, bucket.boundaries);
    const ShapeVectors vectors = known_vectors(bucket, metric, d.names);
    d.matrix = distance_matrix(vectors, true);
    d.tree = cluster_shapes(d.matrix, linkage);
    d.order = leaf_order(d.tree);
    d.clusters = flat_clusters(d.tree, clusters > 0 ? clusters : 1);
    return d;
}

}  // namespace ricci::app
