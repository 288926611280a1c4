// Which vertex of one surface is nearest to each point of another.
#pragma once

#include <span>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

/// For every point the nearest used vertex of `mesh` (exact k-d tree; equal distances: the lowest number).
/// Throws std::invalid_argument for an intrinsic surface.
std::vector<Index> nearest_vertices(const SurfaceMesh& mesh, std::span<const Point> points);

}  // namespace ricci
