#include "io/mesh/checks/quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricci {
namespace {

using Long = long double;
using Vector = std::array<Long, 3>;

/// Angle opposite side a, b >= c being the others, factors in an order that cancels benignly (Kahan).
Long angle_opposite(Long a, Long b, Long c) {
    const Long mu = c >= a ? a - (b - c) : c - (b - a);
    const Long numerator = ((b - c) + a) * mu;
    const Long denominator = (b + (c + a)) * ((b - a) + c);
    return 2 * std::atan2(std::sqrt(std::max(numerator, Long{0})), std::sqrt(denominator));
}

Vector difference(const Point& to, const Point& from) {
    return {static_cast<Long>(to[0]) - from[0], static_cast<Long>(to[1]) - from[1],
            static_cast<Long>(to[2]) - from[2]};
}
Long dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Above 90 degrees by more than rounding of the coordinates explains.
constexpr Long kObtuse = std::numbers::pi_v<Long> / 180 * (90 + 1e-8L);

class QualityCounter {
  public:
    void add(Long smallest, Long largest) {
        smallest_ = std::min(smallest_, smallest);
        obtuse_ += largest > kObtuse ? 1 : 0;
        ++faces_;
    }
    [[nodiscard]] Quality quality() const {
        return {static_cast<double>(smallest_ * 180 / std::numbers::pi_v<Long>),
                static_cast<double>(obtuse_) / static_cast<double>(faces_)};
    }

  private:
    Long smallest_ = std::numbers::pi_v<Long>;
    std::size_t obtuse_ = 0, faces_ = 0;
};

}  // namespace

std::array<long double, 3> corner_angles(const Point& a, const Point& b, const Point& c) {
    const Vector ab = difference(b, a);
    const Vector bc = difference(c, b);
    const Vector ca = difference(a, c);
    // Twice the area, from the two shorter sides: least cancellation where it matters.
    const Long lab = dot(ab, ab);
    const Long lbc = dot(bc, bc);
    const Long lca = dot(ca, ca);
    const Vector normal = lab >= lbc && lab >= lca ? cross(bc, ca)
                          : lbc >= lca             ? cross(ca, ab)
                                                   : cross(ab, bc);
    const Long area = std::sqrt(dot(normal, normal));
    return {std::atan2(area, -dot(ab, ca)), std::atan2(area, -dot(bc, ab)), std::atan2(area, -dot(ca, bc))};
}

double min_corner_angle(const Point& a, const Point& b, const Point& c) {
    const std::array<Long, 3> angles = corner_angles(a, b, c);
    return static_cast<double>(*std::min_element(angles.begin(), angles.end()));
}

Quality quality_of(std::span<const Triangle> triangles, std::span<const Point> points) {
    QualityCounter counter;
    for (const Triangle& t : triangles) {
        const auto point = [&](std::size_t k) -> const Point& {
            return points[static_cast<std::size_t>(t[k])];
        };
        const std::array<Long, 3> angles = corner_angles(point(0), point(1), point(2));
        counter.add(*std::min_element(angles.begin(), angles.end()),
                    *std::max_element(angles.begin(), angles.end()));
    }
    return counter.quality();
}

Quality quality_of(std::span<const double> edge_length) {
    QualityCounter counter;
    for (std::size_t f = 0; 3 * f < edge_length.size(); ++f) {
        std::array<Long, 3> side = {edge_length[3 * f], edge_length[3 * f + 1], edge_length[3 * f + 2]};
        std::sort(side.begin(), side.end());
        const auto [c, b, a] = side;
        counter.add(angle_opposite(c, a, b), angle_opposite(a, b, c));
    }
    return counter.quality();
}

}  // namespace ricci
