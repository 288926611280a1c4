// Definitions of final_metric.h for the types that need them; included by sources only.
#pragma once

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "engine/flow/hessian.h"
#include "engine/layout/final_metric.h"
#include "kernels/face_kernels.h"

namespace ricci {
namespace final_metric {

inline std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// cos and sin of the angles of a triangle, up to one common positive factor each, from chords; see
/// kernels/geometry.h. In units of the longest, for chords may be as small as e^-600.
template <class Real>
std::array<Complex<Real>, 3> angle_vectors(int kappa, const Real& chord0, const Real& chord1,
                                           const Real& chord2) {
    using std::sqrt;
    Real unit = chord0 > chord1 ? chord0 : chord1;
    if (chord2 > unit) unit = chord2;
    const Real l0 = chord0 / unit, l1 = chord1 / unit, l2 = chord2 / unit;
    const Real k = Real(kappa) * unit * unit;
    const Real s0 = l0 * l0, s1 = l1 * l1, s2 = l2 * l2;
    // Heron's product, factor by factor; 16 A^2 - kappa (abc)^2.
    const Real heron = (l0 + l1 + l2) * (l1 + l2 - l0) * (l2 + l0 - l1) * (l0 + l1 - l2);
    const Real root = sqrt(heron - k * (s0 * s1 * s2));
    const Real half = k / Real(2);
    // Corner 0 lies opposite halfedge 1, and so on.
    return {{{s2 + s0 - s1 - half * s2 * s0, root},
             {s0 + s1 - s2 - half * s0 * s1, root},
             {s1 + s2 - s0 - half * s1 * s2, root}}};
}

/// The rotation by pi - theta, theta the argument of `angle`.
template <class Real>
Isometry<Real> exterior_turn(const Complex<Real>& angle) {
    using std::sqrt;
    const Real norm = sqrt(squared(angle));
    const Complex<Real> half = half_angle(Complex<Real>{angle.re / norm, angle.im / norm});
    // e^(i (pi - theta) / 2) = i conj(half).
    return {{half.im, half.re}, {}};
}

/// The double Hessian at the final triangulation, factorised; unknowns are all vertices.
class FactorizedHessian {
  public:
    explicit FactorizedHessian(const CommonRefinement& r);
    /// H^-1 `values` in place. // one per vertex
    void solve(std::vector<double>& values);

  private:
    std::unique_ptr<SymmetricSolver> solver_;
    std::vector<Index> unknown_;
    std::vector<double> packed_;
};

}  // namespace final_metric

template <class Real>
Isometry<Real> FinalMetric<Real>::to_halfedge(Index h) const {
    return h % 3 == 0 ? Isometry<Real>{} : turned[final_metric::at(face_of(h))][final_metric::at(h % 3 - 1)];
}

template <class Real>
Isometry<Real> FinalMetric<Real>::crossing(const Connectivity& c, Index h) const {
    const Index t = c.twin[final_metric::at(h)];
    const Isometry<Real> move =
        translation_and_turn(half_chord[final_metric::at(h)], half_cosine[final_metric::at(h)]);
    return compose(kappa, compose(kappa, to_halfedge(h), move), inverse(to_halfedge(t)));
}

template <class Real>
std::array<std::array<Real, 3>, 3> FinalMetric<Real>::corners(Index f) const {
    return {image_of_origin(kappa, Isometry<Real>{}), image_of_origin(kappa, to_halfedge(3 * f + 1)),
            image_of_origin(kappa, to_halfedge(3 * f + 2))};
}

template <class Real>
FinalMetric<Real> make_final_metric(int kappa, std::vector<Real> half_chord) {
    using std::sqrt;
    FinalMetric<Real> m;
    m.kappa = kappa;
    m.half_chord = std::move(half_chord);
    for (const Real& s : m.half_chord) m.half_cosine.push_back(sqrt(Real(1) - Real(kappa) * s * s));
    for (std::size_t h = 0; h < m.half_chord.size(); h += 3) {
        const Real two(2);
        const auto angles = final_metric::angle_vectors<Real>(
            kappa, two * m.half_chord[h], two * m.half_chord[h + 1], two * m.half_chord[h + 2]);
        std::array<Isometry<Real>, 2> turned;
        Isometry<Real> frame;
        for (std::size_t k = 0; k < 2; ++k) {
            const Isometry<Real> along{{m.half_cosine[h + k], Real(0)}, {m.half_chord[h + k], Real(0)}};
            frame = compose(kappa, compose(kappa, frame, along), final_metric::exterior_turn(angles[k + 1]));
            turned[k] = frame;
        }
        m.turned.push_back(turned);
    }
    return m;
}

namespace final_metric {

/// Curvature of every vertex, small: minus the argument of the product of e^(i theta) around it.
template <class Real>
void add_up_curvature(const Connectivity& c, const std::vector<Real>& half_chord,
                      std::vector<Real>& curvature) {
    using std::abs;
    std::vector<Complex<Real>> turn(curvature.size(), {Real(1), Real(0)});
    const Real two(2);
    for (Index h = 0; h < c.halfedge_count(); h += 3) {
        const auto angles = angle_vectors<Real>(-1, two * half_chord[at(h)], two * half_chord[at(h + 1)],
                                                two * half_chord[at(h + 2)]);
        for (Index k = 0; k < 3; ++k) {
            Complex<Real>& product = turn[at(c.tail[at(h + k)])];
            product = product * angles[at(k)];
            // Only the direction counts: keep the size in range.
            const Real size = abs(product.re) + abs(product.im);
            product = {product.re / size, product.im / size};
        }
    }
    for (std::size_t v = 0; v < curvature.size(); ++v) {
        if (!(turn[v].re > Real(0))) throw std::runtime_error("an angle sum is not near 2 pi");
        curvature[v] = -turn[v].im / turn[v].re;
    }
}

}  // namespace final_metric

template <class Real>
PolishedMetric<Real> polish_hyperbolic(const CommonRefinement& r, std::vector<Real> scale) {
    using final_metric::at;
    using std::abs;
    const Connectivity& c = r.final_triangulation.connectivity;
    const auto vertices = at(c.vertex_count);
    final_metric::FactorizedHessian hessian(r);
    std::vector<Real> start, half(c.tail.size()), curvature(vertices);
    for (const long double log_chord : r.final_triangulation.log_chord)
        start.push_back(Real(std::exp(log_chord)) / Real(2));
    if (scale.empty())
        for (const double u : r.u) scale.push_back(Real(std::exp(static_cast<long double>(u) / 2)));
    PolishedMetric<Real> result;
    std::vector<double> step(vertices);
    const Real goal = Real(4096) * std::numeric_limits<Real>::epsilon();
    for (Real previous(-1);; ++result.steps) {
        for (Index h = 0; h < c.halfedge_count(); ++h)
            half[at(h)] = start[at(h)] * scale[at(c.tail[at(h)])] * scale[at(c.head(h))];
        final_metric::add_up_curvature(c, half, curvature);
        Real worst(0);
        for (const Real& k : curvature)
            if (abs(k) > worst) worst = abs(k);
        result.residual = static_cast<double>(worst);
        const bool stuck = previous > Real(0) && Real(2) * worst > previous && result.steps > 2;
        if (worst <= goal || stuck) break;
        previous = worst;
        // In units of the largest, which may be below what a double holds.
        for (std::size_t v = 0; v < vertices; ++v) step[v] = -static_cast<double>(curvature[v] / worst);
        hessian.solve(step);
        for (std::size_t v = 0; v < vertices; ++v) scale[v] *= Real(1) + worst * Real(step[v] / 2);
    }
    result.metric = make_final_metric<Real>(-1, std::move(half));
    result.scale = std::move(scale);
    return result;
}

}  // namespace ricci
