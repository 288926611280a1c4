// The area distortion of thesis section 5.3.1.2 from its definition, in long double.
#include "engine/sweep/area_distortion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;

/// Mean of (log(S_f / sum S) - log(s_f / sum s))^2 from logarithms of areas.
double by_definition(const std::vector<double>& area, const std::vector<long double>& log_new) {
    long double before = 0, after = 0, sum = 0;
    for (const double a : area) before += a;
    for (const long double l : log_new) after += std::exp(l);
    for (std::size_t f = 0; f < area.size(); ++f) {
        const long double d =
            std::log(static_cast<long double>(area[f]) / before) - (log_new[f] - std::log(after));
        sum += d * d;
    }
    return static_cast<double>(sum / static_cast<long double>(area.size()));
}

TEST(AreaDistortion, FollowsItsDefinition) {
    Random random(1);
    const SurfaceMesh mesh = testing::bumpy_torus(9, 7);
    const std::vector<double> area = face_areas(mesh);
    const auto& tail = mesh.connectivity.tail;
    // e^40 squared overflows no long double.
    for (const double spread : {0.1, 2.0, 40.0}) {
        const auto u = random.uniforms(63, -spread, spread);
        std::vector<long double> log_new(area.size());
        for (std::size_t f = 0; f < area.size(); ++f)
            log_new[f] = std::log(static_cast<long double>(area[f])) +
                         2.0L / 3 *
                             (static_cast<long double>(u[at(tail[3 * f])]) + u[at(tail[3 * f + 1])] +
                              u[at(tail[3 * f + 2])]);
        const double expected = by_definition(area, log_new);
        EXPECT_NEAR(area_distortion_of_scaling(area, tail, u) / expected, 1.0, 1e-13) << spread;
        std::vector<double> shifted = u;
        for (double& x : shifted) x += 30.0;
        EXPECT_NEAR(area_distortion_of_scaling(area, tail, shifted) / expected, 1.0, 1e-13) << spread;
    }
    std::vector<double> made(area.size());
    std::vector<long double> log_made(area.size());
    for (std::size_t f = 0; f < area.size(); ++f) {
        made[f] = area[f] * random.uniform(0.01, 3.0);
        log_made[f] = std::log(static_cast<long double>(made[f]));
    }
    EXPECT_NEAR(area_distortion_of_areas(area, made) / by_definition(area, log_made), 1.0, 1e-13);
}

TEST(AreaDistortion, IsZeroExactlyForSimilarities) {
    const SurfaceMesh mesh = testing::icosahedron(0.2);
    const std::vector<double> area = face_areas(mesh);
    // (sum of roundings)^2.
    EXPECT_LT(area_distortion_of_scaling(area, mesh.connectivity.tail, std::vector<double>(12, 1.7)), 1e-28);
    std::vector<double> u(12, 0.0);
    u[3] = 0.1;
    EXPECT_GT(area_distortion_of_scaling(area, mesh.connectivity.tail, u), 1e-4);
    // Two faces, one doubled: log ratios 0 and log 2 against log 3/2.
    const double expected = (std::pow(std::log(1.5), 2) + std::pow(std::log(2.0 / 1.5), 2)) / 2;
    EXPECT_NEAR(area_distortion_of_areas(std::vector<double>{1, 1}, std::vector<double>{1, 2}), expected,
                1e-15);
}

}  // namespace
}  // namespace ricci
