// What several tests of sweeps compare.
#pragma once

#include <gtest/gtest.h>

#include "engine/sweep/sweep_solver.h"

namespace ricci::testing {

/// What must agree bit for bit, which is everything but the time.
inline void expect_same(const SweepSolve& a, const SweepSolve& b) {
    EXPECT_EQ(a.vertex, b.vertex);
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.area_distortion, b.area_distortion);
    EXPECT_EQ(a.residual_max, b.residual_max);
    EXPECT_EQ(a.newton_iterations, b.newton_iterations);
    EXPECT_EQ(a.flips, b.flips);
    EXPECT_EQ(a.precision_digits, b.precision_digits);
    EXPECT_EQ(a.gauss_bonnet_error, b.gauss_bonnet_error);
    EXPECT_EQ(a.conformal_factor, b.conformal_factor);
}

}  // namespace ricci::testing
