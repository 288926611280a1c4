#include "engine/shape_space/spherical_harmonics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/random.h"

namespace ricci {
namespace {

using testing::Random;

Point random_point(Random& random) {
    const double z = random.uniform(-1, 1), phi = random.uniform(0, 7), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

std::vector<double> harmonics(int degree, const Point& p) {
    std::vector<double> value(harmonic_count(degree));
    spherical_harmonics(degree, p, value);
    return value;
}

TEST(SphericalHarmonics, FirstOnesAreWhatTheyAre) {
    Random random(1);
    const double pi = std::numbers::pi;
    for (int trial = 0; trial < 50; ++trial) {
        const Point p = random_point(random);
        const std::vector<double> y = harmonics(2, p);
        const double one = std::sqrt(3 / (4 * pi)), two = std::sqrt(15 / (4 * pi));
        EXPECT_NEAR(y[0], std::sqrt(1 / (4 * pi)), 1e-15);
        EXPECT_NEAR(y[harmonic_index(1, -1)], one * p[1], 1e-15);
        EXPECT_NEAR(y[harmonic_index(1, 0)], one * p[2], 1e-15);
        EXPECT_NEAR(y[harmonic_index(1, 1)], one * p[0], 1e-15);
        EXPECT_NEAR(y[harmonic_index(2, -2)], two * p[0] * p[1], 1e-15);
        EXPECT_NEAR(y[harmonic_index(2, -1)], two * p[1] * p[2], 1e-15);
        EXPECT_NEAR(y[harmonic_index(2, 0)], std::sqrt(5 / (16 * pi)) * (3 * p[2] * p[2] - 1), 1e-14);
        EXPECT_NEAR(y[harmonic_index(2, 1)], two * p[0] * p[2], 1e-15);
        EXPECT_NEAR(y[harmonic_index(2, 2)], two / 2 * (p[0] * p[0] - p[1] * p[1]), 1e-15);
    }
}

TEST(SphericalHarmonics, AdditionTheorem) {
    // sum_m Y_lm(p) Y_lm(q) = (2l + 1) / (4 pi) P_l(p . q), to degree 60, where P_l is of the library.
    Random random(2);
    for (int trial = 0; trial < 30; ++trial) {
        const Point p = random_point(random), q = random_point(random);
        const std::vector<double> at_p = harmonics(60, p), at_q = harmonics(60, q);
        const double cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        for (int l = 0; l <= 60; ++l) {
            double sum = 0.0;
            for (int m = -l; m <= l; ++m) sum += at_p[harmonic_index(l, m)] * at_q[harmonic_index(l, m)];
            const double expected = (2 * l + 1) / (4 * std::numbers::pi) *
                                    std::legendre(static_cast<unsigned>(l), std::clamp(cosine, -1.0, 1.0));
            EXPECT_NEAR(sum, expected, 1e-12) << l;
        }
    }
}

TEST(SphericalHarmonics, AreOrthonormal) {
    // Products have degree 8 in z, where Gauss's rule of five points is exact to 9; equal steps in phi.
    constexpr int kDegree = 4, kSteps = 20;
    const double x[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                         0.9061798459386640},
                 w[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                         0.2369268850561891};
    const std::size_t count = harmonic_count(kDegree);
    std::vector<double> gram(count * count, 0.0);
    for (int k = 0; k < 5; ++k)
        for (int step = 0; step < kSteps; ++step) {
            const double phi = 2 * std::numbers::pi * step / kSteps, r = std::sqrt(1 - x[k] * x[k]);
            const std::vector<double> y = harmonics(kDegree, {r * std::cos(phi), r * std::sin(phi), x[k]});
            for (std::size_t i = 0; i < count; ++i)
                for (std::size_t j = 0; j < count; ++j)
                    gram[i * count + j] += w[k] * 2 * std::numbers::pi / kSteps * y[i] * y[j];
        }
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j) EXPECT_NEAR(gram[i * count + j], i == j ? 1.0 : 0.0, 1e-13);
}

TEST(SphericalHarmonics, ParityUnderTheMirror) {
    Random random(3);
    const Point p = random_point(random);
    const std::vector<double> above = harmonics(9, p), below = harmonics(9, {p[0], p[1], -p[2]});
    for (int l = 0; l <= 9; ++l)
        for (int m = -l; m <= l; ++m)
            EXPECT_NEAR(below[harmonic_index(l, m)],
                        ((l + m) % 2 == 0 ? 1 : -1) * above[harmonic_index(l, m)], 1e-14);
}

TEST(SphericalHarmonics, AtThePoles) {
    for (const double z : {1.0, -1.0}) {
        const std::vector<double> y = harmonics(12, {0.0, 0.0, z});
        for (int l = 0; l <= 12; ++l)
            for (int m = -l; m <= l; ++m)
                EXPECT_NEAR(y[harmonic_index(l, m)],
                            m == 0 ? std::pow(z, l) * std::sqrt((2 * l + 1) / (4 * std::numbers::pi)) : 0.0,
                            1e-13);
    }
}

}  // namespace
}  // namespace ricci
