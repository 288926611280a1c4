// Geodesics of the Poincare disk against isometries, which turn them into straight lines.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include "io/picture/circular_arc.h"
#include "io/picture/svg.h"

namespace ricci {
namespace {

using Complex = std::complex<double>;

Complex complex_of(const PlanePoint& p) {
    return {p[0], p[1]};
}

// The isometry that takes z1 to the origin.
Complex moved(const Complex& z1, const Complex& z) {
    return (z - z1) / (1.0 - std::conj(z1) * z);
}

TEST(PictureArc, GeodesicsAreStraightOnceTheirStartIsTheOrigin) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi), radius(0.0, 0.95);
    for (int i = 0; i < 2000; ++i) {
        const double phi = angle(random), r1 = radius(random), r2 = radius(random);
        // Every other pair lies next to a diameter, as close as 1e-16.
        const double psi =
            i % 2 == 0 ? angle(random) : phi + std::numbers::pi + std::pow(10.0, -1.0 * (i % 17));
        const PlanePoint z1{r1 * std::cos(phi), r1 * std::sin(phi)},
            z2{r2 * std::cos(psi), r2 * std::sin(psi)};
        const CircularArc arc = poincare_geodesic(z1, z2);
        const Complex end = moved(complex_of(z1), complex_of(z2));
        double previous = 0.0;
        for (const double t : {0.0, 0.1, 0.5, 0.9, 1.0}) {
            const Complex p = moved(complex_of(z1), complex_of(point_on(arc, t)));
            // Points are off by a few roundings, which the isometry stretches by 1/(1 - 0.95^2) = 10.
            EXPECT_NEAR(std::imag(p * std::conj(end)), 0.0, 3e-14) << i << " " << t;
            EXPECT_GE(std::real(p * std::conj(end)), previous - 3e-14) << i << " " << t;
            previous = std::real(p * std::conj(end));
        }
        EXPECT_NEAR(previous, std::norm(end), 3e-14);
    }
}

TEST(PictureArc, DiametersAreStraight) {
    EXPECT_EQ(poincare_geodesic({0.25, 0.5}, {-0.125, -0.25}).curvature, 0.0);
    EXPECT_EQ(poincare_geodesic({0, 0}, {0.3, 0.7}).curvature, 0.0);
    EXPECT_EQ(poincare_geodesic({1, 0}, {-1, 0}).curvature, 0.0);
    EXPECT_EQ(poincare_geodesic({0.3, 0.7}, {0.3, 0.7}).curvature, 0.0);
    EXPECT_EQ(poincare_geodesic({0, 1}, {0, 1}).curvature, 0.0);
}

TEST(PictureArc, IdealQuarter) {
    const CircularArc arc = poincare_geodesic({1, 0}, {0, 1});  // about (1, 1), radius 1, turning right
    EXPECT_NEAR(arc.curvature, -1.0, 1e-15);
    const PlanePoint middle = point_on(arc, 0.5);
    const double expected = 1.0 - std::sqrt(0.5);
    EXPECT_NEAR(middle[0], expected, 1e-15);  // rounding of numbers below 1
    EXPECT_NEAR(middle[1], expected, 1e-15);
    EXPECT_NEAR(poincare_geodesic({0, 1}, {1, 0}).curvature, 1.0, 1e-15);
}

// The same formula in long double, from the same points.
long double reference_curvature(const PlanePoint& z1, const PlanePoint& z2) {
    const std::complex<long double> a(z1[0], z1[1]), b(z2[0], z2[1]);
    return -2.0L * std::imag(std::conj(a) * b) / (std::abs(a - b) * std::abs(1.0L - std::conj(a) * b));
}

TEST(PictureArc, CurvatureOfClosePointsAndNextToDiameters) {
    for (int digits = 1; digits < 12; ++digits) {
        const double small = std::pow(10.0, -digits);
        const PlanePoint z1{0.3, 0.47}, close{0.3 + small, 0.47 - 0.3 * small},
            opposite{-0.15, -0.235 + small};
        // A dozen roundings of relative size 1.1e-16 in the first; in the second relative to 1, since the
        // curvature itself goes to zero there. The reference's own cancellation costs 1e-19 / 1e-11.
        const auto exact = static_cast<double>(reference_curvature(z1, close));
        EXPECT_NEAR(poincare_geodesic(z1, close).curvature / exact, 1.0, 2e-15 + 1e-19 / small) << digits;
        const auto straight = static_cast<double>(reference_curvature(z1, opposite));
        EXPECT_NEAR(poincare_geodesic(z1, opposite).curvature, straight, 1e-15) << digits;
    }
}

// Points at the edge of the disk and so near to one another that nothing but rounding tells them apart: the
// arc is at most half a circle, and a path takes it in two parts at most.
TEST(PictureArc, NeighboursAtTheEdgeOfTheDisk) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    int capped = 0;
    for (int k = 0; k < 20000; ++k) {
        const double angle = 6.0 * uniform(random), step = std::pow(10.0, -6.0 - 12.0 * uniform(random));
        const auto ideal = [&](double phi) {
            const double radius = 1.0 - std::pow(10.0, -8.0 - 9.0 * uniform(random));
            return PlanePoint{radius * std::cos(phi), radius * std::sin(phi)};
        };
        const CircularArc arc = poincare_geodesic(ideal(angle), ideal(angle + step));
        const double turn =
            std::abs(arc.curvature) * std::hypot(arc.to[0] - arc.from[0], arc.to[1] - arc.from[1]);
        ASSERT_LE(turn, 2.0 + 1e-12);
        capped += turn > 1.999999 ? 1 : 0;
        SvgPicture picture(100, 100, {-1, -1, 2, 2});
        picture.path(SvgPath().arc(arc), stroked(kBlack));
        ASSERT_LT(picture.document().size(), 600U);
    }
    EXPECT_GT(capped, 0);  // the case is among them
}

TEST(PictureArc, PointsLieEvenlyOnTheCircle) {
    // Half a circle about (0, 0) from (1, 0), turning left.
    const CircularArc arc{{1, 0}, {-1, 0}, 1.0};
    for (const double t : {0.0, 0.25, 0.5, 1.0}) {
        const PlanePoint p = point_on(arc, t);
        // asin near 1 loses half of the digits where the angle is not exactly a right one; here it is.
        EXPECT_NEAR(p[0], std::cos(std::numbers::pi * t), 1e-15);
        EXPECT_NEAR(p[1], std::sin(std::numbers::pi * t), 1e-15);
    }
    const CircularArc line{{1, 2}, {3, 6}, 0.0};
    EXPECT_EQ(point_on(line, 0.25), (PlanePoint{1.5, 3.0}));
    const CircularArc nearly{{1, 2}, {3, 6}, 1e-300};
    EXPECT_EQ(point_on(nearly, 0.25), (PlanePoint{1.5, 3.0}));
}

TEST(PictureArc, RefusesPointsOutside) {
    EXPECT_THROW(poincare_geodesic({1.01, 0}, {0, 0}), std::invalid_argument);
    EXPECT_THROW(poincare_geodesic({0, 0}, {0, std::numeric_limits<double>::quiet_NaN()}),
                 std::invalid_argument);
    EXPECT_THROW(poincare_geodesic({0, std::numeric_limits<double>::infinity()}, {0, 0}),
                 std::invalid_argument);
    EXPECT_NO_THROW(poincare_geodesic({1.0 + 1e-15, 0}, {0, 0}));
}

}  // namespace
}  // namespace ricci
