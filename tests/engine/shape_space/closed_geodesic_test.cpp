#include "engine/shape_space/closed_geodesic.h"

#include <gtest/gtest.h>

#include "tests/engine/shape_space/marked_surface.h"

namespace ricci {
namespace {

using testing::Random;

Isometry<double> random_motion(Random& random) {
    const double angle = random.uniform(-3, 3), d = random.uniform(0, 2);
    const Isometry<double> turn{{std::cos(angle / 2), std::sin(angle / 2)}, {}};
    return compose(-1, turn, {{std::cosh(d / 2), 0}, {std::sinh(d / 2), 0}});
}

/// Short translations, whose trace is near 2, keep their digits; so do long ones, either sign of the matrix.
TEST(TranslationLength, KeepsDigitsNearTraceTwo) {
    Random random(1);
    for (const double length : {1e-6, 0.18, 1.0, 7.0, 30.0}) {
        Isometry<double> x = translation_along({0.6, 0.8, 0.0}, length);
        EXPECT_NEAR(translation_length(x) / length, 1, 1e-9);
        x.a = {-x.a.re, -x.a.im};
        x.b = {-x.b.re, -x.b.im};
        EXPECT_NEAR(translation_length(x) / length, 1, 1e-9);
    }
    EXPECT_EQ(translation_length(Isometry<double>{{0.8, 0.6}, {}}), 0.0) << "a turn";
}

TEST(AxisNormal, IsUndoneByTranslationAlong) {
    Random random(2);
    for (int k = 0; k < 50; ++k) {
        const Minkowski n = apply(-1, random_motion(random), Minkowski{0, 1, 0});
        const double length = random.uniform(0.1, 6);
        const Isometry<double> x = translation_along(n, length);
        EXPECT_NEAR(translation_length(x), length, 1e-9);
        EXPECT_TRUE(same_normal(axis_normal(x), n));
        EXPECT_TRUE(same_normal(axis_normal(Isometry<double>{{-x.a.re, -x.a.im}, {-x.b.re, -x.b.im}}), n));
        // A point of the axis moves along it by the length, with the positive side on the left.
        const double origin = foot_parameter(n, {0, 0, 1}), image = foot_parameter(n, image_of_origin(-1, x));
        EXPECT_NEAR(image - origin, length, 1e-8);
    }
}

TEST(LinesCross, ByTheAngleOfTheirNormals) {
    EXPECT_TRUE(lines_cross({0, 1, 0}, {1, 0, 0}));
    const Minkowski parallel{0, std::cosh(1.0), std::sinh(1.0)};
    EXPECT_FALSE(lines_cross({0, 1, 0}, parallel));
    EXPECT_FALSE(lines_cross({0, 1, 0}, {0, 1, 0})) << "itself";
    EXPECT_FALSE(lines_cross({0, 1, 0}, {0, -1, 0}));
    const Minkowski meet = line_crossing(-1, {0, 1, 0}, {1, 0, 0});
    EXPECT_NEAR(meet[2], 1, 1e-15);
}

/// Crossing numbers are those of the curves: a power changes nothing for simple ones, a b a^-1 b... does.
TEST(Crossings, OfCurvesWithKnownNumbers) {
    const testing::MarkedSurface m = testing::marked(testing::bent_row(2, RowPart::whole));
    const MarkedHandle& h = m.marking.handles[0];
    const auto geodesic = [&](const Isometry<Exact>& x) { return m.geodesic({h.vertex, x}); };
    const ClosedGeodesic a = geodesic(h.a), b = geodesic(h.b);
    Isometry<Exact> x = h.b;
    for (int k = 1; k < 6; ++k) {
        x = product(h.a, x);
        EXPECT_EQ(crossings(geodesic(x), b, *m.coarse), k) << "a^k b meets b k times";
        EXPECT_EQ(crossings(geodesic(x), a, *m.coarse), 1);
        EXPECT_EQ(self_crossings(geodesic(x), *m.coarse), 0);
    }
    // On a one-holed torus a^2 b^2 crosses itself once, the figure a b a^-1 b^-1 not at all.
    EXPECT_EQ(self_crossings(geodesic(product(h.a, h.a, h.b, h.b)), *m.coarse), 1);
    EXPECT_EQ(self_crossings(geodesic(product(h.a, h.b, inverse(h.a), inverse(h.b))), *m.coarse), 0);
    const std::optional<Meeting> meeting = nearest_meeting(a, b);
    ASSERT_TRUE(meeting);
    EXPECT_NEAR(minkowski(meeting->first, meeting->point), 0, 1e-9);
    EXPECT_NEAR(minkowski(meeting->second, meeting->point), 0, 1e-9);
    EXPECT_FALSE(nearest_meeting(a, m.geodesic(m.curve("a2"))));
}

}  // namespace
}  // namespace ricci
