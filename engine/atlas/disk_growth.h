// Disks of polygons, grown one polygon at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/atlas/polygon_surface.h"

namespace ricci {

/// A polygon may join when what it has in common with the disk is an arc: a chain of sides, not all of them,
/// and no vertex besides; so the union is a closed disk again, at every step. A polygon that has a vertex
/// twice never joins, nor does one that would bring a cone inside.
class DiskGrowth {
  public:
    /// `cone`: one per vertex, 1 where it must stay on the rim. `surface` must outlive the result.
    DiskGrowth(const PolygonSurface& surface, std::span<const std::uint8_t> cone);

    /// Polygons in the order in which they joined, so that every beginning is a disk: first those of `start`
    /// in order, then the `allowed` (one per polygon; empty: all) nearest to the first, counted across sides,
    /// ties to the lower number, until `limit` are reached or none may join. Empty where `start` is no disk.
    std::vector<Index> grow(std::span<const Index> start, const std::vector<std::uint8_t>& allowed,
                            std::size_t limit);

  private:
    [[nodiscard]] bool is_in(Index polygon) const;
    [[nodiscard]] bool has_a_vertex_twice(Index polygon) const;
    [[nodiscard]] bool may_join(Index polygon) const;
    void join(Index polygon);

    const PolygonSurface& s_;
    std::vector<std::uint8_t> cone_, polygon_in_, vertex_in_;
    std::vector<Index> joined_;
};

}  // namespace ricci
