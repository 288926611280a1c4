#include "io/picture/circular_arc.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ricci {
namespace {

constexpr double kOutside = 1e-9;  // more than any sum of roundings puts an ideal point outside

void require_in_disk(const PlanePoint& z) {
    if (!(std::hypot(z[0], z[1]) <= 1.0 + kOutside))  // also catches what is not a number
        throw std::invalid_argument("a point of a geodesic lies outside the unit disk");
}

}  // namespace

PlanePoint point_on(const CircularArc& arc, double t) {
    const double dx = arc.to[0] - arc.from[0];
    const double dy = arc.to[1] - arc.from[1];
    const double chord = std::hypot(dx, dy);
    // Half of the angle by which the arc turns; the chord from its start to t turns by this times t - 1.
    const double half = std::asin(std::clamp(0.5 * arc.curvature * chord, -1.0, 1.0));
    const double length = half == 0.0 ? t : std::sin(t * half) / std::sin(half);
    const double turn = half * (t - 1.0);
    return {arc.from[0] + length * (dx * std::cos(turn) - dy * std::sin(turn)),
            arc.from[1] + length * (dx * std::sin(turn) + dy * std::cos(turn))};
}

CircularArc poincare_geodesic(const PlanePoint& z1, const PlanePoint& z2) {
    require_in_disk(z1);
    require_in_disk(z2);
    const double dx = z2[0] - z1[0];
    const double dy = z2[1] - z1[1];
    const double chord = std::hypot(dx, dy);
    // 1 - conj(z1) z2: vanishes only where both are the same ideal point.
    const double inverse_distance =
        std::hypot(1.0 - z1[0] * z2[0] - z1[1] * z2[1], z1[0] * z2[1] - z1[1] * z2[0]);
    if (chord == 0.0 || inverse_distance == 0.0) return {z1, z2, 0.0};
    // Im(conj(z1) z2) from differences, so that close points lose no digits. The geodesic bends towards the
    // origin: where that lies to the left, the path turns right.
    const double twice_area = z1[0] * dy - z1[1] * dx;
    // At most half a circle; rounding of points next to the edge of the disk, and next to each other, may say
    // more.
    return {z1, z2, std::clamp(-2.0 * twice_area / inverse_distance, -2.0, 2.0) / chord};
}

}  // namespace ricci
