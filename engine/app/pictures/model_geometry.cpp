#include "engine/app/pictures/model_geometry.h"

#include <algorithm>
#include <cmath>

namespace ricci::app {
namespace {

// Great circles in stereographic projection pass through z1, z2 and the antipode -1 / conj(z1): the formula
// of poincare_geodesic with the opposite curvature.
CircularArc stereographic_geodesic(const PlanePoint& z1, const PlanePoint& z2) {
    const double dx = z2[0] - z1[0], dy = z2[1] - z1[1], chord = std::hypot(dx, dy);
    const double antipodal = std::hypot(1.0 + z1[0] * z2[0] + z1[1] * z2[1], z1[0] * z2[1] - z1[1] * z2[0]);
    if (chord == 0.0 || antipodal == 0.0) return {z1, z2, 0.0};
    return {z1, z2, 2.0 * (z1[0] * dy - z1[1] * dx) / (chord * antipodal)};
}

// A circle with its centre on the real axis; going to the right the path turns right. Its radius is
// hypot(dx^2 + y2^2 - y1^2, 2 dx y1) / (2 |dx|).
CircularArc half_plane_geodesic(const PlanePoint& z1, const PlanePoint& z2) {
    const double dx = z2[0] - z1[0], dy = z2[1] - z1[1];
    const double diameter = std::hypot(dx * dx + dy * (z2[1] + z1[1]), 2.0 * dx * z1[1]);
    return {z1, z2, diameter == 0.0 ? 0.0 : -2.0 * dx / diameter};
}

}  // namespace

bool ModelGeometry::shows(const std::array<double, 3>& position) const {
    constexpr double kLowest = -0.8;  // points up to |z| = 3 in the stereographic projection
    if (kappa_ > 0 && !(position[2] > kLowest)) return false;
    if (kappa_ < 0) {
        // Coordinates that lost all their digits may leave the disk.
        const PlanePoint w = conformal_point(-1, position);
        if (!(std::hypot(w[0], w[1]) <= 1.0 + 1e-10)) return false;
    }
    const PlanePoint z = point(position);
    return std::isfinite(z[0]) && std::isfinite(z[1]);
}

CircularArc ModelGeometry::geodesic(const PlanePoint& from, const PlanePoint& to) const {
    if (kappa_ > 0) return stereographic_geodesic(from, to);
    if (kappa_ == 0 || model_ == LayoutModel::klein) return {from, to, 0.0};
    return half_plane() ? half_plane_geodesic(from, to) : poincare_geodesic(from, to);
}

void ModelGeometry::append_geodesic(std::vector<PlanePoint>& points, const PlanePoint& from,
                                    const PlanePoint& to, double tolerance) const {
    const CircularArc arc = geodesic(from, to);
    const double chord = std::hypot(to[0] - from[0], to[1] - from[1]);
    // The height of the arc over its chord, at most half of that, falls with the square of the pieces.
    const double height = std::min(0.125 * std::abs(arc.curvature) * chord * chord, 0.5 * chord);
    const int pieces = static_cast<int>(std::clamp(std::ceil(std::sqrt(height / tolerance)), 1.0, 128.0));
    points.push_back(from);
    for (int i = 1; i < pieces; ++i) points.push_back(point_on(arc, static_cast<double>(i) / pieces));
}

}  // namespace ricci::app
