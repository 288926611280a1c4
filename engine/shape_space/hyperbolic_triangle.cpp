#include "engine/shape_space/hyperbolic_triangle.h"

#include <algorithm>
#include <cmath>

#include "engine/layout/final_metric.inl"

namespace ricci {
namespace {

/// tan^2(A/2) = sinh(s - b) sinh(s - c) / (sinh s sinh(s - a)), a, b, c the lengths, s half their sum: where
/// chords grow like e^(l/2), differences of their products have lost thin angles.
std::array<Complex<double>, 3> large_angles(const std::array<double, 3>& half_chord) {
    std::array<double, 3> rest{};  // sinh(s - l), per halfedge
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        rest[k] = 2 * std::asinh(half_chord[k]);
        sum += rest[k];
    }
    for (double& l : rest) l = std::sinh(std::max(0.0, sum / 2 - l));
    const double whole = std::sinh(sum / 2);
    std::array<Complex<double>, 3> angle;
    for (std::size_t k = 0; k < 3; ++k) {
        // Corner k lies between halfedges k and k + 2, opposite k + 1.
        const double square = rest[k] * rest[(k + 2) % 3], rest_square = whole * rest[(k + 1) % 3];
        const double norm = square + rest_square;
        angle[k] = {(rest_square - square) / norm, 2 * std::sqrt(square * rest_square) / norm};
    }
    return angle;
}

}  // namespace

std::array<Complex<double>, 3> triangle_angles(const std::array<double, 3>& h) {
    if (std::max({h[0], h[1], h[2]}) > 0.5) return large_angles(h);
    std::array<Complex<double>, 3> angle =
        final_metric::angle_vectors<double>(-1, 2 * h[0], 2 * h[1], 2 * h[2]);
    if (!(angle[0].im > 0)) return large_angles(h);  // rounded to flat
    for (Complex<double>& a : angle) {
        const double norm = std::sqrt(squared(a));
        a = {a.re / norm, a.im / norm};
    }
    return angle;
}

double third_half_chord(double b, double c, const Complex<double>& angle) {
    const double sine2 =
        angle.re < 0 ? (1 - angle.re) / 2 : angle.im * angle.im / (2 * (1 + angle.re));  // sin^2(A/2)
    const double cosine_b = std::sqrt(1 + b * b), cosine_c = std::sqrt(1 + c * c);
    const double difference = b * cosine_c - c * cosine_b;
    return std::sqrt(difference * difference + 4 * b * cosine_b * c * cosine_c * sine2);
}

double halved(double half_chord) {
    return half_chord / std::sqrt(2 * (1 + std::sqrt(1 + half_chord * half_chord)));
}

double covering_radius(const std::array<double, 3>& h, const std::array<Complex<double>, 3>& unit) {
    const double half = std::asinh(std::max({h[0], h[1], h[2]}));
    std::array<double, 3> angle{};
    for (std::size_t k = 0; k < 3; ++k) angle[k] = std::atan2(unit[k].im, unit[k].re);
    const auto widest =
        static_cast<std::size_t>(std::max_element(angle.begin(), angle.end()) - angle.begin());
    if (2 * angle[widest] > angle[0] + angle[1] + angle[2]) {
        // On the side opposite the wide corner, where the bisectors of the others meet it: tanh x = tanh(b/2)
        // / cos A. The sides at the wide corner are the halfedges `widest`, to the corner a, and b, from the
        // corner b.
        const auto reach = [&](std::size_t corner, std::size_t side) {
            const double tangent = h[side] / (std::sqrt(1 + h[side] * h[side]) * unit[corner].re);
            return tangent < 1 ? std::atanh(tangent) : half;
        };
        const std::size_t a = (widest + 1) % 3, b = (widest + 2) % 3;
        return std::min(half, std::max(reach(a, widest), reach(b, b)));
    }
    // The corners lie on a circle of radius sinh R in the plane through them.
    const double product =
        (h[0] + h[1] + h[2]) * (h[0] + h[1] - h[2]) * (h[1] + h[2] - h[0]) * (h[2] + h[0] - h[1]);
    return product > 0 ? std::asinh(2 * h[0] * h[1] * h[2] / std::sqrt(product)) : half;
}

}  // namespace ricci
