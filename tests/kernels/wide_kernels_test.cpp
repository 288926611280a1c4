// The kernels in 50 digits: they agree with long double where that suffices, their derivatives are those of
// their angles, and needles that long double cannot tell apart come out right.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/delaunay.h"
#include "kernels/extended.h"
#include "kernels/face_kernels.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;

struct Evaluated {
    std::vector<long double> angle, area;
    std::vector<double> off, diagonal;
    std::int64_t broken = 0;
};

template <class Real>
Evaluated evaluate(Geometry geometry, const IntrinsicTriangulation<Real>& t, ConformalFactor u) {
    Evaluated e;
    const std::size_t halfedges = t.log_chord.size();
    e.angle.resize(halfedges);
    e.area.resize(halfedges / 3);
    e.off.resize(halfedges);
    e.diagonal.resize(halfedges);
    e.broken = evaluate_faces<Real>(geometry, ScaledChords<Real>{t.connectivity.tail, t.log_chord, u},
                                    {e.angle, e.off, e.diagonal, e.area}, false);
    return e;
}

SurfaceMesh small_torus(double size) {
    SurfaceMesh mesh = testing::bumpy_torus(8, 6);
    for (Point& p : mesh.points)
        for (double& x : p) x *= size;
    return make_surface_mesh(mesh.points, triangles_of(mesh.connectivity));
}

TEST(WideKernels, AgreeWithLongDouble) {
    Random random(3);
    const SurfaceMesh mesh = small_torus(0.1);
    const auto wide = intrinsic_triangulation<WideReal>(mesh);
    const auto plain = intrinsic_triangulation<long double>(mesh);
    const std::vector<double> u = random.uniforms(at(mesh.connectivity.vertex_count), -0.1, 0.1);
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical}) {
        const Evaluated a = evaluate<WideReal>(geometry, wide, u),
                        b = evaluate<long double>(geometry, plain, u);
        EXPECT_EQ(a.broken, 0);
        EXPECT_EQ(b.broken, 0);
        for (std::size_t h = 0; h < a.angle.size(); ++h) {
            // Some ten roundings of 2^-64, amplified by cotangents below 20.
            EXPECT_NEAR(static_cast<double>(a.angle[h] - b.angle[h]), 0.0, 1e-16);
            EXPECT_NEAR(a.off[h], b.off[h], 1e-14 * (1.0 + std::abs(b.off[h])));
            EXPECT_NEAR(a.diagonal[h], b.diagonal[h], 1e-14 * (1.0 + std::abs(b.diagonal[h])));
        }
        for (std::size_t f = 0; f < a.area.size(); ++f)
            EXPECT_NEAR(static_cast<double>(a.area[f] / b.area[f]), 1.0, 1e-15);
    }
}

TEST(WideKernels, DerivativesAreThoseOfTheAngles) {
    Random random(4);
    const SurfaceMesh mesh = small_torus(0.1);
    const auto t = intrinsic_triangulation<WideReal>(mesh);
    const Connectivity& c = t.connectivity;
    const std::vector<double> u = random.uniforms(at(c.vertex_count), -0.1, 0.1);
    // The step lies in the low part: it is added to u exactly. Errors: h^2 and 2^-64 / h.
    constexpr double h = 1e-6;
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical}) {
        const Evaluated here = evaluate<WideReal>(geometry, t, u);
        for (const Index v : {0, 5, 17}) {
            std::vector<double> low(u.size(), 0.0);
            low[at(v)] = h;
            const Evaluated up = evaluate<WideReal>(geometry, t, {u, low});
            low[at(v)] = -h;
            const Evaluated down = evaluate<WideReal>(geometry, t, {u, low});
            for (Index e = 0; e < c.halfedge_count(); ++e) {
                const auto rate = [&](Index corner) {
                    return static_cast<double>((up.angle[at(corner)] - down.angle[at(corner)]) / (2 * h));
                };
                if (c.tail[at(e)] == v) {
                    EXPECT_NEAR(rate(e), here.diagonal[at(e)], 1e-8);
                    EXPECT_NEAR(rate(next_halfedge(e)), here.off[at(e)], 1e-8);
                }
            }
        }
    }
}

/// One face with corners in the plane, lengths to 50 digits.
IntrinsicTriangulation<WideReal> triangle_at(const std::array<std::array<WideReal, 2>, 3>& corner) {
    IntrinsicTriangulation<WideReal> t;
    t.connectivity.tail = {0, 1, 2};
    t.connectivity.vertex_count = 3;
    for (std::size_t k = 0; k < 3; ++k) {
        const WideReal x = corner[(k + 1) % 3][0] - corner[k][0], y = corner[(k + 1) % 3][1] - corner[k][1];
        t.log_chord.push_back(log(WideReal(x * x + y * y)) / 2);
    }
    return t;
}

TEST(WideKernels, KnowTheAnglesOfNeedles) {
    // A base of length e^-40 seen from distance 1 at 50 degrees: its ends' angles hang on lengths that agree
    // in 17 digits.
    const WideReal base = exp(WideReal(-40)), fifty = 50 * atan(WideReal(1)) / 45;
    const auto t = triangle_at({{{WideReal(0), WideReal(0)}, {base, WideReal(0)}, {cos(fifty), sin(fifty)}}});
    const std::vector<double> zero(3, 0.0);
    const Evaluated wide = evaluate<WideReal>(Geometry::euclidean, t, zero);
    const WideReal at_apex = base * sin(fifty);  // to e^-80
    EXPECT_NEAR(static_cast<double>(wide.angle[0] - static_cast<long double>(fifty)), 0.0, 1e-18);
    EXPECT_NEAR(static_cast<double>(wide.angle[2] / static_cast<long double>(at_apex)), 1.0, 1e-15);
    IntrinsicTriangulation<long double> rounded;
    rounded.connectivity = t.connectivity;
    for (const WideReal& x : t.log_chord) rounded.log_chord.push_back(static_cast<long double>(x));
    const Evaluated plain = evaluate<long double>(Geometry::euclidean, rounded, zero);
    EXPECT_GT(std::abs(static_cast<double>(plain.angle[0] - static_cast<long double>(fifty))), 1e-6)
        << "the cause of it all has gone";
}

TEST(WideKernels, KnowTheAnglesOfFlatTriangles) {
    // Height e^-30 over the middle: the angle at the top is pi - 4 height.
    const WideReal height = exp(WideReal(-30));
    const auto t =
        triangle_at({{{WideReal(0), WideReal(0)}, {WideReal(1), WideReal(0)}, {WideReal(0.5), height}}});
    const Evaluated wide = evaluate<WideReal>(Geometry::euclidean, t, std::vector<double>(3, 0.0));
    const long double h = static_cast<long double>(height);
    EXPECT_EQ(wide.broken, 0);
    EXPECT_NEAR(static_cast<double>(wide.angle[0] / (2 * h)), 1.0, 1e-15);  // atan(2h), to h^2
    EXPECT_NEAR(static_cast<double>(wide.angle[1] / (2 * h)), 1.0, 1e-15);
    EXPECT_NEAR(static_cast<double>(wide.angle[2] - (std::numbers::pi_v<long double> - 4 * h)), 0.0, 1e-18);
}

TEST(WideKernels, ReadTheLowPart) {
    const WideReal base = exp(WideReal(-30));
    const auto t = triangle_at({{{WideReal(0), WideReal(0)}, {base, WideReal(0)}, {base / 3, WideReal(1)}}});
    const std::vector<double> high = {30.0, -2.0, 0.5}, none(3, 0.0);
    std::vector<double> low(3, 0.0);
    low[0] = 1e-16;  // below what 30 can hold
    const Evaluated without = evaluate<WideReal>(Geometry::euclidean, t, none),
                    with = evaluate<WideReal>(Geometry::euclidean, t, {none, low});
    // d theta_1 / d u_0 = cot(theta_2)/2, about e^30 / 2.
    const double change = static_cast<double>(with.angle[1] - without.angle[1]);
    EXPECT_NEAR(change / (1e-16 * without.off[0]), 1.0, 1e-3);
    EXPECT_GT(std::abs(change), 1e-4);
    // In double the low part is not read.
    const ConformalFactor split{high, low};
    EXPECT_EQ(split.at<double>(0), 30.0);
    EXPECT_EQ(static_cast<double>(split.at<WideReal>(0) - WideReal(30)), 1e-16);
}

/// Two faces over the edge from (0,0) to (1,0), apices (1/2, h) and (1/2, -depth).
IntrinsicTriangulation<WideReal> flat_kite(const WideReal& h, const WideReal& depth) {
    IntrinsicTriangulation<WideReal> t;
    // Halfedges 0: i->j, 1: j->k, 2: k->i; 3: j->i, 4: i->l, 5: l->j.
    t.connectivity.tail = {0, 1, 2, 1, 0, 3};
    t.connectivity.twin = {3, kNoTwin, kNoTwin, 0, kNoTwin, kNoTwin};
    t.connectivity.edge = {0, 1, 2, 0, 3, 4};
    t.connectivity.edge_count = 5;
    t.connectivity.vertex_count = 4;
    const auto side = [](const WideReal& y) { return WideReal(log(WideReal(WideReal(0.25) + y * y)) / 2); };
    t.log_chord = {WideReal(0), side(h), side(h), WideReal(0), side(depth), side(depth)};
    return t;
}

TEST(WideKernels, TellDelaunayNeedlesApart) {
    // The circle through the edge and (1/2, h) meets x = 1/2 again at depth 1/(4h). Angles are 1e-12 and pi -
    // 1e-12: their cosines are -1 and 1 in long double.
    const WideReal h = WideReal(1) / 1000000000000LL, circle = 1 / (4 * h);
    const WideReal slightly = WideReal(1) / 10000;
    EXPECT_EQ(count_non_delaunay<WideReal>(flat_kite(h, circle * (1 - slightly)), {}), 1);
    EXPECT_EQ(count_non_delaunay<WideReal>(flat_kite(h, circle * (1 + slightly)), {}), 0);
    EXPECT_EQ(count_non_delaunay<WideReal>(flat_kite(h, circle), {}), 0) << "a tie";
    // And the other way up, where the flat face comes second.
    auto turned = flat_kite(circle * (1 - slightly), h);
    EXPECT_EQ(count_non_delaunay<WideReal>(turned, {}), 1);
    DelaunayWorkspace workspace;
    const FlipCount count = make_delaunay<WideReal>(turned, {}, FlipRule::isometric, workspace);
    EXPECT_EQ(count.flips, 1);
    EXPECT_EQ(count_non_delaunay<WideReal>(turned, {}), 0);
    // The new edge joins the apices.
    const WideReal expected = log(WideReal(circle * (1 - slightly) + h));
    EXPECT_LT(static_cast<double>(abs(WideReal(turned.log_chord[1] - expected))), 1e-36);
}

TEST(WideKernels, PtolemyFlipsGoBackInAllDigits) {
    Random random(5);
    auto t = intrinsic_triangulation<WideReal>(testing::bumpy_torus(7, 6));
    DelaunayWorkspace workspace;
    make_delaunay<WideReal>(t, {}, FlipRule::isometric, workspace);
    const std::vector<WideReal> before = t.log_chord;
    const std::vector<double> u = random.uniforms(at(t.connectivity.vertex_count), -1.5, 1.5);
    EXPECT_GT(make_delaunay<WideReal>(t, u, FlipRule::ptolemy, workspace).flips, 5);
    EXPECT_EQ(count_non_delaunay<WideReal>(t, u), 0);
    EXPECT_TRUE(make_delaunay<WideReal>(t, {}, FlipRule::ptolemy, workspace).finished);
    std::vector<WideReal> after = t.log_chord, sorted = before;
    std::sort(after.begin(), after.end());
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t h = 0; h < after.size(); ++h)
        EXPECT_LT(static_cast<double>(abs(WideReal(after[h] - sorted[h]))), 1e-46);
}

}  // namespace
}  // namespace ricci
