#include "engine/shape_space/dual_curves.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace ricci {
namespace {

Isometry<Exact> along_x(double length) {
    const Exact half = Exact(length) / Exact(2);
    return {{cosh(half), Exact(0)}, {sinh(half), Exact(0)}};
}
Isometry<Exact> turned(double angle) {
    const Exact half = Exact(angle) / Exact(2);
    return {{cos(half), sin(half)}, {}};
}

/// Pants on the right of the x axis: p1 p2 = the translation by s to the right, the foot of the seam to p2
/// at the origin, so that the axis of p2 crosses the y axis below it, to the right too.
struct Pants {
    Isometry<Exact> p1, p2;
};
double seam(double s, double p2, double p1) {
    return std::acosh((std::cosh(s / 2) * std::cosh(p2 / 2) + std::cosh(p1 / 2)) /
                      (std::sinh(s / 2) * std::sinh(p2 / 2)));
}
Pants pants_right_of(double s, double p1, double p2) {
    const Isometry<Exact> down =
        product(turned(-std::numbers::pi / 2), along_x(seam(s, p2, p1)), turned(std::numbers::pi / 2));
    const Isometry<Exact> x = conjugated(along_x(p2), down);
    return {product(along_x(s), inverse(x)), x};
}

struct Lengths {
    double s, p1, p2, q1, q2, twist;
};

/// Two pairs of pants glued along the x axis, the seam of q1 a distance `twist` further along it than that
/// of p2.
FourHoledSphere glued(const Lengths& l) {
    const Pants p = pants_right_of(l.s, l.p1, l.p2);
    // q1 q2 = s^-1 on its left: the same picture turned by pi, with q2 in the place of p2.
    const Pants q = pants_right_of(l.s, l.q1, l.q2);
    const Isometry<Exact> way = product(along_x(l.twist), Isometry<Exact>{{Exact(0), Exact(1)}, {}});
    return {p.p1, p.p2, conjugated(q.p1, way), conjugated(q.p2, way)};
}

/// Up to sign.
double trace(const Isometry<Exact>& x) {
    return 2 * std::cosh(translation_length(x) / 2);
}
double half(double length) {
    return 2 * std::cosh(length / 2);
}

const std::array<Lengths, 6> kSamples{{{2.0, 1.5, 2.5, 3.0, 1.0, 0.0},
                                       {2.0, 1.5, 2.5, 3.0, 1.0, 0.3},
                                       {0.4, 2.0, 1.0, 0.7, 3.0, -5.1},
                                       {6.0, 4.0, 5.0, 4.5, 6.5, 2.9},
                                       {3.0, 3.0, 3.0, 3.0, 3.0, 0.75},
                                       {1.0, 0.2, 8.0, 0.3, 7.0, 40.3}}};

TEST(DualCurves, TheSamplesAreFourHoledSpheres) {
    for (const Lengths& l : kSamples) {
        const FourHoledSphere f = glued(l);
        EXPECT_NEAR(translation_length(f.p1), l.p1, 1e-9);
        EXPECT_NEAR(translation_length(f.p2), l.p2, 1e-9);
        EXPECT_NEAR(translation_length(f.q1), l.q1, 1e-9);
        EXPECT_NEAR(translation_length(f.q2), l.q2, 1e-9);
        const Isometry<Exact> closing = product(f.p1, f.p2, f.q1, f.q2);
        EXPECT_LT(static_cast<double>(distance_to_identity(closing)), 1e-9);
        const Minkowski s = axis_normal(product(f.p1, f.p2)), p = axis_normal(f.p1), q = axis_normal(f.q1);
        EXPECT_GT(minkowski(s, p), 1) << "the pants lie between s and p1, on the right of s, the left of p1";
        EXPECT_LT(minkowski(s, q), -1) << "q1 runs the other way";
    }
}

/// The trace identity of the four-holed sphere, all traces positive: y around two of the holes, z around two
/// others. Which ones depends on the parity of m.
TEST(DualCurves, KeepTheTraceIdentity) {
    for (const Lengths& l : kSamples) {
        const DualCurves d = dual_curves(glued(l));
        const double x = half(l.s), y = trace(d.y), z = trace(d.z);
        const double a = half(l.p1), b = half(l.p2), c = half(l.q1), e = half(l.q2);
        const double fx = a * b + c * e, even = b * c + a * e, odd = a * c + b * e;
        const double constant = a * a + b * b + c * c + e * e + a * b * c * e - 4;
        const auto miss = [&](double fy, double fz) {
            return std::abs(x * x + y * y + z * z - x * y * z + fx * x + fy * y + fz * z + constant) /
                   (x * y * z);
        };
        EXPECT_LT(std::min(miss(even, odd), miss(odd, even)), 1e-10);
    }
}

/// y and z from lengths and twist alone, by the closed formula: their traces are y = Y + 2 B cosh t,
/// z = Z + 2 B cosh(t + s/2) with (Y, Z) the centre of the identity's conic.
TEST(DualCurves, FollowFromLengthsAndTwist) {
    for (const Lengths& l : kSamples) {
        const DualCurves d = dual_curves(glued(l));
        const double x = half(l.s), a = half(l.p1), b = half(l.p2), c = half(l.q1), e = half(l.q2);
        const double even = b * c + a * e, odd = a * c + b * e, fx = a * b + c * e;
        const auto difference = [&](double fy, double fz) {
            const double ymid = (2 * fy + x * fz) / (x * x - 4), zmid = (2 * fz + x * fy) / (x * x - 4);
            const double level = x * x + fx * x + a * a + b * b + c * c + e * e + a * b * c * e - 4 +
                                 (fy * ymid + fz * zmid) / 2;
            const double twice_b = std::sqrt(level) / std::sinh(l.s / 2);
            const double y = ymid + twice_b * std::cosh(d.twist),
                         z = zmid + twice_b * std::cosh(d.twist + l.s / 2);
            return std::max(std::abs(y / trace(d.y) - 1), std::abs(z / trace(d.z) - 1));
        };
        EXPECT_LT(std::min(difference(even, odd), difference(odd, even)), 1e-9) << "s = " << l.s;
    }
}

TEST(DualCurves, TheTwistIsThatOfTheGluing) {
    for (const Lengths& l : kSamples) {
        const DualCurves d = dual_curves(glued(l));
        EXPECT_GE(d.twist, -l.s / 8 - 1e-9);
        EXPECT_LT(d.twist, 3 * l.s / 8 + 1e-9);
        EXPECT_NEAR(std::remainder(d.twist - l.twist, l.s / 2), 0, 1e-8) << "up to half turns";
        EXPECT_NEAR(d.gap, std::min(d.twist / l.s + 0.125, 0.375 - d.twist / l.s), 1e-12);
    }
}

/// A full turn of the gluing gives the same curves; z grows with the twist.
TEST(DualCurves, TurnWithTheGluing) {
    for (const Lengths& l : kSamples) {
        Lengths turned_full = l, more = l;
        turned_full.twist += l.s;
        const DualCurves d = dual_curves(glued(l)), full = dual_curves(glued(turned_full));
        EXPECT_NEAR(full.twist, d.twist, 1e-8);
        EXPECT_NEAR(translation_length(full.y), translation_length(d.y), 1e-8);
        EXPECT_NEAR(translation_length(full.z), translation_length(d.z), 1e-8);
        if (d.gap < 0.01) continue;
        more.twist += 0.001 * l.s;
        const DualCurves e = dual_curves(glued(more));
        EXPECT_NEAR(e.twist - d.twist, 0.001 * l.s, 1e-8);
        EXPECT_EQ(e.twist > d.twist, translation_length(e.z) > translation_length(d.z));
    }
}

/// One-holed torus from a, the boundary e and the twist t: cosh(b/2) = K cosh(t/2), and ab the same with
/// t + a; K sinh(a/2) = sqrt((cosh a + cosh(e/2)) / 2).
TEST(TorusTwist, IsThatOfTheCoshRelation) {
    for (const double a : {0.2, 1.0, 3.0})
        for (const double t : {-4.0, -0.3, 0.0, 0.1, 1.7})
            for (const double angle : {0.7, 1.3, std::numbers::pi / 2}) {
                // b: axis across that of a by `angle`, turned along a by t.
                const Isometry<Exact> x = along_x(a);
                const Isometry<Exact> b = conjugated(along_x(2.5), turned(angle));
                const double base = torus_twist(x, b);
                const Isometry<Exact> further = product(along_x(t), b);
                EXPECT_NEAR(torus_twist(x, further), base + t, 1e-9);
                const double e = translation_length(product(x, further, inverse(x), inverse(further)));
                if (e == 0) continue;
                const double k = std::sqrt((std::cosh(a) + std::cosh(e / 2)) / 2) / std::sinh(a / 2);
                const double twist = torus_twist(x, further);
                EXPECT_NEAR(std::cosh(translation_length(further) / 2), k * std::cosh(twist / 2), 1e-8);
                EXPECT_NEAR(std::cosh(translation_length(product(x, further)) / 2),
                            k * std::cosh((twist + a) / 2), 1e-8 * k * std::cosh((twist + a) / 2));
            }
}

}  // namespace
}  // namespace ricci
