// A surface of polygons: what disks are grown on, be it the input's faces or the pieces of a refinement.
#pragma once

#include <vector>

#include "engine/refinement/common_refinement.h"

namespace ricci {

/// Corner c of polygon p, first[p] <= c < first[p+1], owns the side from its vertex to that of the next.
struct PolygonSurface {
    Index vertex_count = 0;
    std::vector<Index> first;                  // P+1
    std::vector<Index> vertex, twin, polygon;  // per corner; twin -1 on the boundary

    [[nodiscard]] Index polygon_count() const { return static_cast<Index>(first.size()) - 1; }
    [[nodiscard]] Index corner_count() const { return static_cast<Index>(vertex.size()); }
    [[nodiscard]] Index previous(Index corner) const {
        const auto p = static_cast<std::size_t>(polygon[static_cast<std::size_t>(corner)]);
        return corner == first[p] ? first[p + 1] - 1 : corner - 1;
    }
    [[nodiscard]] Index next(Index corner) const {
        const auto p = static_cast<std::size_t>(polygon[static_cast<std::size_t>(corner)]);
        return corner + 1 == first[p + 1] ? first[p] : corner + 1;
    }
    /// The polygon on the other side, or -1.
    [[nodiscard]] Index across(Index corner) const {
        const Index t = twin[static_cast<std::size_t>(corner)];
        return t < 0 ? -1 : polygon[static_cast<std::size_t>(t)];
    }
};

/// The faces as polygons; corners are halfedges.
PolygonSurface polygons_of(const Connectivity& connectivity);
/// The pieces as polygons.
PolygonSurface polygons_of(const CommonRefinement& refinement);

/// One corner of every vertex, the lowest, or -1. // V
std::vector<Index> lowest_corners(const PolygonSurface& surface);

/// Polygons around the vertex of a corner counterclockwise, at the boundary from its first.
std::vector<Index> star_of(const PolygonSurface& surface, Index corner);

/// Number of sides crossed on the way from the nearest of `sources` through `allowed` polygons (empty: all);
/// -1 where there is no way. // P
std::vector<Index> dual_distances(const PolygonSurface& surface, const std::vector<Index>& sources,
                                  const std::vector<std::uint8_t>& allowed = {});

}  // namespace ricci
