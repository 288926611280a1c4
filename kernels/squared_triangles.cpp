#include "kernels/squared_triangles.h"

#include <cmath>

#include "kernels/vector_math.h"

namespace ricci {
namespace {

RICCI_VECTOR_CLONES void evaluate_padded(SquaredTriangles& t, int lanes) {
#pragma omp simd
    for (int i = 0; i < lanes; ++i) {
        const double p = t.square[0][i], q = t.square[1][i], s = t.square[2][i];
        const double n0 = (q - p) + s, n1 = (p - q) + s, n2 = (p - s) + q;
        // 16 A^2 = 4pq - n2^2 = 4qs - n0^2 = 4sp - n1^2
        const double r2 = 4.0 * p * q - n2 * n2, r0 = 4.0 * q * s - n0 * n0, r1 = 4.0 * s * p - n1 * n1;
        const double larger = q > p ? q : p, upper = q > p ? r1 : r0;
        const double radicand = s > larger ? r2 : upper;
        const double root = std::sqrt(radicand > 0.0 ? radicand : 0.0);
        t.radicand[i] = radicand;
        t.angle[0][i] = std::atan2(root, n0);
        t.angle[1][i] = std::atan2(root, n1);
        t.angle[2][i] = std::atan2(root, n2);
        const double inverse = 1.0 / root;
        t.cot[0][i] = n0 * inverse;
        t.cot[1][i] = n1 * inverse;
        t.cot[2][i] = n2 * inverse;
    }
}

}  // namespace

void evaluate_triangles(SquaredTriangles& t) {
    const int lanes = (t.count + kVectorPad - 1) / kVectorPad * kVectorPad;
    for (int i = t.count; i < lanes; ++i)
        for (auto& side : t.square) side[static_cast<std::size_t>(i)] = 1.0;
    evaluate_padded(t, lanes);
}

}  // namespace ricci
