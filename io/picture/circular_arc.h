// Circular arcs of the plane, and the geodesics of the Poincare disk, which are such arcs.
#pragma once

#include <array>

namespace ricci {

/// A point of a picture in the user's units, y upwards.
using PlanePoint = std::array<double, 2>;

/// An arc of at most half a circle, or (curvature 0) a straight segment. It stays well defined as the radius
/// grows without bound.
struct CircularArc {
    PlanePoint from{}, to{};
    double curvature = 0.0;  // 1/radius; positive where the path from `from` to `to` turns left
};

/// The point at the fraction t in [0, 1] of the arc's length.
PlanePoint point_on(const CircularArc& arc, double t);

/// The geodesic between two points of the closed unit disk (ideal points included) in Poincare's model: the
/// circle orthogonal to the unit circle, of radius |z1 - z2| |1 - conj(z1) z2| / (2 |Im(conj(z1) z2)|), the
/// circumradius of z1, z2 and the inverse of z1. Its curvature is found to within rounding even next to a
/// diameter. Throws std::invalid_argument for a point that is not finite, or outside by more than rounding.
CircularArc poincare_geodesic(const PlanePoint& z1, const PlanePoint& z2);

}  // namespace ricci
