// Orientation-preserving isometries of the three planes, in one notation.
//
// kappa is the curvature: -1 hyperbolic, 0 Euclidean, 1 spherical. A point is z = tan_k(r/2) e^{i phi} at
// distance r from the origin (Poincare disk, half the Euclidean coordinate, stereographic projection from the
// far pole), or the vector (x, t) with kappa |x|^2 + t^2 = 1 (hyperboloid, plane t = 1, sphere), z = x / (1 +
// t). An isometry is z -> (a z + b) / (-kappa conj(b) z + conj(a)) with |a|^2 + kappa |b|^2 = 1: SU(1,1),
// E(2), SU(2).
#pragma once

#include <array>
#include <cmath>

namespace ricci {

/// A complex number over any real type (std::complex is for the built-in ones only).
template <class Real>
struct Complex {
    Real re{0}, im{0};
};

template <class Real>
Complex<Real> operator*(const Complex<Real>& x, const Complex<Real>& y) {
    return {x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re};
}
template <class Real>
Complex<Real> operator+(const Complex<Real>& x, const Complex<Real>& y) {
    return {x.re + y.re, x.im + y.im};
}
template <class Real>
Complex<Real> conjugate(const Complex<Real>& x) {
    return {x.re, -x.im};
}
template <class Real>
Real squared(const Complex<Real>& x) {
    return x.re * x.re + x.im * x.im;
}

/// e^(i theta / 2) of e^(i theta), theta in (-pi, pi].
template <class Real>
Complex<Real> half_angle(const Complex<Real>& unit) {
    using std::sqrt;
    if (unit.re > Real(0)) {
        const Real r = sqrt(Real(2) * (Real(1) + unit.re));
        return {(Real(1) + unit.re) / r, unit.im / r};
    }
    const Real r = sqrt(Real(2) * (Real(1) - unit.re));
    if (unit.im < Real(0)) return {-unit.im / r, -(Real(1) - unit.re) / r};
    return {unit.im / r, (Real(1) - unit.re) / r};
}

template <class Real>
struct Isometry {
    Complex<Real> a{Real(1), Real(0)}, b{};
};

/// x after y.
template <class Real>
Isometry<Real> compose(int kappa, const Isometry<Real>& x, const Isometry<Real>& y) {
    const Complex<Real> p = x.b * conjugate(y.b);
    Isometry<Real> r;
    r.a = x.a * y.a;
    if (kappa < 0) {
        r.a = r.a + p;
    } else if (kappa > 0) {
        r.a = {r.a.re - p.re, r.a.im - p.im};
    }
    r.b = x.a * y.b + x.b * conjugate(y.a);
    return r;
}

template <class Real>
Isometry<Real> inverse(const Isometry<Real>& x) {
    return {conjugate(x.a), {-x.b.re, -x.b.im}};
}

/// The point (x, t), t last, that the origin goes to.
template <class Real>
std::array<Real, 3> image_of_origin(int kappa, const Isometry<Real>& x) {
    const Complex<Real> p = x.b * x.a;
    const Real t = squared(x.a) - Real(kappa) * squared(x.b);
    return {Real(2) * p.re, Real(2) * p.im, t};
}

/// The image of a vector (x, t).
template <class Real>
std::array<Real, 3> apply(int kappa, const Isometry<Real>& m, const std::array<Real, 3>& v) {
    // With a spinor (p, q), z = p / q: x = 2 p conj(q), t = |q|^2 - kappa |p|^2, so
    // x' = a^2 x - kappa b^2 conj(x) + 2 a b t, t' = (|a|^2 - kappa |b|^2) t - 2 kappa Re(a conj(b) x).
    const Complex<Real> x{v[0], v[1]};
    const Complex<Real> aa = m.a * m.a, bb = m.b * m.b, ab = m.a * m.b, cross = conjugate(m.b) * m.a * x;
    const Complex<Real> rotated = aa * x, mirrored = bb * conjugate(x);
    const Real k(kappa);
    return {rotated.re - k * mirrored.re + Real(2) * ab.re * v[2],
            rotated.im - k * mirrored.im + Real(2) * ab.im * v[2],
            (squared(m.a) - k * squared(m.b)) * v[2] - Real(2) * k * cross.re};
}

/// Translation by the length with half-length sine and cosine (sin_k(l/2), cos_k(l/2)) along the real axis,
/// then a turn by pi on the spot: from a halfedge's frame (origin at its tail, x axis along it) to its
/// twin's.
template <class Real>
Isometry<Real> translation_and_turn(const Real& sine, const Real& cosine) {
    return {{Real(0), cosine}, {Real(0), -sine}};
}

/// Rounds to double.
template <class Real>
Isometry<double> rounded(const Isometry<Real>& x) {
    return {{static_cast<double>(x.a.re), static_cast<double>(x.a.im)},
            {static_cast<double>(x.b.re), static_cast<double>(x.b.im)}};
}

/// Scales back to |a|^2 + kappa |b|^2 = 1 after many products.
template <class Real>
void normalise(int kappa, Isometry<Real>& x) {
    using std::sqrt;
    const Real norm = sqrt(squared(x.a) + Real(kappa) * squared(x.b));
    x.a = {x.a.re / norm, x.a.im / norm};
    x.b = {x.b.re / norm, x.b.im / norm};
}

/// Largest entry of x or -x minus the identity, whichever is nearer.
template <class Real>
Real distance_to_identity(const Isometry<Real>& x) {
    using std::sqrt;
    const Real sign = x.a.re < Real(0) ? Real(-1) : Real(1);
    const Complex<Real> a{sign * x.a.re - Real(1), x.a.im};
    const Real da = sqrt(squared(a)), db = sqrt(squared(x.b));
    return da > db ? da : db;
}

}  // namespace ricci
