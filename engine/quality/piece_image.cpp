#include "engine/quality/piece_image.h"

#include <algorithm>
#include <cmath>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

std::array<double, 3> piece_point(const FinalMetric<double>& metric, const CommonRefinement& r,
                                  Index corner) {
    const Index f = r.final_face[at(r.piece[at(corner)])];
    const std::array<double, 3>& w = r.weight[at(corner)];
    const auto vertex = metric.corners(f);
    std::array<double, 3> x{};
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < 3; ++i) x[i] += w[k] * vertex[k][i];
    // The norm from lengths, t^2 + kappa x^2 = (sum w)^2 - 4 kappa sum w_j w_k s_jk^2: nothing cancels in the
    // hyperbolic plane, where t and x are large and nearly equal.
    const double sum = w[0] + w[1] + w[2];
    double mixed = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double s = metric.half_chord[3 * at(f) + k];
        mixed += w[k] * w[(k + 1) % 3] * s * s;
    }
    const double norm = std::sqrt(sum * sum - 4.0 * metric.kappa * mixed);
    for (double& value : x) value /= norm;
    return x;
}

Isometry<double> motion_to(int kappa, const std::array<double, 3>& p) {
    if (kappa == 0) return {{1.0, 0.0}, {p[0] / 2.0, p[1] / 2.0}};
    const double a = std::sqrt((1.0 + p[2]) / 2.0);
    return {{a, 0.0}, {p[0] / (2.0 * a), p[1] / (2.0 * a)}};
}

std::array<double, 3> seen_from(int kappa, const Isometry<double>& to_origin, const std::array<double, 3>& p,
                                const std::array<double, 3>& q) {
    std::array<double, 3> x = apply(kappa, to_origin, {q[0] - p[0], q[1] - p[1], q[2] - p[2]});
    x[2] += 1.0;
    return x;
}

double point_distance(int kappa, const std::array<double, 3>& p, const std::array<double, 3>& q) {
    if (kappa > 0) {
        const double chord = std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
        return 2.0 * std::asin(std::min(1.0, chord / 2.0));
    }
    const std::array<double, 3> x = seen_from(kappa, inverse(motion_to(kappa, p)), p, q);
    const double across = std::hypot(x[0], x[1]);
    return kappa == 0 ? across : std::asinh(across);
}

}  // namespace ricci
