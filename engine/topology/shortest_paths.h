// Shortest paths along edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/topology/edge_path.h"

namespace ricci {

/// The steps that leave every vertex, grouped by vertex, in ascending order within a group.
struct VertexStars {
    std::vector<Index> first;  // V+1
    std::vector<Step> step;    // 2E

    [[nodiscard]] std::span<const Step> leaving(Index v) const {
        const auto begin = static_cast<std::size_t>(first[static_cast<std::size_t>(v)]);
        const auto end = static_cast<std::size_t>(first[static_cast<std::size_t>(v) + 1]);
        return std::span(step).subspan(begin, end - begin);
    }
};
VertexStars vertex_stars(const Connectivity& connectivity);

/// A tree of shortest paths from a root.
struct ShortestPaths {
    Index root = 0;
    std::vector<double> distance;  // V, in the unit of the lengths; infinite where no path leads
    std::vector<Step> arriving;    // V, the tree's step into the vertex; kNoStep at the root and unreached

    /// The steps from the root to v, which must be reachable.
    [[nodiscard]] EdgePath path_to(const Connectivity& connectivity, Index v) const;
};

/// Dijkstra's algorithm. `length`: 3F, positive. `avoided` (V, or empty): a path runs through as few of these
/// vertices as it can and only then is shortest; where the others are connected without them, they are leaves
/// of the tree. Ties go to the vertex of lower number, so equal input gives an equal tree.
ShortestPaths shortest_paths(const Connectivity& connectivity, const VertexStars& stars,
                             std::span<const double> length, Index root,
                             std::span<const std::uint8_t> avoided = {});

/// A vertex in the middle of the surface: one whose greatest distance to any other is small. From the
/// vertices that are used and not `excluded` (V, or empty), and of these from the ones not on the boundary
/// where there are any, it repeatedly takes the one whose greatest distance to the landmarks so far is least
/// and makes the vertex farthest from it the next landmark, until that bound is attained (the centre then is
/// exact, and independent of numbering but for ties) or after eight rounds, when the best one seen is
/// returned. Ties go to the lowest number. Returns -1 where every used vertex is excluded.
Index choose_base(const Connectivity& connectivity, std::span<const double> length,
                  std::span<const std::uint8_t> excluded = {});

}  // namespace ricci
