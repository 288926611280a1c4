// Surfaces that are a rectangular grid wrapped around once or twice, and the flat disk.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// Torus of revolution about the z-axis: tube of radius `minor_radius` at distance `major_radius`. Its
/// modulus is i sqrt((R/r)^2 - 1) up to reduction. Throws std::invalid_argument unless 0 < minor_radius <
/// major_radius.
SurfaceMesh make_torus(Index faces, double major_radius, double minor_radius);

/// Cylinder 0 <= z <= height over a regular polygon of perimeter 2 pi, so that its modulus, height /
/// circumference, is height / (2 pi) exactly at every resolution. Throws std::invalid_argument unless height
/// is positive.
SurfaceMesh make_cylinder(Index faces, double height);

/// Plane annulus minor_radius <= |x| <= major_radius; modulus log(R/r) / (2 pi) in the limit.
/// Throws std::invalid_argument unless 0 < minor_radius < major_radius.
SurfaceMesh make_plane_annulus(Index faces, double major_radius, double minor_radius);

/// Flat unit disk: hexagonal rings of 6k vertices, 6 n^2 faces.
SurfaceMesh make_disk(Index faces);

}  // namespace ricci
