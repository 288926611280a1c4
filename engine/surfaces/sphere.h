// Spheres and ellipsoids from a subdivided icosahedron.
#pragma once

#include <array>

#include "kernels/surface_mesh.h"

namespace ricci {

/// Ellipsoid around the origin, closed, genus 0: the icosahedron's faces cut into n^2 triangles each, pushed
/// to the unit sphere, scaled by the semi-axes. Symmetric under the three coordinate reflections. Throws
/// std::invalid_argument unless the semi-axes are positive and finite.
SurfaceMesh make_ellipsoid(Index faces, const std::array<double, 3>& semi_axes);

}  // namespace ricci
