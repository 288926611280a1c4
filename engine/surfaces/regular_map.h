// Surfaces glued from equilateral triangles in a pattern with the largest possible symmetry.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// Klein's quartic: the pattern {3,7}, 24 vertices of valence 7, 56 triangles, genus 3, 168 rotations.
/// Intrinsic, edge length 1.
SurfaceMesh make_klein_quartic();

/// Bolza's surface: the pattern {3,8}, 6 vertices of valence 8, 16 triangles, genus 2, 48 rotations.
/// Intrinsic, edge length 1.
SurfaceMesh make_bolza();

}  // namespace ricci
