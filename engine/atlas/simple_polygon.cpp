#include "engine/atlas/simple_polygon.h"

#include <algorithm>
#include <cmath>

namespace ricci {
namespace {

using Vector = std::array<double, 2>;

/// Twice the area of the triangle.
double turn(const Vector& a, const Vector& b, const Vector& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool opposite(double x, double y) {
    return (x < 0.0 && y > 0.0) || (x > 0.0 && y < 0.0);
}

bool cross(const RimSegment& s, const RimSegment& t) {
    if (s.from_vertex == t.from_vertex || s.from_vertex == t.to_vertex || s.to_vertex == t.from_vertex ||
        s.to_vertex == t.to_vertex)
        return false;
    return opposite(turn(s.from, s.to, t.from), turn(s.from, s.to, t.to)) &&
           opposite(turn(t.from, t.to, s.from), turn(t.from, t.to, s.to));
}

}  // namespace

bool is_simple(std::vector<RimSegment> rim) {
    const auto low = [](const RimSegment& s) { return std::min(s.from[0], s.to[0]); };
    const auto high = [](const RimSegment& s) { return std::max(s.from[0], s.to[0]); };
    for (const RimSegment& s : rim)
        for (const double x : {s.from[0], s.from[1], s.to[0], s.to[1]})
            if (!std::isfinite(x)) return false;
    std::sort(rim.begin(), rim.end(),
              [&](const RimSegment& s, const RimSegment& t) { return low(s) < low(t); });
    for (std::size_t i = 0; i < rim.size(); ++i)
        for (std::size_t j = i + 1; j < rim.size() && low(rim[j]) <= high(rim[i]); ++j)
            if (cross(rim[i], rim[j])) return false;
    return true;
}

}  // namespace ricci
