#include "engine/shape_space/nearest_modulus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/shape_space/flat_distance.h"
#include "tests/support/random.h"

namespace ricci {
namespace {

using Modulus = std::complex<double>;

Modulus image(const ModularElement& m, Modulus w) {
    return (static_cast<double>(m[0]) * w + static_cast<double>(m[1])) /
           (static_cast<double>(m[2]) * w + static_cast<double>(m[3]));
}

TEST(NearestModulus, IsAnEquivalentOneAtTheTeichmuellerDistance) {
    testing::Random random(7);
    for (int k = 0; k < 2000; ++k) {
        const Modulus tau(random.uniform(-3, 3), std::exp(random.uniform(-2, 2))),
            reference(random.uniform(-3, 3), std::exp(random.uniform(-2, 2)));
        const EquivalentModulus near = nearest_modulus(tau, reference);
        const ModularElement& m = near.element;
        EXPECT_EQ(m[0] * m[3] - m[1] * m[2], 1);
        EXPECT_LT(std::abs(image(m, tau) - near.modulus), 1e-9 * std::abs(near.modulus));
        // torus_distance is the minimum over all equivalent moduli (flat_distance_test tries them).
        EXPECT_NEAR(marked_torus_distance(near.modulus, reference), torus_distance(tau, reference), 1e-9);
    }
}

TEST(NearestModulus, StaysWhereItIsNear) {
    testing::Random random(8);
    for (int k = 0; k < 500; ++k) {
        const Modulus tau(random.uniform(-2, 2), std::exp(random.uniform(-1, 1)));
        const Modulus near = tau + Modulus(random.uniform(-1e-4, 1e-4), random.uniform(-1e-4, 1e-4));
        EXPECT_LT(std::abs(nearest_modulus(near, tau).modulus - near), 1e-9) << tau;
    }
}

TEST(NearestModulus, MarkedDistanceIsHalfTheHyperbolicOne) {
    EXPECT_NEAR(marked_torus_distance({0.3, 1.0}, {0.3, 2.0}), 0.5 * std::log(2.0), 1e-14);
    EXPECT_NEAR(marked_torus_distance({0.0, 1.0}, {3.0, 1.0}), 0.5 * std::acosh(5.5), 1e-14);
    EXPECT_THROW(marked_torus_distance({0.0, 0.0}, {0.0, 1.0}), std::invalid_argument);
    EXPECT_THROW(nearest_modulus({0.0, 1.0}, {0.0, -1.0}), std::invalid_argument);
    EXPECT_THROW(nearest_modulus({std::numeric_limits<double>::quiet_NaN(), 1.0}, {0.0, 1.0}),
                 std::invalid_argument);
}

}  // namespace
}  // namespace ricci
