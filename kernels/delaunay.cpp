#include "kernels/delaunay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "kernels/extended.h"
#include "kernels/vector_math.h"
#include "kernels/wide_sides.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Relative slack of the test per unit of a/b + b/a: a few roundings of the ratios it is made of.
template <class Real>
constexpr Real kSlack = Real(64) * std::numeric_limits<Real>::epsilon();

/// 2 cos(angle opposite c) in a triangle with sides a, b, c, plus `slack` per unit of a/b + b/a.
template <class Real>
inline Real cosine_test(Real a, Real b, Real c, Real slack) {
    const Real larger = a > b ? a : b, smaller = a > b ? b : a;
    const Real ratio = larger / smaller + smaller / larger;
    return ((larger - c) * (larger + c) + smaller * smaller) / (larger * smaller) + slack * ratio;
}

/// Logarithms of the chords of face f in the metric u, relative to the longest.
template <class Real>
inline void face_logs(const IntrinsicTriangulation<Real>& t, ConformalFactor u, std::size_t h, Real* x) {
    const auto& tail = t.connectivity.tail;
    for (std::size_t k = 0; k < 3; ++k) x[k] = t.log_chord[h + k];
    if (!u.empty()) {
        const Real u0 = u.at<Real>(tail[h]), u1 = u.at<Real>(tail[h + 1]), u2 = u.at<Real>(tail[h + 2]);
        x[0] += Real(0.5) * (u0 + u1);
        x[1] += Real(0.5) * (u1 + u2);
        x[2] += Real(0.5) * (u2 + u0);
    }
    const Real top = std::max(x[0], std::max(x[1], x[2]));
    for (int k = 0; k < 3; ++k) x[k] -= top;
}

/// The corner test of the corner opposite halfedge h.
template <class Real>
Real opposite_test(const IntrinsicTriangulation<Real>& t, ConformalFactor u, Index h) {
    const auto first = static_cast<std::size_t>(3 * face_of(h));
    Real x[3];
    face_logs(t, u, first, x);
    for (Real& value : x) value = std::exp(value);
    const auto k = static_cast<std::size_t>(h) - first;
    return cosine_test(x[(k + 1) % 3], x[(k + 2) % 3], x[k], kSlack<Real>);
}

/// 1 + cos and 1 - cos of the angle opposite a side. Both keep their
/// relative accuracy as the angle goes to 0 or pi, where the cosine itself tells nothing any more; negative
/// where the sides break the triangle inequality.
struct HalfCosines {
    long double above, below;
};

HalfCosines opposite_half_cosines(const IntrinsicTriangulation<WideReal>& t, ConformalFactor u, Index h) {
    const auto first = static_cast<std::size_t>(3 * face_of(h));
    WideReal x[3];
    face_logs(t, u, first, x);
    const WideSides s = wide_sides(x);
    const auto k = static_cast<std::size_t>(h) - first, i = (k + 1) % 3, j = (k + 2) % 3;
    const long double a = s.chord[i], b = s.chord[j], c = s.chord[k], scale = 1 / (2 * a * b);
    // (a + b)^2 - c^2 and c^2 - (a - b)^2 over 2ab.
    return {(a + b + c) * s.difference.excess[k] * scale,
            s.difference.excess[i] * s.difference.excess[j] * scale};
}

/// cos + cos' = (1 + cos) - (1 - cos'), with the more obtuse angle first: a difference of accurate numbers.
bool edge_fails(const IntrinsicTriangulation<WideReal>& t, ConformalFactor u, Index h) {
    constexpr long double kTie = kSlack<long double>;
    const HalfCosines p = opposite_half_cosines(t, u, h),
                      q = opposite_half_cosines(t, u, t.connectivity.twin[at(h)]);
    const auto below = [](long double x, long double y) {
        return x - y < -kTie * (std::abs(x) + std::abs(y));
    };
    return p.above < q.above ? below(p.above, q.below) : below(q.above, p.below);
}

template <class Real>
bool edge_fails(const IntrinsicTriangulation<Real>& t, ConformalFactor u, Index h) {
    return opposite_test(t, u, h) + opposite_test(t, u, t.connectivity.twin[at(h)]) < Real(0);
}

/// Tests the three corners of faces given by their relative log chords, in double. `slack` as in cosine_test.
RICCI_VECTOR_CLONES void test_block(double (*x)[kFaceBlock], int lanes, double slack,
                                    double (*out)[kFaceBlock]) {
#pragma omp simd
    for (int i = 0; i < lanes; ++i) {
        const double l0 = std::exp(x[0][i]), l1 = std::exp(x[1][i]), l2 = std::exp(x[2][i]);
        out[0][i] = cosine_test(l1, l2, l0, slack);
        out[1][i] = cosine_test(l2, l0, l1, slack);
        out[2][i] = cosine_test(l0, l1, l2, slack);
    }
}

/// The corner opposite each halfedge, tested in one pass over all faces. In extended precision the pass is
/// double all the same, with its slack turned round: it only finds the edges worth a look. // 3F
template <class Real>
void test_corners(const IntrinsicTriangulation<Real>& t, ConformalFactor u, std::vector<double>& out) {
    const double slack = std::is_same_v<Real, double> ? kSlack<double> : -kSlack<double>;
    const auto faces = static_cast<std::size_t>(t.connectivity.face_count());
    out.resize(3 * faces);
    alignas(64) double x[3][kFaceBlock];
    alignas(64) double values[3][kFaceBlock];
    for (std::size_t begin = 0; begin < faces; begin += kFaceBlock) {
        const int count = static_cast<int>(std::min<std::size_t>(kFaceBlock, faces - begin));
        for (int i = 0; i < count; ++i) {
            Real logs[3];
            face_logs(t, u, 3 * (begin + static_cast<std::size_t>(i)), logs);
            for (int k = 0; k < 3; ++k) x[k][i] = static_cast<double>(logs[k]);
        }
        const int lanes = (count + kVectorPad - 1) / kVectorPad * kVectorPad;
        for (int i = count; i < lanes; ++i) x[0][i] = x[1][i] = x[2][i] = 0.0;
        test_block(x, lanes, slack, values);
        for (int i = 0; i < count; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                out[3 * (begin + static_cast<std::size_t>(i)) + k] = values[k][i];
    }
}

}  // namespace

template <class Real>
FlipCount make_delaunay(IntrinsicTriangulation<Real>& t, ConformalFactor u, FlipRule rule,
                        DelaunayWorkspace& w) {
    Connectivity& c = t.connectivity;
    w.touched_faces.clear();
    w.flipped.clear();
    w.stack.clear();
    w.on_stack.resize(static_cast<std::size_t>(c.edge_count));
    test_corners(t, u, w.corner_test);
    for (Index h = c.halfedge_count() - 1; h >= 0; --h) {
        const Index twin = c.twin[at(h)];
        if (twin > h && face_of(twin) != face_of(h) && w.corner_test[at(h)] + w.corner_test[at(twin)] < 0.0) {
            w.stack.push_back(h);
            w.on_stack[at(c.edge[at(h)])] = 1;
        }
    }
    FlipCount count;
    const std::int64_t bound = 1000 + 200 * static_cast<std::int64_t>(c.edge_count);
    // A slot on the stack names an edge through its halfedge; a flip moves two halfedges per face, so the
    // edges are pushed anew with their new slots and stale entries are recognised by their edge's flag.
    while (!w.stack.empty()) {
        const Index h = w.stack.back();
        w.stack.pop_back();
        const Index e = c.edge[at(h)];
        if (!w.on_stack[at(e)]) continue;
        w.on_stack[at(e)] = 0;
        if (!flippable(c, h) || !edge_fails(t, u, h)) continue;
        if (count.flips >= bound) {
            count.finished = false;
            break;
        }
        const Index twin = c.twin[at(h)];
        const Real length = rule == FlipRule::ptolemy ? ptolemy_log<Real>(t.log_chord, c, h)
                                                      : unfolded_log<Real>(t.log_chord, c, h);
        flip_edge<Real>(c, t.log_chord, h, length);
        ++count.flips;
        w.flipped.push_back(h);
        w.touched_faces.push_back(face_of(h));
        w.touched_faces.push_back(face_of(twin));
        // The four sides of the quadrilateral, in their new slots.
        for (const Index side : {h, prev_halfedge(h), twin, prev_halfedge(twin)}) {
            if (!flippable(c, side)) continue;
            w.stack.push_back(side);
            w.on_stack[at(c.edge[at(side)])] = 1;
        }
    }
    for (const Index h : w.stack) w.on_stack[at(c.edge[at(h)])] = 0;
    return count;
}

template <class Real>
std::int64_t count_non_delaunay(const IntrinsicTriangulation<Real>& t, ConformalFactor u) {
    std::int64_t count = 0;
    for (Index h = 0; h < t.connectivity.halfedge_count(); ++h) {
        const Index twin = t.connectivity.twin[at(h)];
        if (twin > h && flippable(t.connectivity, h) && edge_fails(t, u, h)) ++count;
    }
    return count;
}

#define RICCI_INSTANTIATE(Real)                                                                      \
    template FlipCount make_delaunay<Real>(IntrinsicTriangulation<Real>&, ConformalFactor, FlipRule, \
                                           DelaunayWorkspace&);                                      \
    template std::int64_t count_non_delaunay<Real>(const IntrinsicTriangulation<Real>&, ConformalFactor);
RICCI_INSTANTIATE(double)
RICCI_INSTANTIATE(long double)
RICCI_INSTANTIATE(WideReal)
#undef RICCI_INSTANTIATE

}  // namespace ricci
