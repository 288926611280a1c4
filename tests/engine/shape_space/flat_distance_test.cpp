#include "engine/shape_space/flat_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "tests/support/random.h"

namespace ricci {
namespace {

using testing::Random;
using Modulus = std::complex<double>;

double half_hyperbolic(Modulus z, Modulus w) {
    return 0.5 * std::acosh(1.0 + std::norm(z - w) / (2 * z.imag() * w.imag()));
}

Modulus moved(const std::array<int, 4>& g, Modulus w) {
    return (static_cast<double>(g[0]) * w + static_cast<double>(g[1])) /
           (static_cast<double>(g[2]) * w + static_cast<double>(g[3]));
}

/// Minimum over all of SL(2,Z) with entries up to `most`.
double brute_force(Modulus z, Modulus w, int most) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int a = -most; a <= most; ++a)
        for (int b = -most; b <= most; ++b)
            for (int c = -most; c <= most; ++c)
                for (int d = -most; d <= most; ++d)
                    if (a * d - b * c == 1)
                        nearest = std::min(nearest, half_hyperbolic(z, moved({a, b, c, d}, w)));
    return nearest;
}

Modulus in_domain(Random& random) {
    const double x = random.uniform(-0.5, 0.5);
    return {x, std::sqrt(1 - x * x) * random.uniform(1.0, 1.0 + random.uniform(0.0, 1.5))};
}

TEST(FlatDistance, TorusDistanceIsTheMinimumOverTheModularGroup) {
    Random random(1);
    int translations = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const Modulus z = in_domain(random), w = in_domain(random);
        const double distance = torus_distance(z, w);
        EXPECT_NEAR(distance, brute_force(z, w, 4), 1e-9);
        if (distance < half_hyperbolic(z, w) - 1e-6) ++translations;
    }
    EXPECT_GT(translations, 50);  // the plain distance is not enough
}

TEST(FlatDistance, NearTheCornersOfTheDomain) {
    // Where many images of w are about as near.
    Random random(2);
    const double root = std::sqrt(3.0) / 2;
    int inverses = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const auto near = [&](double x) {
            return Modulus(x, std::max(root, std::sqrt(1 - x * x)) + random.uniform(1e-6, 0.05));
        };
        const Modulus z = near(random.uniform(0.4, 0.5)), w = near(random.uniform(-0.5, -0.4));
        const double distance = torus_distance(z, w);
        EXPECT_NEAR(distance, brute_force(z, w, 4), 1e-9);
        if (distance < half_hyperbolic(z, w + 1.0) - 1e-6) ++inverses;
    }
    EXPECT_GT(inverses, 20);
}

TEST(FlatDistance, IsAMetricOnTheModularSurface) {
    Random random(3);
    for (int trial = 0; trial < 200; ++trial) {
        const Modulus x = in_domain(random), y = in_domain(random), z = in_domain(random);
        EXPECT_NEAR(torus_distance(x, y), torus_distance(y, x), 1e-12);
        EXPECT_LE(torus_distance(x, z), torus_distance(x, y) + torus_distance(y, z) + 1e-9);
        EXPECT_NEAR(torus_distance(x, moved({7, 3, 2, 1}, x)), 0.0, 1e-7);
        EXPECT_NEAR(torus_distance(x, moved({2, 5, 1, 3}, y)), torus_distance(x, y), 1e-7);
        // Mirror images are another class, at the same distance from one another.
        EXPECT_NEAR(torus_distance(-std::conj(x), -std::conj(y)), torus_distance(x, y), 1e-9);
    }
}

TEST(FlatDistance, KnownDistances) {
    // Along the axis: stretching by k costs (1/2) log k.
    EXPECT_NEAR(torus_distance({0.0, 1.0}, {0.0, 3.0}), 0.5 * std::log(3.0), 1e-14);
    EXPECT_NEAR(torus_distance({0.0, 2.0}, {0.0, 1e8}), 0.5 * std::log(5e7), 1e-12);
    EXPECT_EQ(torus_distance({0.2, 1.3}, {0.2, 1.3}), 0.0);
    // Square to hexagon: along the unit circle, half of log tan(90 - 60/2).
    EXPECT_NEAR(torus_distance({0.0, 1.0}, std::polar(1.0, std::numbers::pi / 3)),
                0.5 * std::log(std::tan(std::numbers::pi / 3)), 1e-14);
    // A small step is its length over the height, halved, to full relative precision.
    EXPECT_NEAR(torus_distance({0.1, 2.0}, {0.1 + 1e-9, 2.0}) / (1e-9 / 4.0), 1.0, 1e-6);
    EXPECT_NEAR(annulus_distance(0.5, 2.0), std::log(2.0), 1e-15);
    EXPECT_EQ(annulus_distance(0.7, 0.7), 0.0);
    EXPECT_NEAR(annulus_distance(1e-300, 1e300), 0.5 * 600 * std::log(10.0), 1e-9);
}

TEST(FlatDistance, RefusesWhatIsNoModulus) {
    EXPECT_THROW(torus_distance({0.0, -1.0}, {0.0, 1.0}), std::invalid_argument);
    EXPECT_THROW(torus_distance({0.0, 1.0}, {0.0, 0.0}), std::invalid_argument);
    EXPECT_THROW(torus_distance({std::nan(""), 1.0}, {0.0, 1.0}), std::invalid_argument);
    EXPECT_THROW(annulus_distance(0.0, 1.0), std::invalid_argument);
    EXPECT_THROW(annulus_distance(1.0, std::numeric_limits<double>::infinity()), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
