// Distances between all shapes of a type, and agglomerative hierarchical clustering of them.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/shape_space/neighbours.h"

namespace ricci {

/// A symmetric matrix of distances.
struct DistanceMatrix {
    std::size_t size = 0;
    std::vector<double> values;  // size x size, row by row; 0 on the diagonal

    [[nodiscard]] double operator()(std::size_t i, std::size_t j) const { return values[i * size + j]; }
};

/// Distances between all shapes (thesis Table 6); NaN where one of them has none. Rows in parallel where
/// asked, with the same bits. // N x N
DistanceMatrix distance_matrix(const ShapeVectors& shapes, bool parallel);

/// Distance of two clusters: the mean over pairs of members, the smallest, the largest.
enum class Linkage : std::uint8_t { average, single, complete };
std::string_view name_of(Linkage linkage);

/// Two clusters become one. Clusters 0 .. N-1 are the shapes, N + k is what the k-th merge makes.
struct Merge {
    std::size_t first = 0, second = 0;  // first holds the lower lowest member
    double height = 0.0;                // their distance
    std::size_t members = 0;            // of the new cluster
    bool operator==(const Merge&) const = default;
};

/// A binary tree over the shapes. Every merge comes after those that make its clusters.
struct Dendrogram {
    std::size_t leaves = 0;
    std::vector<Merge> merges;  // leaves - 1, ascending by height
};

/// Clusters by the nearest-neighbour chain (Murtagh 1983): O(N^2) time, the same tree as merging the nearest
/// pair again and again where distances differ. Throws std::invalid_argument for distances that are not
/// finite and not negative.
Dendrogram cluster_shapes(const DistanceMatrix& distances, Linkage linkage);

/// Shapes from left to right such that no branches cross; the first cluster of a merge comes first. // leaves
std::vector<std::size_t> leaf_order(const Dendrogram& tree);

/// The cluster of each shape when the last merges are undone until `count` clusters are left (or as many as
/// there are shapes); numbered from 0 by lowest member. Throws std::invalid_argument for count 0. // leaves
std::vector<std::size_t> flat_clusters(const Dendrogram& tree, std::size_t count);

}  // namespace ricci
