// Normals of polygons in space, for programs that shade.
#pragma once

#include <span>
#include <vector>

#include "io/exchange/geometry_block.h"

namespace ricci {

/// Unit normals at points: the polygons' own by Newell's method, added up by area. Points of equal `identity`
/// (numbers below their count; empty: each its own) count as one, so that a surface that was cut is shaded as
/// a whole. (0, 0, 1) where there is no direction. // one per point
std::vector<Point> vertex_normals(const GeometryBlock& block, std::span<const Index> identity);

/// Adds them as the point data `normal`, which shading then follows.
void add_normals(GeometryBlock& block, std::span<const Index> identity);

}  // namespace ricci
