// Patches of roughly equal size that an atlas begins with.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/atlas/polygon_surface.h"

namespace ricci {

/// Polygons far from each other: the first is farthest from polygon 0, each further one farthest from those
/// before, ties to the lower number; at least one for every component.
std::vector<Index> farthest_seeds(const PolygonSurface& surface, Index count);

/// Number of the nearest seed, ties to the lower. // P
std::vector<Index> nearest_seeds(const PolygonSurface& surface, const std::vector<Index>& seeds);

/// Adds the polygons that touch the set, at a vertex at least, `rings` times. // P
void add_rings(const PolygonSurface& surface, Index rings, std::vector<std::uint8_t>& polygons);

}  // namespace ricci
