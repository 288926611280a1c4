// The baseline of the face kernels: one triangle at a time, plain scalar library calls, written from the
// textbook.
#pragma once

#include <cmath>
#include <cstddef>

namespace ricci::bench {

/// Angles of a triangle of constant curvature `kappa` and their derivatives under vertex scaling.
struct ReferenceTriangle {
    double angle[3], off[3], diagonal[3];
};

/// `chord[k]`: of the halfedge from corner k to corner k+1.
template <int kappa>
ReferenceTriangle reference_triangle(const double chord[3], bool derivatives) {
    double square[3], numerator[3];
    for (int k = 0; k < 3; ++k) square[k] = chord[k] * chord[k];
    const double a = chord[0], b = chord[1], c = chord[2];
    const double radicand =
        (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c) - kappa * square[0] * square[1] * square[2];
    const double root = std::sqrt(radicand);
    ReferenceTriangle t{};
    for (int k = 0; k < 3; ++k) {
        const double left = square[k], right = square[(k + 2) % 3], opposite = square[(k + 1) % 3];
        numerator[k] = left + right - opposite - 0.5 * kappa * left * right;
        t.angle[k] = std::atan2(root, numerator[k]);
    }
    if (!derivatives) return t;
    for (int k = 0; k < 3; ++k) {
        // off = (p^2 + q^2 - c^2) / (root (2 - kappa c^2/2)), c the chord itself and p, q the two others.
        const double p = square[(k + 1) % 3], q = square[(k + 2) % 3];
        t.off[k] = (p + q - square[k]) / (root * (2.0 - 0.5 * kappa * square[k]));
    }
    for (int k = 0; k < 3; ++k) {
        const int before = (k + 2) % 3, after = (k + 1) % 3;
        const double along = root * (2.0 - 0.5 * kappa * square[k]),
                     back = root * (2.0 - 0.5 * kappa * square[before]);
        t.diagonal[k] = -(numerator[after] / along + numerator[before] / back);
    }
    return t;
}

}  // namespace ricci::bench
