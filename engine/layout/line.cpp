#include "engine/layout/line.h"

#include <algorithm>
#include <cmath>

namespace ricci {
namespace {

using Vector = std::array<double, 3>;

Vector cross(const Vector& u, const Vector& v) {
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

}  // namespace

double line_side(int kappa, const LineNormal& n, const Vector& x) {
    return n[0] * x[0] + n[1] * x[1] + (kappa < 0 ? -n[2] : n[2]) * x[2];
}

LineNormal unit_normal(int kappa, const LineNormal& n) {
    const double size =
        kappa < 0 ? std::sqrt((n[0] - n[2]) * (n[0] + n[2]) + n[1] * n[1]) : std::hypot(n[0], n[1]);
    return {n[0] / size, n[1] / size, n[2] / size};
}

LineNormal moved_line(int kappa, const Isometry<double>& motion, const LineNormal& n) {
    if (kappa < 0) return apply(kappa, motion, n);
    // The offset changes by the translation along the turned normal.
    const Vector turned = apply(kappa, motion, {n[0], n[1], 0.0}), origin = image_of_origin(kappa, motion);
    return {turned[0], turned[1], n[2] - turned[0] * origin[0] - turned[1] * origin[1]};
}

LineNormal line_across(int kappa, const LineNormal& n, const Vector& x) {
    // The direction of the line at x is the normal of the one across.
    if (kappa == 0) return {n[1], -n[0], n[0] * x[1] - n[1] * x[0]};
    const Vector d = cross(n, x);  // with the sign of t turned: orthogonal to both
    return {d[0], d[1], -d[2]};
}

Vector line_crossing(int kappa, const LineNormal& first, const LineNormal& second) {
    Vector x = cross(first, second);
    double size = x[2];
    if (kappa < 0) {
        x[2] = -x[2];
        size = std::copysign(std::sqrt(x[2] * x[2] - x[0] * x[0] - x[1] * x[1]), x[2]);
    }
    for (double& value : x) value /= size;
    return x;
}

std::optional<LineNormal> translation_axis(int kappa, const Isometry<double>& m) {
    if (kappa == 0) {
        const Vector moved = image_of_origin(kappa, m);
        const double size = std::hypot(moved[0], moved[1]);
        const bool turns = std::abs((m.a * m.a).im) > 1e-6 || (m.a * m.a).re < 0.0;
        if (turns || !(size > 0.0)) return std::nullopt;
        return LineNormal{-moved[1] / size, moved[0] / size, 0.0};
    }
    // The fixed points z on the unit circle have Im(conj(b) z) = Im a.
    const double sign = m.a.re < 0.0 ? -1.0 : 1.0;
    const double b = std::hypot(m.b.re, m.b.im), square = (b - m.a.im) * (b + m.a.im);
    if (!(square > 0.0)) return std::nullopt;
    const double scale = sign / std::sqrt(square);
    return LineNormal{-m.b.im * scale, m.b.re * scale, m.a.im * scale};
}

double translation_length(int kappa, const Isometry<double>& m) {
    if (kappa == 0) {
        const Vector moved = image_of_origin(kappa, m);
        return std::hypot(moved[0], moved[1]);
    }
    const double b = std::hypot(m.b.re, m.b.im);
    return 2.0 * std::asinh(std::sqrt(std::max(0.0, (b - m.a.im) * (b + m.a.im))));
}

}  // namespace ricci
