// One text, compiled once per instruction set. Loops over lanes have a constant count and no branch on a
// lane's values, so that every lane meets the same instructions at every position.
//
// The change of a face's angles. Write D_k = exp(-u_k) and a_k, c_k for square and cotangent of corner k, so
// that 4 area = 1 at u = 0. Relative to corner 2, with P = a_0 (D_0 - D_2), Q = a_1 (D_1 - D_2), d = P - Q:
//   r^2 = D_2^2 + g,  g = 2 D_2 (c_1 Q + c_0 P) - d^2          (r: four times the area)
//   r cot = D_2 c_0 - d at corner 0, D_2 c_1 + d at corner 1.
// The tangent of the difference of two angles is then, with r - D_2 = g / (r + D_2) and w = r + D_2,
//   tan(change) = (g c_0 + d w) / (w (r + c_0 (D_2 c_0 - d)))   at corner 0, and likewise (-d) at corner 1.
// Only differences of D enter g and d: a common factor of D changes no bit, small changes are relatively
// exact, and so are needles.
#include "kernels/lane_kernels.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "kernels/instruction_targets.h"
#include "kernels/triangle.h"
#include "kernels/vector_math.h"

namespace ricci {
namespace {

template <class Number>
std::size_t at(Number i) {
    return static_cast<std::size_t>(i);
}

/// a b + c, rounded once where the instruction set can.
template <bool fused>
RICCI_ALWAYS_INLINE double mul_add(double a, double b, double c) {
    if constexpr (fused) {
        return __builtin_fma(a, b, c);
    } else {
        return a * b + c;
    }
}

/// Squares of the two tangents together must not exceed this for the polynomial.
constexpr double kArctangentRange = 0.17;

/// atan(t) for t^2 <= kArctangentRange: t + t z q(z), z = t^2. q is the minimax polynomial by Remez's
/// exchange of z q(z) against atan(t)/t - 1 (60 digits), rounded to double: error 4e-18 relative to t.
template <bool fused>
RICCI_ALWAYS_INLINE double arctangent(double t, double z) {
    constexpr double c[] = {-0.3333333333333321,  0.19999999999957782,  -0.14285714280642944,
                            0.11111110806834958,  -0.09090898457322097, 0.07692073105438738,
                            -0.06663255263261589, 0.05849021397849942,  -0.05044540787709485,
                            0.03820085294151453,  -0.018059876889975738};
    // Even and odd powers by themselves: half the chain of dependent operations.
    const double y = z * z;
    double even = mul_add<fused>(c[10], y, c[8]), odd = mul_add<fused>(c[9], y, c[7]);
    even = mul_add<fused>(even, y, c[6]), odd = mul_add<fused>(odd, y, c[5]);
    even = mul_add<fused>(even, y, c[4]), odd = mul_add<fused>(odd, y, c[3]);
    even = mul_add<fused>(even, y, c[2]), odd = mul_add<fused>(odd, y, c[1]);
    even = mul_add<fused>(even, y, c[0]);
    return mul_add<fused>(t * z, mul_add<fused>(odd, z, even), t);
}

/// Changes of one face's corners. A lane is `far` where its changes are beyond the polynomial or the formula
/// above would cancel.
struct FaceChange {
    alignas(64) double corner[3][kLanes];
    alignas(64) std::int64_t far[kLanes];
};

/// One face as the passes read it.
struct FaceRows {
    const double* square;  // 3
    const double* cot;     // 2
    const double* angle;   // 3
    const double *shrink0, *shrink1, *shrink2;
};

/// Returns whether any lane is far.
template <bool fused>
RICCI_ALWAYS_INLINE bool near_changes(const FaceRows& in, FaceChange& out) {
    const double a0 = in.square[0], a1 = in.square[1], c0 = in.cot[0], c1 = in.cot[1];
    std::int64_t any = 0;
#pragma omp simd reduction(| : any)
    for (int l = 0; l < kLanes; ++l) {
        const double scale = in.shrink2[l];
        const double p = a0 * (in.shrink0[l] - scale), q = a1 * (in.shrink1[l] - scale);
        const double d = p - q;
        const double g = mul_add<fused>(scale + scale, mul_add<fused>(c1, q, c0 * p), -(d * d));
        const double square = scale * scale;
        const double radicand = square + g;
        const double root = std::sqrt(radicand > 0.0 ? radicand : 0.0);
        const double w = root + scale;
        const double x0 = mul_add<fused>(c0, mul_add<fused>(scale, c0, -d), root);
        const double x1 = mul_add<fused>(c1, mul_add<fused>(scale, c1, d), root);
        const double y0 = mul_add<fused>(g, c0, d * w), y1 = mul_add<fused>(g, c1, -(d * w));
        // One division for both quotients.
        const double inverse = 1.0 / (w * (x0 * x1));
        const double t0 = y0 * (x1 * inverse), t1 = y1 * (x0 * inverse);
        const double z0 = t0 * t0, z1 = t1 * t1;
        const double least = x0 < x1 ? x0 : x1;
        // A root far below `scale` is what is left of two numbers of its size. NaN is far, too.
        const bool near = (z0 + z1 <= kArctangentRange) & (least > 0.0) & (radicand > 0.0625 * square);
        const std::int64_t far = near ? 0 : 1;
        any |= far;
        out.far[l] = far;
        const double change0 = arctangent<fused>(t0, z0), change1 = arctangent<fused>(t1, z1);
        out.corner[0][l] = change0;
        out.corner[1][l] = change1;
        out.corner[2][l] = -(change0 + change1);
    }
    return any != 0;
}

/// The far lanes anew, as differences of angles. Returns those without a triangle.
RICCI_ALWAYS_INLINE LaneMask far_changes(const FaceRows& in, FaceChange& out) {
    alignas(64) double radicand[kLanes];
#pragma omp simd
    for (int l = 0; l < kLanes; ++l) {
        const TriangleTerms<double> t = triangle_terms<0>(std::sqrt(in.square[2] * in.shrink2[l]),
                                                          std::sqrt(in.square[0] * in.shrink0[l]),
                                                          std::sqrt(in.square[1] * in.shrink1[l]));
        const double change0 = std::atan2(t.root, t.numerator[0]) - in.angle[0];
        const double change1 = std::atan2(t.root, t.numerator[1]) - in.angle[1];
        const bool far = out.far[l] != 0;
        radicand[l] = t.radicand;
        out.corner[0][l] = far ? change0 : out.corner[0][l];
        out.corner[1][l] = far ? change1 : out.corner[1][l];
        out.corner[2][l] = far ? -(change0 + change1) : out.corner[2][l];
    }
    unsigned broken = 0;
    for (int l = 0; l < kLanes; ++l)
        if (out.far[l] != 0 && !(radicand[l] > 0.0)) broken |= 1U << l;
    return static_cast<LaneMask>(broken);
}

RICCI_ALWAYS_INLINE void clear_lanes(LaneMask lanes, FaceChange& out) {
    for (auto& corner : out.corner)
        for (int l = 0; l < kLanes; ++l)
            if ((lanes >> l & 1) != 0) corner[l] = 0.0;
}

using FarChanges = LaneMask (*)(const FaceRows&, FaceChange&);

template <bool fused, FarChanges far>
RICCI_ALWAYS_INLINE LaneMask add_changes(const LaneFaces& faces, const LaneRow<double>* shrink,
                                         const LaneMask* owned, LaneRow<double>* change) {
    const Index* row = faces.row.data();
    FaceRows in{faces.square.data(), faces.cot.data(), faces.angle.data(), nullptr, nullptr, nullptr};
    FaceChange out;
    LaneMask broken = 0;
    const std::size_t count = at(faces.face_count());
    for (std::size_t f = 0; f < count; ++f) {
        in.shrink0 = shrink[at(row[0])].lane;
        in.shrink1 = shrink[at(row[1])].lane;
        in.shrink2 = shrink[at(row[2])].lane;
        LaneMask lost = 0;
        if (near_changes<fused>(in, out)) lost = far(in, out);
        if (owned[f] != 0) {
            clear_lanes(owned[f], out);
            lost = static_cast<LaneMask>(lost & ~owned[f]);
        }
        broken = static_cast<LaneMask>(broken | lost);
        // One row after the other: corners may share one.
        for (int k = 0; k < 3; ++k) {
            double* sum = change[at(row[k])].lane;
#pragma omp simd
            for (int l = 0; l < kLanes; ++l) sum[l] += out.corner[k][l];
        }
        row += 3;
        in.square += 3;
        in.cot += 2;
        in.angle += 3;
    }
    return broken;
}

/// Slack of the Delaunay test, relative to the left side of the inequality. That side over sqrt(D_i D_j) is
/// a/b + b/a + d/e + e/d >= 4, the difference of the sides 2 (cos a + cos b), at a tie about 2 sin a
/// sin(a+b): what is found has sin(a+b) < -1e-12, and what is not has sin(a+b) > -1e-12 but for thin
/// triangles, whose roundings the slack follows as that of make_delaunay does.
constexpr double kDelaunaySlack = 5e-13;

/// One edge's rows and weights.
struct EdgeRows {
    const double* weight;  // 4
    const double *shrink_i, *shrink_j, *shrink_k, *shrink_l;
};

template <bool fused>
RICCI_ALWAYS_INLINE double delaunay_margin(const EdgeRows& in, double slack0, double slack1, int l) {
    return mul_add<fused>(slack0, in.shrink_i[l], slack1 * in.shrink_j[l]) -
           mul_add<fused>(in.weight[2], in.shrink_k[l], in.weight[3] * in.shrink_l[l]);
}

template <bool fused>
RICCI_ALWAYS_INLINE LaneMask failing_lanes(const EdgeRows& in, double slack0, double slack1) {
    alignas(64) double margin[kLanes];
#pragma omp simd
    for (int l = 0; l < kLanes; ++l) margin[l] = delaunay_margin<fused>(in, slack0, slack1, l);
    unsigned lanes = 0;
    for (int l = 0; l < kLanes; ++l) lanes |= margin[l] < 0.0 ? 1U << l : 0U;
    return static_cast<LaneMask>(lanes);
}

using FailingLanes = LaneMask (*)(const EdgeRows&, double, double);

template <bool fused, FailingLanes failing>
RICCI_ALWAYS_INLINE void find_flips(const LaneEdges& edges, const LaneRow<double>* shrink,
                                    const LaneMask* owned, std::vector<LaneFlip>& flips) {
    const Index* row = edges.row.data();
    const Index* face = edges.face.data();
    EdgeRows in{edges.square.data(), nullptr, nullptr, nullptr, nullptr};
    const Index count = edges.edge_count();
    for (Index e = 0; e < count; ++e, row += 4, face += 2, in.weight += 4) {
        in.shrink_i = shrink[at(row[0])].lane;
        in.shrink_j = shrink[at(row[1])].lane;
        in.shrink_k = shrink[at(row[2])].lane;
        in.shrink_l = shrink[at(row[3])].lane;
        const double slack0 = in.weight[0] * (1.0 + kDelaunaySlack),
                     slack1 = in.weight[1] * (1.0 + kDelaunaySlack);
        std::int64_t any = 0;
#pragma omp simd reduction(| : any)
        for (int l = 0; l < kLanes; ++l) any |= delaunay_margin<fused>(in, slack0, slack1, l) < 0.0 ? 1 : 0;
        if (any == 0) continue;
        const int own = owned[at(face[0])] | owned[at(face[1])];
        const auto lanes = static_cast<LaneMask>(failing(in, slack0, slack1) & ~own);
        if (lanes != 0) flips.push_back({e, lanes});
    }
}

RICCI_ALWAYS_INLINE void exponentials(const LaneRow<double>* u, std::size_t rows, LaneRow<double>* shrink) {
    for (std::size_t r = 0; r < rows; ++r) {
#pragma omp simd
        for (int l = 0; l < kLanes; ++l) shrink[r].lane[l] = std::exp(-u[r].lane[l]);
    }
}

struct Passes {
    void (*exponentials)(const LaneRow<double>*, std::size_t, LaneRow<double>*);
    LaneMask (*changes)(const LaneFaces&, const LaneRow<double>*, const LaneMask*, LaneRow<double>*);
    void (*flips)(const LaneEdges&, const LaneRow<double>*, const LaneMask*, std::vector<LaneFlip>&);
};

// What is rare is a function of its own, so that it takes no registers from the loops.
// NOLINTBEGIN(bugprone-macro-parentheses): an attribute
#define RICCI_LANE_PASSES(set, target, fused)                                                             \
    target void exponentials_##set(const LaneRow<double>* u, std::size_t rows, LaneRow<double>* shrink) { \
        exponentials(u, rows, shrink);                                                                    \
    }                                                                                                     \
    target __attribute__((noinline)) LaneMask far_##set(const FaceRows& in, FaceChange& out) {            \
        return far_changes(in, out);                                                                      \
    }                                                                                                     \
    target LaneMask changes_##set(const LaneFaces& faces, const LaneRow<double>* shrink,                  \
                                  const LaneMask* owned, LaneRow<double>* change) {                       \
        return add_changes<fused, far_##set>(faces, shrink, owned, change);                               \
    }                                                                                                     \
    target __attribute__((noinline))                                                                      \
    LaneMask failing_##set(const EdgeRows& in, double slack0, double slack1) {                            \
        return failing_lanes<fused>(in, slack0, slack1);                                                  \
    }                                                                                                     \
    target void flips_##set(const LaneEdges& edges, const LaneRow<double>* shrink, const LaneMask* owned, \
                            std::vector<LaneFlip>& flips) {                                               \
        find_flips<fused, failing_##set>(edges, shrink, owned, flips);                                    \
    }                                                                                                     \
    constexpr Passes kPasses_##set{exponentials_##set, changes_##set, flips_##set};
// NOLINTEND(bugprone-macro-parentheses)

RICCI_LANE_PASSES(baseline, , false)
#ifdef RICCI_LANE_TARGETS
RICCI_LANE_PASSES(avx2, RICCI_AVX2, true)
RICCI_LANE_PASSES(avx512, RICCI_AVX512, true)
#endif
#undef RICCI_LANE_PASSES

const Passes& passes_of(InstructionSet set) {
#ifdef RICCI_LANE_TARGETS
    if (set == InstructionSet::avx512) return kPasses_avx512;
    if (set == InstructionSet::avx2) return kPasses_avx2;
#endif
    static_cast<void>(set);
    return kPasses_baseline;
}

}  // namespace

namespace detail {

void lane_exponentials(InstructionSet set, const LaneArray<double>& u, LaneArray<double>& shrink) {
    shrink.resize(u.size());
    passes_of(set).exponentials(u.data(), u.size(), shrink.data());
}

LaneMask add_angle_changes(InstructionSet set, const LaneFaces& faces, const LaneArray<double>& shrink,
                           std::span<const LaneMask> owned, LaneArray<double>& change) {
    return passes_of(set).changes(faces, shrink.data(), owned.data(), change.data());
}

void find_lane_flips(InstructionSet set, const LaneEdges& edges, const LaneArray<double>& shrink,
                     std::span<const LaneMask> owned, std::vector<LaneFlip>& flips) {
    flips.clear();
    passes_of(set).flips(edges, shrink.data(), owned.data(), flips);
}

}  // namespace detail

void lane_exponentials(const LaneArray<double>& u, LaneArray<double>& shrink) {
    detail::lane_exponentials(instruction_set(), u, shrink);
}

LaneMask add_angle_changes(const LaneFaces& faces, const LaneArray<double>& shrink,
                           std::span<const LaneMask> owned, LaneArray<double>& change) {
    return detail::add_angle_changes(instruction_set(), faces, shrink, owned, change);
}

void find_lane_flips(const LaneEdges& edges, const LaneArray<double>& shrink, std::span<const LaneMask> owned,
                     std::vector<LaneFlip>& flips) {
    detail::find_lane_flips(instruction_set(), edges, shrink, owned, flips);
}

}  // namespace ricci
