// Isometries of the three planes against their action on vectors and points.
#include "engine/layout/isometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "engine/layout/surface_layout.h"
#include "tests/support/random.h"

namespace ricci {
namespace {

using Vector = std::array<double, 3>;

Isometry<double> random_isometry(int kappa, testing::Random& random) {
    const double r = random.uniform(0, 1.4), phi = random.uniform(-3, 3), turn = random.uniform(-3, 3);
    const double c = kappa < 0 ? std::cosh(r) : (kappa > 0 ? std::cos(r) : 1.0);
    const double s = kappa < 0 ? std::sinh(r) : (kappa > 0 ? std::sin(r) : r);
    return {{c * std::cos(turn), c * std::sin(turn)}, {s * std::cos(phi), s * std::sin(phi)}};
}

Vector random_point(int kappa, testing::Random& random) {
    return image_of_origin(kappa, random_isometry(kappa, random));
}

void expect_near(const Vector& a, const Vector& b) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-12 * (1 + std::abs(a[k])));
}

class Planes : public ::testing::TestWithParam<int> {};

TEST_P(Planes, FormAGroupThatActsOnVectors) {
    const int kappa = GetParam();
    testing::Random random(3);
    for (int k = 0; k < 100; ++k) {
        const auto x = random_isometry(kappa, random), y = random_isometry(kappa, random);
        const Vector p = random_point(kappa, random);
        EXPECT_NEAR(kappa * (p[0] * p[0] + p[1] * p[1]) + p[2] * p[2], 1.0, 1e-12 * p[2] * p[2]);
        expect_near(apply(kappa, compose(kappa, x, y), p), apply(kappa, x, apply(kappa, y, p)));
        expect_near(apply(kappa, inverse(x), apply(kappa, x, p)), p);
        expect_near(apply(kappa, x, image_of_origin(kappa, y)), image_of_origin(kappa, compose(kappa, x, y)));
        EXPECT_LT(distance_to_identity(compose(kappa, x, inverse(x))), 1e-12);
    }
}

TEST_P(Planes, ActOnPointsByMoebiusMaps) {
    const int kappa = GetParam();
    testing::Random random(4);
    for (int k = 0; k < 100; ++k) {
        const auto x = random_isometry(kappa, random);
        const Vector p = random_point(kappa, random);
        // Half the Euclidean coordinate: the plane's z.
        const double half = kappa == 0 ? 0.5 : 1.0;
        const auto z0 = conformal_point(kappa, p), z1 = conformal_point(kappa, apply(kappa, x, p));
        const std::complex<double> z(half * z0[0], half * z0[1]), a(x.a.re, x.a.im), b(x.b.re, x.b.im);
        const std::complex<double> image = (a * z + b) / (-double(kappa) * std::conj(b) * z + std::conj(a));
        EXPECT_NEAR(image.real(), half * z1[0], 1e-11 * (1 + std::abs(image)));
        EXPECT_NEAR(image.imag(), half * z1[1], 1e-11 * (1 + std::abs(image)));
    }
}

TEST_P(Planes, MatricesAreHomomorphisms) {
    const int kappa = GetParam();
    testing::Random random(5);
    for (int k = 0; k < 30; ++k) {
        const auto x = random_isometry(kappa, random), y = random_isometry(kappa, random);
        const auto matrix = [&](const Isometry<double>& m) {
            return kappa == 0 ? plane_matrix(m) : projective_matrix(kappa, m);
        };
        const auto p = matrix(x), q = matrix(y), r = matrix(compose(kappa, x, y));
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                double entry = 0;
                for (std::size_t l = 0; l < 3; ++l) entry += p[3 * i + l] * q[3 * l + j];
                EXPECT_NEAR(entry, r[3 * i + j], 1e-10 * (1 + std::abs(entry)));
            }
    }
}

INSTANTIATE_TEST_SUITE_P(Curvatures, Planes, ::testing::Values(-1, 0, 1));

TEST(HalfPlane, MatrixMovesPointsAsTheDiskDoes) {
    testing::Random random(6);
    for (int k = 0; k < 100; ++k) {
        const auto x = random_isometry(-1, random);
        const Vector p = random_point(-1, random);
        const auto m = half_plane_matrix(x);
        EXPECT_NEAR(m[0] * m[3] - m[1] * m[2], 1.0, 1e-11);
        const auto w0 = half_plane_point(p), w1 = half_plane_point(apply(-1, x, p));
        const std::complex<double> w(w0[0], w0[1]), image = (m[0] * w + m[1]) / (m[2] * w + m[3]);
        EXPECT_NEAR(image.real(), w1[0], 1e-10 * (1 + std::abs(image)));
        EXPECT_NEAR(image.imag(), w1[1], 1e-10 * (1 + std::abs(image)));
    }
}

}  // namespace
}  // namespace ricci
