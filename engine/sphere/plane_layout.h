// A flat disk known by its lengths, laid out in the plane.
#pragma once

#include <complex>
#include <vector>

#include "kernels/intrinsic_triangulation.h"

namespace ricci {

/// Positions of the vertices, with the tail of halfedge `seed` at the origin and its edge along the positive
/// real axis, faces counterclockwise. Faces are laid from the origin outwards and carry their direction, not
/// differences of positions: so a position is exact to rounding relative to its distance from the origin,
/// however small the triangles there are beside those elsewhere. // per vertex; 0 for vertices without a face
std::vector<std::complex<long double>> lay_out_plane(const IntrinsicTriangulation<long double>& disk,
                                                     Index seed);

}  // namespace ricci
