// Irregular variants of a surface: vertices displaced at random, reproducibly.
#pragma once

#include <cstdint>

#include "kernels/surface_mesh.h"

namespace ricci {

/// Displaces every interior vertex in its tangent plane (normal: area-weighted mean of its faces') by a
/// vector drawn uniformly from the disk of radius `fraction` times the smallest altitude among its faces;
/// boundary vertices stay. Below one half no face of a flat surface can turn over. SplitMix64 from `seed`,
/// vertex by vertex. Throws std::invalid_argument for an intrinsic surface or a fraction outside [0, 0.45].
SurfaceMesh jitter_surface(const SurfaceMesh& mesh, double fraction, std::uint64_t seed);

}  // namespace ricci
