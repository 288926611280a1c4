#include "engine/shape_space/principal_components.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/random.h"

namespace ricci {
namespace {

using Rows = std::vector<std::vector<double>>;

double dot(const std::vector<double>& x, const std::vector<double>& y) {
    double sum = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += x[k] * y[k];
    return sum;
}

TEST(PrincipalComponents, FindsAPlaneAndKeepsItsDistances) {
    testing::Random random(3);
    const std::vector<double> u{0.6, 0.0, 0.8, 0.0}, v{0.0, 1.0, 0.0, 0.0};
    Rows points;
    for (int k = 0; k < 40; ++k) {
        const double a = random.uniform(-3, 3), b = random.uniform(-1, 1);
        points.push_back({5 + a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2], -2});
    }
    const PrincipalComponents c = principal_components(points);
    EXPECT_NEAR(c.share(0) + c.share(1), 1.0, 1e-12);
    EXPECT_GT(c.share(0), 0.8);
    EXPECT_NEAR(c.mean[3], -2.0, 1e-12);
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(dot(c.axes[i], c.axes[j]), i == j ? 1.0 : 0.0, 1e-12);
    double variance = 0.0;
    for (const std::vector<double>& p : points) variance += std::pow(c.project(p, 1)[0], 2) / 40.0;
    EXPECT_NEAR(variance, c.variance[0], 1e-12);
    for (std::size_t k = 1; k < points.size(); ++k) {
        const std::vector<double> x = c.project(points[k], 2), y = c.project(points[k - 1], 2);
        double square = 0.0;
        for (std::size_t i = 0; i < 4; ++i) square += std::pow(points[k][i] - points[k - 1][i], 2);
        EXPECT_NEAR(std::hypot(x[0] - y[0], x[1] - y[1]), std::sqrt(square), 1e-12);
    }
    EXPECT_GT(c.axes[0][2], 0.0) << "the largest entry is positive";
}

TEST(PrincipalComponents, BordersOfTheDefinition) {
    const PrincipalComponents one = principal_components(Rows{{1.0, 2.0, 3.0}});
    EXPECT_EQ(one.share(0), 0.0);
    EXPECT_EQ(one.project(std::vector<double>{1.0, 2.0, 3.0}, 2), (std::vector<double>{0.0, 0.0}));
    EXPECT_EQ(principal_components(Rows{{1.0}, {3.0}}).project(std::vector<double>{3.0}, 2).size(), 1U);
    EXPECT_THROW(principal_components({}), std::invalid_argument);
    EXPECT_THROW(principal_components(Rows{{1.0}, {1.0, 2.0}}), std::invalid_argument);
    EXPECT_THROW((void)one.project(std::vector<double>{1.0}, 2), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
