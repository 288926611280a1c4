// Corner angles and areas of single triangles against closed forms, in the three geometries and both
// precisions.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "kernels/face_kernels.h"
#include "tests/support/random.h"

namespace ricci {
namespace {

using testing::Random;
using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;
constexpr double kEps = std::numeric_limits<double>::epsilon();

template <class T>
struct Evaluated {
    std::array<T, 3> angle;  // at corner k, opposite halfedge k+1
    T area;
    std::int64_t broken;
};

/// One face with the given chords of its halfedges.
template <class T>
Evaluated<T> evaluate(Geometry geometry, std::array<Real, 3> chord) {
    const std::vector<Index> tail = {0, 1, 2};
    std::vector<T> log_chord(3);
    for (std::size_t k = 0; k < 3; ++k) log_chord[k] = static_cast<T>(std::log(chord[k]));
    const std::vector<double> u(3, 0.0);
    Evaluated<T> result{};
    std::vector<T> angle(3), area(1);
    result.broken =
        evaluate_faces<T>(geometry, ScaledChords<T>{tail, log_chord, u}, {angle, {}, {}, area}, false);
    for (std::size_t k = 0; k < 3; ++k) result.angle[k] = angle[k];
    result.area = area[0];
    return result;
}

Real chord_of(Geometry geometry, Real length) {
    if (geometry == Geometry::hyperbolic) return 2 * std::sinh(length / 2);
    if (geometry == Geometry::spherical) return 2 * std::sin(length / 2);
    return length;
}

std::array<Real, 3> chords_of(Geometry geometry, std::array<Real, 3> length) {
    for (Real& l : length) l = chord_of(geometry, l);
    return length;
}

/// Angle opposite a from the cosine law as every textbook prints it.
Real cosine_law(Geometry geometry, Real a, Real b, Real c) {
    if (geometry == Geometry::hyperbolic)
        return std::acos((std::cosh(b) * std::cosh(c) - std::cosh(a)) / (std::sinh(b) * std::sinh(c)));
    if (geometry == Geometry::spherical)
        return std::acos((std::cos(a) - std::cos(b) * std::cos(c)) / (std::sin(b) * std::sin(c)));
    return std::acos((b * b + c * c - a * a) / (2 * b * c));
}

/// How far the angles move when every chord moves by `relative` of itself: |d theta_a / d log b| <= cot sums
/// in the plane. The chords here carry the rounding of a logarithm of size at most `log_size`, of its
/// exponential (4 ulp in the vector library) and the formula about twenty roundings more.
double rounding_bound(const std::array<Real, 3>& angle, double log_size) {
    Real cotangents = 1;
    for (const Real a : angle) cotangents += std::abs(1 / std::tan(a));
    return static_cast<double>((log_size + 24) * kEps * 2 * cotangents);
}

constexpr std::array kGeometries = {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical};

TEST(CornerAngles, AgreeWithTheCosineLawInBothPrecisions) {
    Random random(1);
    for (const Geometry geometry : kGeometries) {
        int tested = 0;
        for (int trial = 0; trial < 2000; ++trial) {
            std::array<Real, 3> l{};
            for (Real& x : l) x = random.uniform(0.05, geometry == Geometry::spherical ? 2.0 : 4.0);
            // Well inside the triangle inequality, so that the cosine law in long double is a reference.
            const Real s = (l[0] + l[1] + l[2]) / 2;
            if (s - l[0] < 0.02L || s - l[1] < 0.02L || s - l[2] < 0.02L || s > 3.1L) continue;
            ++tested;
            const auto chord = chords_of(geometry, l);
            const std::array<Real, 3> expected = {cosine_law(geometry, l[1], l[2], l[0]),
                                                  cosine_law(geometry, l[2], l[0], l[1]),
                                                  cosine_law(geometry, l[0], l[1], l[2])};
            const auto fine = evaluate<Real>(geometry, chord);
            const auto coarse = evaluate<double>(geometry, chord);
            ASSERT_EQ(fine.broken + coarse.broken, 0);
            const double bound = rounding_bound(expected, 3.0);
            for (std::size_t k = 0; k < 3; ++k) {
                // acos loses half of the digits near 0 and pi, where its slope 1/sin is below 1e5: 1e-14.
                ASSERT_NEAR(static_cast<double>(fine.angle[k] - expected[k]), 0.0, 1e-14)
                    << name_of(geometry);
                ASSERT_NEAR(static_cast<double>(coarse.angle[k] - expected[k]), 0.0, 1e-14 + bound)
                    << name_of(geometry) << ' ' << l[0] << ' ' << l[1] << ' ' << l[2];
            }
            const Real excess = expected[0] + expected[1] + expected[2] - kPi;
            const Real area =
                geometry == Geometry::euclidean ? l[0] * l[1] * std::sin(expected[1]) / 2 : std::abs(excess);
            ASSERT_NEAR(static_cast<double>(fine.area - area), 0.0, 1e-13);
            ASSERT_NEAR(static_cast<double>(coarse.area - area), 0.0, 1e-13 + 10 * bound);
        }
        EXPECT_GT(tested, 200) << name_of(geometry);
    }
}

TEST(CornerAngles, NeedlesKeepTheirRelativeAccuracy) {
    const Real thin = 1e-8L;
    const auto t = evaluate<double>(Geometry::euclidean, {1.0L, thin, 1.0L});
    EXPECT_EQ(t.broken, 0);
    // log(1e-8) = -18.4 is rounded to 4 eps/2 * 18.4/16 or so: 20 eps relative, and 24 eps as above.
    const Real apex = 2 * std::asin(thin / 2);
    EXPECT_NEAR(static_cast<double>(t.angle[0] / apex), 1.0, 44 * kEps);
    EXPECT_NEAR(static_cast<double>(t.angle[1] - std::acos(thin / 2)), 0.0, 24 * kEps);
    EXPECT_NEAR(t.angle[0] + t.angle[1] + t.angle[2], std::numbers::pi, 8 * kEps);
    EXPECT_NEAR(static_cast<double>(t.area / (thin / 2)), 1.0, 44 * kEps);
    // Height 1e-4 over a base of 1: the excess of the two sides over the base is 2e-8, known to eps / 2e-8.
    const Real side = std::sqrt(0.25L + 1e-8L);
    const auto flat = evaluate<double>(Geometry::euclidean, {1.0L, side, side});
    EXPECT_NEAR(static_cast<double>(flat.angle[0] / std::atan(2e-4L)), 1.0, 48 * kEps / 2e-8);
    const auto fine = evaluate<Real>(Geometry::euclidean, {1.0L, side, side});
    EXPECT_NEAR(static_cast<double>(fine.angle[0] / std::atan(2e-4L)), 1.0, 48 * 1.1e-19 / 2e-8);
}

TEST(CornerAngles, AnglesDoNotDependOnScaleInThePlane) {
    const Real sizes[] = {1e-40L, 1.0L, 1e40L};
    for (const Real size : sizes) {
        const auto t = evaluate<double>(Geometry::euclidean, {3 * size, 4 * size, 5 * size});
        // Corner 1 lies between the halves 3 and 4. Logarithms up to 94: 94/2 ulp each, amplified by cot sums
        // of 25/12.
        EXPECT_NEAR(t.angle[1], std::numbers::pi / 2, 94 * kEps * 2 * 3.1);
        EXPECT_NEAR(static_cast<double>(t.area / (6 * size * size)), 1.0, 94 * kEps * 4);
    }
}

TEST(CornerAngles, SphericalOctantHasThreeRightAngles) {
    const Real edge = std::sqrt(2.0L);
    const auto t = evaluate<double>(Geometry::spherical, {edge, edge, edge});
    EXPECT_EQ(t.broken, 0);
    for (const double a : t.angle) EXPECT_NEAR(a, std::numbers::pi / 2, 24 * kEps);
    EXPECT_NEAR(t.area, std::numbers::pi / 2, 24 * kEps);
}

TEST(CornerAngles, LargeHyperbolicTrianglesAreNearlyIdeal) {
    for (const Real length : {5.0L, 20.0L, 40.0L}) {
        const Real chord = chord_of(Geometry::hyperbolic, length);
        const auto t = evaluate<double>(Geometry::hyperbolic, {chord, chord, chord});
        EXPECT_EQ(t.broken, 0);
        const Real expected = 2 * std::asin(1 / (2 * std::cosh(length / 2)));
        // chord^3 under a root over chord^4: relative errors of (log chord/2 + 4) eps, a few times.
        const double relative = (static_cast<double>(length) / 2 + 8) * 3 * kEps;
        for (const double a : t.angle) EXPECT_NEAR(static_cast<double>(a / expected), 1.0, relative);
        EXPECT_NEAR(static_cast<double>(t.area - (kPi - 3 * expected)), 0.0, 24 * kEps);
    }
}

/// Largest difference between the corner angles in a curved geometry and Legendre's theorem, theta + kappa A
/// / 3.
Real legendre_defect(Geometry geometry, Real size) {
    const std::array<Real, 3> l = {1.0L * size, 0.8L * size, 0.7L * size};
    const auto curved = evaluate<Real>(geometry, chords_of(geometry, l));
    const auto flat = evaluate<Real>(Geometry::euclidean, l);
    Real largest = 0;
    for (std::size_t k = 0; k < 3; ++k)
        largest = std::max(largest, std::abs(curved.angle[k] - flat.angle[k] -
                                             static_cast<Real>(curvature_sign(geometry)) * flat.area / 3));
    return largest;
}

TEST(CornerAngles, SmallCurvedTrianglesFollowLegendreToFourthOrder) {
    for (const Geometry geometry : {Geometry::hyperbolic, Geometry::spherical}) {
        const Real coarse = legendre_defect(geometry, 0.1L), fine = legendre_defect(geometry, 0.05L);
        ASSERT_GT(coarse, 1e-9L);
        // Next order is size^6: the ratio is 16 up to a relative size^2 = 0.01.
        EXPECT_NEAR(static_cast<double>(coarse / fine), 16.0, 0.3) << name_of(geometry);
        // And to second order without the correction.
        const auto flat = evaluate<double>(Geometry::euclidean, {1e-6L, 0.8e-6L, 0.7e-6L});
        const auto curved = evaluate<double>(geometry, {1e-6L, 0.8e-6L, 0.7e-6L});
        // size^2 = 1e-12 and the rounding of logarithms near -14.
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(curved.angle[k], flat.angle[k], 1e-12 + 100 * kEps);
        EXPECT_NEAR(curved.area / flat.area, 1.0, 1e-11);
    }
}

TEST(CornerAngles, BrokenTrianglesAreCountedAndExtendContinuously) {
    for (const Geometry geometry : kGeometries) {
        const std::array<Real, 3> length = {0.5L, 0.4L, 1.0L};  // halfedge 2 lies opposite corner 1
        const auto broken = evaluate<double>(geometry, chords_of(geometry, length));
        EXPECT_EQ(broken.broken, 1) << name_of(geometry);
        EXPECT_EQ(broken.angle[0], 0.0);
        EXPECT_EQ(broken.angle[1], std::numbers::pi);
        EXPECT_EQ(broken.angle[2], 0.0);
        EXPECT_EQ(broken.area, 0.0);
        // Just inside the inequality: angles O(sqrt(gap)) from the extension. 16 A^2 ~ 8 gap l l' l'' and so
        // pi - theta ~ sqrt(2 * gap * (a+b)/(ab)) < 3 sqrt(gap).
        const auto near = evaluate<Real>(geometry, chords_of(geometry, {0.5L, 0.5L, 1.0L - 1e-10L}));
        EXPECT_EQ(near.broken, 0);
        EXPECT_NEAR(static_cast<double>(near.angle[1]), std::numbers::pi, 3e-5);
        EXPECT_GT(static_cast<double>(kPi - near.angle[1]), 1e-6);
    }
    // On the sphere: a chord beyond the diameter, and a perimeter beyond a great circle (three angles of pi).
    EXPECT_EQ(evaluate<double>(Geometry::spherical, {2.1L, 1.9L, 1.9L}).broken, 1);
    EXPECT_EQ(
        evaluate<double>(Geometry::spherical, chords_of(Geometry::spherical, {2.2L, 2.2L, 2.2L})).broken, 1);
    EXPECT_EQ(
        evaluate<double>(Geometry::spherical, chords_of(Geometry::spherical, {2.0L, 2.0L, 2.0L})).broken, 0);
}

TEST(CornerAngles, BrokenFacesAreCountedOnceEachInAnyBlock) {
    const std::size_t faces = 1000;
    std::vector<Index> tail(3 * faces, 0);
    const std::vector<double> u(1, 0.0);
    std::vector<double> log_chord(3 * faces, 0.0), angle(3 * faces);
    std::int64_t expected = 0;
    for (std::size_t f = 0; f < faces; f += 7, ++expected) log_chord[3 * f] = 1.0;  // sides e, 1, 1
    const ScaledChords<double> chords{tail, log_chord, u};
    EXPECT_EQ(evaluate_faces<double>(Geometry::euclidean, chords, {angle, {}, {}, {}}, false), expected);
    EXPECT_EQ(evaluate_faces<double>(Geometry::euclidean, chords, {angle, {}, {}, {}}, true), expected);
}

TEST(CornerAngles, SumCornersAddsEveryCornerOfAVertex) {
    const std::vector<Index> tail = {0, 1, 2, 0, 2, 0};
    const std::vector<double> angle = {1, 2, 4, 8, 16, 32};
    std::vector<double> total(4, -1.0);
    sum_corners<double>(tail, angle, total);
    EXPECT_EQ(total, (std::vector<double>{41, 2, 20, 0}));
}

}  // namespace
}  // namespace ricci
