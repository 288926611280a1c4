#include <cmath>
#include <stdexcept>

#include "io/picture/svg.h"

namespace ricci {
namespace {

constexpr double kMaximalTurn = 1.5;  // chord over radius; sqrt(2) for a quarter of a circle

}  // namespace

void SvgPath::require_started() const {
    if (commands_.empty() || commands_.back().verb == Verb::close)
        throw std::logic_error("a piece of a path has no start");
}

SvgPath& SvgPath::move_to(const PlanePoint& point) {
    commands_.push_back({Verb::move, point, 0.0});
    return *this;
}

SvgPath& SvgPath::line_to(const PlanePoint& point) {
    require_started();
    commands_.push_back({Verb::line, point, 0.0});
    return *this;
}

SvgPath& SvgPath::arc_to(const PlanePoint& point, double curvature) {
    require_started();
    const CircularArc arc{commands_.back().point, point, curvature};
    const double chord = std::hypot(arc.to[0] - arc.from[0], arc.to[1] - arc.from[1]);
    // The middle of a half circle moves by the root of a rounding of its radius; that of a quarter by less
    // than the rounding.
    if (std::abs(curvature) * chord > kMaximalTurn)
        commands_.push_back({Verb::arc, point_on(arc, 0.5), curvature});  // halves turn by less
    commands_.push_back({Verb::arc, point, curvature});
    return *this;
}

SvgPath& SvgPath::close() {
    require_started();
    commands_.push_back({Verb::close, {}, 0.0});
    return *this;
}

SvgPath& SvgPath::polyline(std::span<const PlanePoint> points) {
    for (std::size_t i = 0; i < points.size(); ++i) i == 0 ? move_to(points[i]) : line_to(points[i]);
    return *this;
}

SvgPath& SvgPath::polygon(std::span<const PlanePoint> corners) {
    return corners.empty() ? *this : polyline(corners).close();
}

SvgPath& SvgPath::circle(const PlanePoint& centre, double radius) {
    const PlanePoint right{centre[0] + radius, centre[1]}, left{centre[0] - radius, centre[1]};
    if (!(radius > 0.0)) throw std::invalid_argument("the radius of a circle is not positive");
    return move_to(right).arc_to(left, 1.0 / radius).arc_to(right, 1.0 / radius).close();
}

SvgPath& SvgPath::arc(const CircularArc& arc) {
    const bool continues =
        !commands_.empty() && commands_.back().verb != Verb::close && commands_.back().point == arc.from;
    if (!continues) move_to(arc.from);
    return arc_to(arc.to, arc.curvature);
}

}  // namespace ricci
