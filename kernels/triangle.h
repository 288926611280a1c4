// One triangle in chords: angles, area and the derivatives of the angles. Branch-free, so that the same text
// serves the vectorised loops (double) and the extended-precision ones (long double).
//
// Numbering: l[k] is the chord of the halfedge k, from corner k to corner k+1; it lies opposite corner k+2.
#pragma once

#include <cmath>

namespace ricci {

/// What a triangle's angles are made of. Sums of two sides minus the third are taken in Kahan's order, the
/// shorter of the two plus (the longer minus the third): relative error of a few ulps of the data for any
/// shape (W. Kahan, Miscalculating area and angles of a needle-like triangle).
template <class Real>
struct TriangleTerms {
    Real root;  // sqrt(16 A^2 - kappa (abc)^2) = 2 sin(theta) s(l) s(l'); zero or NaN-free for a broken
                // triangle
    Real numerator[3];  // at corner k: b^2 + c^2 - a^2 - kappa b^2 c^2 / 2 = root * cot(theta_k)
    Real radicand;      // what the root was taken of; not positive: no such triangle
};

/// What cancels in a triangle, for callers who know it better than by subtracting chords. Of side k: the
/// longer of the other two minus it, and both minus it.
template <class Real>
struct SideDifferences {
    Real gap[3], excess[3];
};

template <int kappa, class Real>
inline TriangleTerms<Real> triangle_terms(Real l0, Real l1, Real l2, const SideDifferences<Real>& d) {
    const Real max01 = l0 > l1 ? l0 : l1, min01 = l0 > l1 ? l1 : l0;
    const Real max12 = l1 > l2 ? l1 : l2, min12 = l1 > l2 ? l2 : l1;
    const Real max20 = l2 > l0 ? l2 : l0, min20 = l2 > l0 ? l0 : l2;
    // Corner 0 lies opposite l1, corner 1 opposite l2, corner 2 opposite l0.
    TriangleTerms<Real> t;
    t.radicand = (l0 + l1 + l2) * d.excess[1] * d.excess[2] * d.excess[0];
    t.numerator[0] = d.gap[1] * (max20 + l1) + min20 * min20;
    t.numerator[1] = d.gap[2] * (max01 + l2) + min01 * min01;
    t.numerator[2] = d.gap[0] * (max12 + l0) + min12 * min12;
    if constexpr (kappa != 0) {
        const Real s0 = l0 * l0, s1 = l1 * l1, s2 = l2 * l2;
        t.radicand -= Real(kappa) * (s0 * s1 * s2);
        t.numerator[0] -= Real(kappa) * Real(0.5) * (s2 * s0);
        t.numerator[1] -= Real(kappa) * Real(0.5) * (s0 * s1);
        t.numerator[2] -= Real(kappa) * Real(0.5) * (s1 * s2);
    }
    t.root = std::sqrt(t.radicand > Real(0) ? t.radicand : Real(0));
    return t;
}

template <int kappa, class Real>
inline TriangleTerms<Real> triangle_terms(Real l0, Real l1, Real l2) {
    const Real gap0 = (l1 > l2 ? l1 : l2) - l0, gap1 = (l2 > l0 ? l2 : l0) - l1,
               gap2 = (l0 > l1 ? l0 : l1) - l2;
    return triangle_terms<kappa>(
        l0, l1, l2,
        SideDifferences<Real>{
            {gap0, gap1, gap2},
            {(l1 > l2 ? l2 : l1) + gap0, (l2 > l0 ? l0 : l2) + gap1, (l0 > l1 ? l1 : l0) + gap2}});
}

/// Area of the triangle in its geometry: tan(area/2) = root/2 / (1 + sum of cos(h)(l)) for kappa != 0 (the
/// triple product formula), root/4 for the Euclidean plane.
template <int kappa, class Real>
inline Real triangle_area(const TriangleTerms<Real>& t, Real l0, Real l1, Real l2) {
    if constexpr (kappa == 0) {
        return t.root * Real(0.25);
    } else {
        const Real cosines = Real(4) - Real(kappa) * Real(0.5) * (l0 * l0 + l1 * l1 + l2 * l2);
        return Real(2) * std::atan2(t.root * Real(0.5), cosines);
    }
}

/// Derivatives of one triangle's angles:
///   off[k]      = d theta_i / d u_j = d theta_j / d u_i for the ends i, j of halfedge k,
///   diagonal[k] = d theta_k / d u_k.
template <class Real>
struct AngleDerivatives {
    Real off[3], diagonal[3];
};

/// For vertex scaling (eps = 0). From dtheta_i/dl_i = s(l_i)/2A, dtheta_i/dl_j = -cos(theta_k) s(l_i)/2A and
/// dl/du = lambda^2 / (2 s(l)):
///   off = (a^2 + b^2 - c^2) / (root (2 - kappa c^2/2)), which is cot(theta)/2 in the plane.
template <int kappa, class Real>
inline AngleDerivatives<Real> scaling_derivatives(const TriangleTerms<Real>& t, Real l0, Real l1, Real l2) {
    const Real inverse = Real(1) / t.root;
    AngleDerivatives<Real> d;
    if constexpr (kappa == 0) {
        d.off[0] = Real(0.5) * t.numerator[2] * inverse;
        d.off[1] = Real(0.5) * t.numerator[0] * inverse;
        d.off[2] = Real(0.5) * t.numerator[1] * inverse;
        d.diagonal[0] = -(d.off[0] + d.off[2]);
        d.diagonal[1] = -(d.off[1] + d.off[0]);
        d.diagonal[2] = -(d.off[2] + d.off[1]);
    } else {
        const Real half = Real(kappa) * Real(0.5);
        const Real s0 = l0 * l0, s1 = l1 * l1, s2 = l2 * l2;
        const Real w0 = inverse / (Real(2) - half * s0), w1 = inverse / (Real(2) - half * s1),
                   w2 = inverse / (Real(2) - half * s2);
        d.off[0] = (t.numerator[2] + half * (s1 * s2)) * w0;
        d.off[1] = (t.numerator[0] + half * (s2 * s0)) * w1;
        d.off[2] = (t.numerator[1] + half * (s0 * s1)) * w2;
        // Corner 0 meets halfedges 0 (other end: corner 1) and 2 (other end: corner 2); and so on.
        d.diagonal[0] = -(t.numerator[1] * w0 + t.numerator[2] * w2);
        d.diagonal[1] = -(t.numerator[2] * w1 + t.numerator[0] * w0);
        d.diagonal[2] = -(t.numerator[0] * w2 + t.numerator[1] * w1);
    }
    return d;
}

/// s(l) * d l / d u of one edge at its tail and its head.
template <class Real>
struct EdgeSlopes {
    Real tail, head;
};

/// For any scheme, from the slopes of its three edges:
///   off_ij = (n_jk^j - N_j n_ij^j / s(l_ij)^2) / 2A,  diag_i = -(N_k n_ik^i/s(l_ik)^2 + N_j
///   n_ij^i/s(l_ij)^2) / 2A,
/// N = numerator/2, 2A = root/2, s(l)^2 = lambda^2 (1 - kappa lambda^2/4).
template <int kappa, class Real>
inline AngleDerivatives<Real> general_derivatives(const TriangleTerms<Real>& t, Real l0, Real l1, Real l2,
                                                  EdgeSlopes<Real> n0, EdgeSlopes<Real> n1,
                                                  EdgeSlopes<Real> n2) {
    const Real quarter = Real(kappa) * Real(0.25);
    const Real s0 = l0 * l0, s1 = l1 * l1, s2 = l2 * l2;
    const Real w0 = Real(0.5) / (s0 * (Real(1) - quarter * s0)),
               w1 = Real(0.5) / (s1 * (Real(1) - quarter * s1)),
               w2 = Real(0.5) / (s2 * (Real(1) - quarter * s2));
    const Real inverse = Real(2) / t.root;
    AngleDerivatives<Real> d;
    // Halfedge 0 runs from corner 0 to 1, halfedge 1 from there to corner 2.
    d.off[0] = inverse * (n1.tail - t.numerator[1] * n0.head * w0);
    d.off[1] = inverse * (n2.tail - t.numerator[2] * n1.head * w1);
    d.off[2] = inverse * (n0.tail - t.numerator[0] * n2.head * w2);
    d.diagonal[0] = -inverse * (t.numerator[2] * n2.head * w2 + t.numerator[1] * n0.tail * w0);
    d.diagonal[1] = -inverse * (t.numerator[0] * n0.head * w0 + t.numerator[2] * n1.tail * w1);
    d.diagonal[2] = -inverse * (t.numerator[1] * n1.head * w1 + t.numerator[0] * n2.tail * w2);
    return d;
}

}  // namespace ricci
