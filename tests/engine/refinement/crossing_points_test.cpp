#include "engine/refinement/crossing_points.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "kernels/edge_flip.h"
#include "kernels/intrinsic_triangulation.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;
using Real = long double;
using Vector = std::array<Real, 3>;

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector combination(Real s, const Vector& a, Real t, const Vector& b) {
    return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}

/// A polygon cut into triangles from corner 0, then flipped at random: in a convex polygon, Euclidean or
/// ideal, every flip is geodesic, and two edges cross where their ends alternate.
struct Polygon {
    Connectivity original;
    NormalCurves curves;
    CurvePaths paths;

    static Connectivity fan(Index n) {
        std::vector<Triangle> faces;
        for (Index k = 1; k + 1 < n; ++k) faces.push_back({0, k, k + 1});
        return build_connectivity(faces, n);
    }
    Polygon(Index n, Index flips, Random& random) : original(fan(n)), curves(original) {
        for (Index i = 0; i < flips; ++i) {
            const Index h = random.below(original.halfedge_count());
            if (flippable(curves.connectivity(), h)) curves.flip(h);
        }
        paths = curves.trace();
    }
};

/// Calls f(original halfedge, crossing number) for every crossing.
template <class F>
void for_each_crossing(const Polygon& polygon, F&& f) {
    const std::vector<Index> lowest = edge_halfedges(polygon.original);
    for (Index e = 0; e < polygon.original.edge_count; ++e)
        for (Index x = polygon.paths.first[at(e)]; x < polygon.paths.first[at(e) + 1]; ++x)
            f(lowest[at(e)], at(x));
}

/// Corners at increasing directions, no two closer than a quarter of the mean.
std::vector<Real> directions(Index n, Real whole, Random& random) {
    std::vector<Real> angle;
    for (Index k = 0; k < n; ++k)
        angle.push_back(whole * (static_cast<Real>(k) + static_cast<Real>(random.uniform(0, 0.75))) /
                        static_cast<Real>(n));
    return angle;
}

TEST(CrossingPoints, NormalCurvesInAPolygonCrossWhereTheirEndsAlternate) {
    Random random(1);
    for (const Index n : {4, 5, 8, 13}) {
        const Polygon polygon(n, 20 * n, random);
        const Connectivity& now = polygon.curves.connectivity();
        const std::vector<Index> lowest = edge_halfedges(polygon.original);
        for (Index e = 0; e < polygon.original.edge_count; ++e) {
            const Index a = polygon.original.tail[at(lowest[at(e)])],
                        b = polygon.original.head(lowest[at(e)]);
            Index expected = 0;
            for (const Index h : edge_halfedges(now)) {
                const auto inside = [&](Index v) { return (v > a && v < b) || (v > b && v < a); };
                const Index p = now.tail[at(h)], q = now.head(h);
                if (p == a || p == b || q == a || q == b) continue;
                expected += inside(p) != inside(q) ? 1 : 0;
            }
            EXPECT_EQ(static_cast<Index>(polygon.paths.of(e).size()), expected);
            const Index along = polygon.paths.shared[at(e)];
            EXPECT_EQ(along >= 0, expected == 0);
            if (along < 0) continue;
            EXPECT_EQ(now.tail[at(along)], a);
            EXPECT_EQ(now.head(along), b);
        }
    }
}

TEST(CrossingPoints, StraightCurvesMeetLikeLinesInThePlane) {
    Random random(2);
    std::size_t crossings = 0;
    for (const Index n : {4, 6, 11}) {
        const Polygon polygon(n, 20 * n, random);
        const Connectivity& now = polygon.curves.connectivity();
        std::vector<Vector> corner;  // on an ellipse, in homogeneous coordinates
        for (const Real angle : directions(n, 2 * std::numbers::pi_v<Real>, random))
            corner.push_back({std::cos(angle), 1.7L * std::sin(angle), 1});
        std::vector<Real> log_length(now.tail.size());
        for (Index h = 0; h < now.halfedge_count(); ++h) {
            const Vector &p = corner[at(now.tail[at(h)])], &q = corner[at(now.head(h))];
            log_length[at(h)] = std::log(std::hypot(q[0] - p[0], q[1] - p[1]));
        }
        const std::vector<CrossingPoint> points = straight_crossings(now, log_length, polygon.paths);
        ASSERT_EQ(points.size(), polygon.paths.crossing.size());
        for_each_crossing(polygon, [&](Index h, std::size_t x) {
            const Vector &a = corner[at(polygon.original.tail[at(h)])],
                         &b = corner[at(polygon.original.head(h))];
            const Index g = polygon.paths.crossing[x].halfedge;
            const Vector &p = corner[at(now.tail[at(g)])], &q = corner[at(now.head(g))];
            Vector meet = cross(cross(a, b), cross(p, q));
            for (Real& value : meet) value /= meet[2];
            // Unfolding a strip of ten thin triangles (angles from 0.05 on) takes a few dozen roundings of
            // 5e-20, each magnified by up to 1/angle^2.
            const auto curve = combination(1 - points[x].on_curve, a, points[x].on_curve, b);
            const auto edge = combination(1 - points[x].on_edge, p, points[x].on_edge, q);
            for (std::size_t k = 0; k < 2; ++k) {
                EXPECT_NEAR(static_cast<double>(curve[k] - meet[k]), 0.0, 1e-15);
                EXPECT_NEAR(static_cast<double>(edge[k] - meet[k]), 0.0, 1e-15);
            }
            ++crossings;
        });
    }
    EXPECT_GT(crossings, 20u);
}

TEST(CrossingPoints, IdealCurvesMeetWherePlanesThroughLightLikeVectorsDo) {
    Random random(3);
    std::size_t crossings = 0;
    for (const Index n : {4, 4, 6, 11, 14}) {
        const Polygon polygon(n, 20 * n, random);
        const Connectivity& now = polygon.curves.connectivity();
        // v = w w^T as (x, y, t): <v_i, v_j> = -det(w_i, w_j)^2 / 2, so lambda_ij = |det(w_i, w_j)|. Spinors
        // over half a turn are ideal points over a whole one.
        std::vector<std::array<Real, 2>> spinor;
        std::vector<Vector> light;
        for (const Real angle : directions(n, std::numbers::pi_v<Real>, random)) {
            const auto size = static_cast<Real>(std::exp(random.uniform(-2, 2)));
            const Real p = size * std::cos(angle), q = size * std::sin(angle);
            spinor.push_back({p, q});
            light.push_back({(p * p - q * q) / 2, p * q, (p * p + q * q) / 2});
        }
        std::vector<Real> log_chord(now.tail.size());
        for (Index h = 0; h < now.halfedge_count(); ++h) {
            const auto &w = spinor[at(now.tail[at(h)])], &z = spinor[at(now.head(h))];
            log_chord[at(h)] = std::log(std::abs(w[0] * z[1] - w[1] * z[0]));
        }
        const std::vector<double> u = random.uniforms(at(n), -1.5, 1.5);
        const std::vector<CrossingPoint> points = ideal_crossings(now, log_chord, u, polygon.paths);
        ASSERT_EQ(points.size(), polygon.paths.crossing.size());
        for_each_crossing(polygon, [&](Index h, std::size_t x) {
            const Index i = polygon.original.tail[at(h)], j = polygon.original.head(h);
            const Index g = polygon.paths.crossing[x].halfedge, k = now.tail[at(g)], l = now.head(g);
            const Vector &a = light[at(i)], &b = light[at(j)], &p = light[at(k)], &q = light[at(l)];
            const Vector meet = cross(cross(a, b), cross(p, q));
            const Real t = points[x].on_curve;
            EXPECT_GT(t, 0);
            EXPECT_LT(t, 1);
            const Vector curve = combination(1 - t, a, t, b);
            const Vector edge = combination(points[x].tail * std::exp(static_cast<Real>(u[at(k)])), p,
                                            points[x].head * std::exp(static_cast<Real>(u[at(l)])), q);
            // The code only adds positive numbers; the cross products here lose up to the ratio of the
            // vectors' sizes, e^4, squared, of 5e-20.
            const Vector off = cross(curve, meet);
            EXPECT_LT(std::sqrt(dot(off, off) / (dot(curve, curve) * dot(meet, meet))), 1e-15L);
            for (std::size_t m = 0; m < 3; ++m)
                EXPECT_NEAR(static_cast<double>((edge[m] - curve[m]) / curve[2]), 0.0, 1e-15);
            ++crossings;
        });
    }
    EXPECT_GT(crossings, 20u);
}

}  // namespace
}  // namespace ricci
