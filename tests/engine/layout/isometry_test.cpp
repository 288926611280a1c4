#include "engine/layout/isometry.h"

#include <gtest/gtest.h>

#include <array>
#include <complex>
#include <limits>
#include <vector>

#include "engine/layout/surface_layout.h"
#include "kernels/extended.h"
#include "tests/support/random.h"

namespace ricci {
namespace {

using testing::Random;

/// An isometry that moves the origin by less than 4 (hyperbolic, plane) or anywhere (sphere).
template <class Real>
Isometry<Real> random_isometry(int kappa, Random& random) {
    using std::sqrt;
    Isometry<Real> x{{Real(random.uniform(-1, 1)), Real(random.uniform(-1, 1))},
                     {Real(random.uniform(-1, 1)), Real(random.uniform(-1, 1))}};
    // Away from the light cone, where |a| = |b|.
    if (kappa < 0) {
        const Real wanted = Real(random.uniform(0.0, 0.96)) * sqrt(squared(x.a) / squared(x.b));
        x.b = {x.b.re * wanted, x.b.im * wanted};
    }
    normalise(kappa, x);
    return x;
}

template <class Real>
std::array<Real, 3> random_vector(int kappa, Random& random) {
    return image_of_origin(kappa, random_isometry<Real>(kappa, random));
}

template <class Real>
Real largest(const std::array<Real, 3>& p, const std::array<Real, 3>& q) {
    using std::abs;
    Real most(0);
    for (std::size_t k = 0; k < 3; ++k) most = std::max<Real>(most, abs(p[k] - q[k]));
    return most;
}

template <class Real>
Real difference(const Isometry<Real>& x, const Isometry<Real>& y) {
    using std::sqrt;
    const Complex<Real> a{x.a.re - y.a.re, x.a.im - y.a.im}, b{x.b.re - y.b.re, x.b.im - y.b.im};
    return sqrt(squared(a) + squared(b));
}

/// kappa x.x' + t t', or the distance in the plane.
template <class Real>
Real form(int kappa, const std::array<Real, 3>& p, const std::array<Real, 3>& q) {
    if (kappa == 0) return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
    return Real(kappa) * (p[0] * q[0] + p[1] * q[1]) + p[2] * q[2];
}

/// (a z + b) / (-kappa conj(b) z + conj(a)).
template <class Real>
Complex<Real> moebius(int kappa, const Isometry<Real>& m, const Complex<Real>& z) {
    const Complex<Real> above = m.a * z + m.b;
    const Complex<Real> cross = conjugate(m.b) * z;
    const Complex<Real> below{m.a.re - Real(kappa) * cross.re, -m.a.im - Real(kappa) * cross.im};
    const Complex<Real> product = above * conjugate(below);
    const Real size = squared(below);
    return {product.re / size, product.im / size};
}

/// Vectors are of size up to 1200 (|a|^2 + |b|^2 <= 26 each, three in a row at most and squared), so a few
/// roundings of epsilon relative to that.
template <class Real>
Real tolerance() {
    return Real(20000) * std::numeric_limits<Real>::epsilon();
}

template <class Real>
void expect_group_laws() {
    Random random(1);
    for (const int kappa : {-1, 0, 1})
        for (int round = 0; round < 50; ++round) {
            const auto x = random_isometry<Real>(kappa, random), y = random_isometry<Real>(kappa, random),
                       z = random_isometry<Real>(kappa, random);
            EXPECT_LT(distance_to_identity(compose(kappa, x, inverse(x))), tolerance<Real>());
            EXPECT_LT(
                difference(compose(kappa, compose(kappa, x, y), z), compose(kappa, x, compose(kappa, y, z))),
                tolerance<Real>());
            EXPECT_LT(difference(inverse(compose(kappa, x, y)), compose(kappa, inverse(y), inverse(x))),
                      tolerance<Real>());
            const Isometry<Real> product = compose(kappa, x, y);
            const Real one = squared(product.a) + Real(kappa) * squared(product.b) - Real(1);
            EXPECT_LT(one < Real(0) ? -one : one, tolerance<Real>());
            const Isometry<Real> minus{{-x.a.re, -x.a.im}, {-x.b.re, -x.b.im}};
            EXPECT_EQ(distance_to_identity(x), distance_to_identity(minus));
        }
}

template <class Real>
void expect_actions() {
    Random random(2);
    for (const int kappa : {-1, 0, 1})
        for (int round = 0; round < 50; ++round) {
            const auto x = random_isometry<Real>(kappa, random), y = random_isometry<Real>(kappa, random);
            const auto p = random_vector<Real>(kappa, random), q = random_vector<Real>(kappa, random);
            const std::array<Real, 3> origin{Real(0), Real(0), Real(1)};
            EXPECT_LT(largest(image_of_origin(kappa, x), apply(kappa, x, origin)), tolerance<Real>());
            EXPECT_LT(largest(apply(kappa, compose(kappa, x, y), p), apply(kappa, x, apply(kappa, y, p))),
                      tolerance<Real>());
            // On a point, and on a vector that is none.
            const Real change = form(kappa, apply(kappa, x, p), apply(kappa, x, q)) - form(kappa, p, q);
            EXPECT_LT(change < Real(0) ? -change : change, tolerance<Real>());
            const std::array<Real, 3> any{p[0] + q[0], p[1] - q[1], p[2] + Real(2) * q[2]};
            std::array<Real, 3> image = apply(kappa, x, any);
            for (std::size_t k = 0; k < 3; ++k) {
                std::array<Real, 3> unit{Real(0), Real(0), Real(0)};
                unit[k] = any[k];
                const std::array<Real, 3> part = apply(kappa, x, unit);
                for (std::size_t i = 0; i < 3; ++i) image[i] -= part[i];
            }
            EXPECT_LT(largest(image, {Real(0), Real(0), Real(0)}), tolerance<Real>());
            // z = x / (1 + t).
            const std::array<Real, 3> moved = apply(kappa, x, p);
            const Complex<Real> z{p[0] / (Real(1) + p[2]), p[1] / (Real(1) + p[2])};
            const Complex<Real> w = moebius(kappa, x, z);
            EXPECT_LT(largest<Real>({moved[0], moved[1], Real(0)},
                                    {w.re * (Real(1) + moved[2]), w.im * (Real(1) + moved[2]), Real(0)}),
                      tolerance<Real>());
        }
}

TEST(Isometry, ObeysTheLawsOfAGroup) {
    expect_group_laws<double>();
    expect_group_laws<long double>();
    expect_group_laws<Extended<50>>();
}

TEST(Isometry, ActsOnVectorsAndByMoebiusMapsAlike) {
    expect_actions<double>();
    expect_actions<long double>();
    expect_actions<Extended<50>>();
}

TEST(Isometry, PassesFromAHalfedgeToItsTwin) {
    for (const int kappa : {-1, 0, 1})
        for (const double length : {0.1, 1.0, 2.5}) {
            const double half = length / 2;
            const double sine = kappa < 0 ? std::sinh(half) : (kappa > 0 ? std::sin(half) : half);
            const double cosine = kappa < 0 ? std::cosh(half) : (kappa > 0 ? std::cos(half) : 1.0);
            const auto move = translation_and_turn(sine, cosine);
            const std::array<double, 3> head = image_of_origin(kappa, move);
            const double reached = kappa == 0  ? head[0]
                                   : kappa < 0 ? std::asinh(head[0])
                                               : std::atan2(head[0], head[2]);
            EXPECT_NEAR(reached, length, 4e-15);
            EXPECT_NEAR(head[1], 0.0, 1e-15);
            // From the twin's frame back to the halfedge's the motion is the same.
            EXPECT_LT(distance_to_identity(compose(kappa, move, move)), 1e-14);
            // The x axis turns about: the tail lies ahead of the head.
            const std::array<double, 3> tail = apply(kappa, move, head);
            EXPECT_LT(largest(tail, {0.0, 0.0, 1.0}), 1e-14);
        }
}

TEST(Isometry, ConvertsPointsBetweenModels) {
    Random random(3);
    for (int round = 0; round < 50; ++round) {
        const auto p = random_vector<double>(-1, random);
        const std::array<double, 2> z = conformal_point(-1, p), k = projective_point(p),
                                    w = half_plane_point(p);
        const double size = z[0] * z[0] + z[1] * z[1];
        EXPECT_LT(size, 1.0);
        for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(k[i], 2 * z[i] / (1 + size), 1e-14);
        // Cayley: w = i (1 + z) / (1 - z).
        const std::complex<double> disk(z[0], z[1]);
        const std::complex<double> cayley = std::complex<double>(0, 1) * (1.0 + disk) / (1.0 - disk);
        EXPECT_NEAR(w[0], cayley.real(), 1e-11);  // 1 - z loses up to 1e3
        EXPECT_NEAR(w[1], cayley.imag(), 1e-11);
        EXPECT_GT(w[1], 0.0);
        const auto s = random_vector<double>(1, random);
        const std::array<double, 2> stereographic = conformal_point(1, s);
        EXPECT_NEAR(stereographic[0] * (1 + s[2]), s[0], 1e-15);
        EXPECT_NEAR(projective_point(s)[1] * s[2], s[1], 1e-15);
        const auto e = random_vector<double>(0, random);
        EXPECT_NEAR(e[2], 1.0, 1e-15);
        EXPECT_EQ(conformal_point(0, e)[0], e[0]);
        EXPECT_EQ(conformal_point(0, e)[1], e[1]);
    }
}

TEST(Isometry, IsAMatrixOfTheHalfPlane) {
    Random random(4);
    for (int round = 0; round < 50; ++round) {
        const auto x = random_isometry<double>(-1, random), y = random_isometry<double>(-1, random);
        const auto m = half_plane_matrix(x), n = half_plane_matrix(y),
                   mn = half_plane_matrix(compose(-1, x, y));
        EXPECT_NEAR(m[0] * m[3] - m[1] * m[2], 1.0, 1e-13);
        const std::array<double, 4> product = {m[0] * n[0] + m[1] * n[2], m[0] * n[1] + m[1] * n[3],
                                               m[2] * n[0] + m[3] * n[2], m[2] * n[1] + m[3] * n[3]};
        for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(product[k], mn[k], 1e-13);
        const auto p = random_vector<double>(-1, random);
        const std::array<double, 2> w = half_plane_point(p), moved = half_plane_point(apply(-1, x, p));
        const std::complex<double> z(w[0], w[1]), image = (m[0] * z + m[1]) / (m[2] * z + m[3]);
        EXPECT_NEAR(image.real(), moved[0], 1e-11 * (1 + std::abs(image)));
        EXPECT_NEAR(image.imag(), moved[1], 1e-11 * (1 + std::abs(image)));
    }
}

std::array<double, 9> times(const std::array<double, 9>& m, const std::array<double, 9>& n) {
    std::array<double, 9> product{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) product[3 * i + j] += m[3 * i + k] * n[3 * k + j];
    return product;
}

TEST(Isometry, IsAMatrixOfThreeRows) {
    Random random(5);
    for (const int kappa : {-1, 0, 1})
        for (int round = 0; round < 50; ++round) {
            const auto x = random_isometry<double>(kappa, random), y = random_isometry<double>(kappa, random);
            const auto matrix = [&](const Isometry<double>& z) {
                return kappa == 0 ? plane_matrix(z) : projective_matrix(kappa, z);
            };
            const auto m = matrix(x), product = times(m, matrix(y)), whole = matrix(compose(kappa, x, y));
            for (std::size_t k = 0; k < 9; ++k)
                EXPECT_NEAR(product[k], whole[k], 1e-12 * (1 + std::abs(whole[k])));
            const auto p = random_vector<double>(kappa, random), moved = apply(kappa, x, p);
            for (std::size_t i = 0; i < 3; ++i)
                EXPECT_NEAR(m[3 * i] * p[0] + m[3 * i + 1] * p[1] + m[3 * i + 2] * p[2], moved[i], 1e-11);
        }
}

}  // namespace
}  // namespace ricci
