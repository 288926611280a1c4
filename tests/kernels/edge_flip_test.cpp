// Flips: connectivity, Ptolemy's rule and unfolding, with every way in which the quadrilateral may be glued
// to itself.
#include "kernels/edge_flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "kernels/delaunay.h"
#include "kernels/face_kernels.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;
using Real = long double;
using Triangulation = IntrinsicTriangulation<Real>;

void flip(Triangulation& t, Index h, FlipRule rule) {
    const Real length = rule == FlipRule::ptolemy ? ptolemy_log<Real>(t.log_chord, t.connectivity, h)
                                                  : unfolded_log<Real>(t.log_chord, t.connectivity, h);
    flip_edge<Real>(t.connectivity, t.log_chord, h, length);
}

/// A face up to rotation: per side the vertex it starts from, its edge and that edge's length.
using Side = std::tuple<Index, Index>;
std::vector<std::array<Side, 3>> canonical_faces(const Connectivity& c) {
    std::vector<std::array<Side, 3>> faces;
    for (std::size_t f = 0; f < at(c.face_count()); ++f) {
        std::array<Side, 3> face;
        for (std::size_t k = 0; k < 3; ++k) face[k] = {c.tail[3 * f + k], c.edge[3 * f + k]};
        std::array<Side, 3> least = face;
        for (int turn = 0; turn < 2; ++turn) {
            std::rotate(face.begin(), face.begin() + 1, face.end());
            least = std::min(least, face);
        }
        faces.push_back(least);
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

std::vector<Real> lengths_by_edge(const Triangulation& t) {
    std::vector<Real> lengths(at(t.connectivity.edge_count), -1);
    for (std::size_t h = 0; h < t.log_chord.size(); ++h) {
        Real& l = lengths[at(t.connectivity.edge[h])];
        EXPECT_TRUE(l < 0 || l == std::exp(t.log_chord[h])) << "twins differ in length";
        l = std::exp(t.log_chord[h]);
    }
    return lengths;
}

std::vector<Triangulation> sample_surfaces() {
    return {intrinsic_triangulation<Real>(testing::octahedron()),
            intrinsic_triangulation<Real>(testing::icosahedron(0.1)),
            intrinsic_triangulation<Real>(testing::bumpy_torus(4, 5)),
            intrinsic_triangulation<Real>(testing::wavy_square(3)),
            testing::one_vertex_torus<Real>(1.0L, 1.1L, 1.3L),
            testing::folded_square<Real>(1.0L)};
}

/// Total angle per vertex and area, in the plane.
struct Flatness {
    std::vector<Real> angle_sum;
    Real area = 0;
};
Flatness flatness(const Triangulation& t) {
    const std::vector<double> u(at(t.connectivity.vertex_count), 0.0);
    std::vector<Real> angle(t.log_chord.size()), area(angle.size() / 3);
    EXPECT_EQ(evaluate_faces<Real>(Geometry::euclidean, {t.connectivity.tail, t.log_chord, u},
                                   {angle, {}, {}, area}, false),
              0);
    Flatness result;
    result.angle_sum.resize(u.size());
    sum_corners<Real>(t.connectivity.tail, angle, result.angle_sum);
    for (const Real a : area) result.area += a;
    return result;
}

void expect_isometric(const Flatness& before, const Triangulation& t, double tolerance) {
    const Flatness after = flatness(t);
    EXPECT_NEAR(static_cast<double>(after.area / before.area), 1.0, tolerance);
    for (std::size_t v = 0; v < before.angle_sum.size(); ++v)
        EXPECT_NEAR(static_cast<double>(after.angle_sum[v] - before.angle_sum[v]), 0.0, tolerance)
            << "vertex " << v;
}

/// Whether the quadrilateral around h, unfolded, is convex and its new triangles have angles above `least`.
bool flips_well(const Triangulation& t, Index h, Real least) {
    const Connectivity& c = t.connectivity;
    if (!flippable(c, h)) return false;
    const std::vector<double> u(at(c.vertex_count), 0.0);
    const auto angle_at = [&](Index corner) {
        const Real a = std::exp(t.log_chord[at(next_halfedge(corner))]),
                   b = std::exp(t.log_chord[at(corner)]),
                   d = std::exp(t.log_chord[at(prev_halfedge(corner))]);
        return std::acos(std::clamp<Real>((b * b + d * d - a * a) / (2 * b * d), -1, 1));
    };
    const Index w = c.twin[at(h)];
    const Real at_tail = angle_at(h) + angle_at(next_halfedge(w)),
               at_head = angle_at(next_halfedge(h)) + angle_at(w);
    if (at_tail > std::numbers::pi_v<Real> - 2 * least || at_head > std::numbers::pi_v<Real> - 2 * least)
        return false;
    Triangulation trial = t;
    flip(trial, h, FlipRule::isometric);
    std::vector<Real> angle(trial.log_chord.size());
    if (evaluate_faces<Real>(Geometry::euclidean, {trial.connectivity.tail, trial.log_chord, u},
                             {angle, {}, {}, {}}, false) != 0)
        return false;
    return *std::min_element(angle.begin(), angle.end()) > least;
}

TEST(EdgeFlip, FollowsTheDiagram) {
    // i = 0, j = 1, k = 2, l = 3; h is halfedge 0.
    Connectivity c = build_connectivity(std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}}, 4);
    ASSERT_EQ(c.twin[0], 3);
    std::vector<double> logs = {0, 1, 2, 0, 4, 5};  // ij, jk, ki, ji, il, lj
    const Index edge_ij = c.edge[0], edge_jk = c.edge[1], edge_ki = c.edge[2], edge_il = c.edge[4],
                edge_lj = c.edge[5];
    flip_edge<double>(c, logs, 0, 9.0);
    EXPECT_EQ(c.tail, (std::vector<Index>{0, 3, 2, 1, 2, 3}));  // f = i l k, g = j k l
    EXPECT_EQ(c.edge, (std::vector<Index>{edge_il, edge_ij, edge_ki, edge_jk, edge_ij, edge_lj}));
    EXPECT_EQ(logs, (std::vector<double>{4, 9, 2, 1, 9, 5}));
    EXPECT_EQ(c.twin, (std::vector<Index>{kNoTwin, 4, kNoTwin, kNoTwin, 1, kNoTwin}));
    EXPECT_STREQ(check_connectivity(c), "");
    EXPECT_FALSE(flippable(c, 0));
    EXPECT_TRUE(flippable(c, 1));
}

TEST(EdgeFlip, TwiceIsTheIdentityUpToRotationOfFaces) {
    for (const Triangulation& start : sample_surfaces())
        for (Index h = 0; h < start.connectivity.halfedge_count(); ++h) {
            if (!flippable(start.connectivity, h)) continue;
            Triangulation t = start;
            flip(t, h, FlipRule::ptolemy);
            EXPECT_STREQ(check_connectivity(t.connectivity), "");
            // The new edge starts at next(h).
            flip(t, next_halfedge(h), FlipRule::ptolemy);
            EXPECT_STREQ(check_connectivity(t.connectivity), "");
            EXPECT_EQ(canonical_faces(t.connectivity), canonical_faces(start.connectivity));
            const auto before = lengths_by_edge(start), after = lengths_by_edge(t);
            // Two logarithms of sums: a few roundings of long double.
            for (std::size_t e = 0; e < before.size(); ++e)
                EXPECT_NEAR(static_cast<double>(after[e] / before[e]), 1.0, 1e-17) << "edge " << e;
        }
}

TEST(EdgeFlip, UnfoldsTheOneVertexTorus) {
    // A rectangle 3 x 4 with the other diagonal: flips to itself; a parallelogram's diagonals obey
    // e^2 + f^2 = 2 (a^2 + b^2).
    Triangulation t = testing::one_vertex_torus<Real>(3.0L, 4.0L, 4.5L);
    flip(t, 2, FlipRule::isometric);
    EXPECT_STREQ(check_connectivity(t.connectivity), "");
    EXPECT_EQ(topology_of(t.connectivity).genus, 1);
    const auto lengths = lengths_by_edge(t);
    EXPECT_NEAR(static_cast<double>(lengths[2]), std::sqrt(2.0 * 25 - 4.5 * 4.5), 1e-15);
    EXPECT_NEAR(static_cast<double>(flatness(t).angle_sum[0]), 2 * std::numbers::pi, 1e-15);
}

TEST(EdgeFlip, UnfoldsASquareFoldedToAPillow) {
    Triangulation t = testing::folded_square<Real>(1.0L);
    ASSERT_STREQ(check_connectivity(t.connectivity), "");
    ASSERT_EQ(topology_of(t.connectivity).euler_characteristic, 2);
    const Flatness before = flatness(t);
    EXPECT_NEAR(static_cast<double>(before.angle_sum[0]), std::numbers::pi, 1e-15);
    for (const Index h : {Index{2}, Index{3}}) {
        Triangulation flipped = t;
        flip(flipped, h, FlipRule::isometric);
        EXPECT_STREQ(check_connectivity(flipped.connectivity), "");
        EXPECT_EQ(topology_of(flipped.connectivity).euler_characteristic, 2);
        EXPECT_NEAR(static_cast<double>(lengths_by_edge(flipped)[at(t.connectivity.edge[2])]), 2.0, 1e-15);
        expect_isometric(before, flipped, 1e-15);
    }
    // Edges 0-1 and 0-2 have the same face on both sides.
    EXPECT_FALSE(flippable(t.connectivity, 0));
    EXPECT_FALSE(flippable(t.connectivity, 4));
}

TEST(EdgeFlip, IsometricFlipsKeepAreaAndCurvature) {
    for (const Triangulation& start : sample_surfaces()) {
        const Flatness before = flatness(start);
        int flips = 0;
        for (Index h = 0; h < start.connectivity.halfedge_count(); ++h) {
            if (!flips_well(start, h, 0.05L)) continue;
            Triangulation t = start;
            flip(t, h, FlipRule::isometric);
            ++flips;
            // Long double with angles above 0.05: 1e-19 times a few hundred.
            expect_isometric(before, t, 1e-14);
        }
        EXPECT_GT(flips, 0);
    }
}

/// Distances between four points in cyclic order, as the log chords of the two faces (0,1,2), (1,0,3) on the
/// circle order 0, 3, 1, 2: i = 0, j = 1, k = 2, l = 3.
template <class Chord>
void expect_ptolemy(Chord&& chord, const char* what) {
    Connectivity c = build_connectivity(std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}}, 4);
    std::vector<Real> logs(6);
    for (Index h = 0; h < 6; ++h) logs[at(h)] = std::log(static_cast<Real>(chord(c.tail[at(h)], c.head(h))));
    const Real made = std::exp(ptolemy_log<Real>(logs, c, 0));
    EXPECT_NEAR(static_cast<double>(made / chord(2, 3)), 1.0, 1e-16) << what;
}

TEST(EdgeFlip, PtolemyHoldsOnCirclesOfEveryGeometry) {
    Random random(5);
    for (int trial = 0; trial < 50; ++trial) {
        std::array<Real, 4> angle{};
        angle[0] = random.uniform(0, 1);
        angle[3] = angle[0] + random.uniform(0.3, 1.5);
        angle[1] = angle[3] + random.uniform(0.3, 1.5);
        angle[2] = angle[1] + random.uniform(0.3, 1.5);
        const Real r = random.uniform(0.2, 1.3);
        const auto turn = [&](Index i, Index j) { return angle[at(i)] - angle[at(j)]; };
        expect_ptolemy(
            [&](Index i, Index j) {
                return std::hypot(r * std::cos(angle[at(i)]) - r * std::cos(angle[at(j)]),
                                  r * std::sin(angle[at(i)]) - r * std::sin(angle[at(j)]));
            },
            "plane");
        // Distances from the cosine law at the circle's centre, then chords.
        expect_ptolemy(
            [&](Index i, Index j) {
                const Real l =
                    std::acos(std::cos(r) * std::cos(r) + std::sin(r) * std::sin(r) * std::cos(turn(i, j)));
                return 2 * std::sin(l / 2);
            },
            "sphere");
        expect_ptolemy(
            [&](Index i, Index j) {
                const Real l = std::acosh(std::cosh(r) * std::cosh(r) -
                                          std::sinh(r) * std::sinh(r) * std::cos(turn(i, j)));
                return 2 * std::sinh(l / 2);
            },
            "hyperbolic plane");
        // A horocycle: chords are distances along it.
        const std::array<Real, 4> x = {0, r + 1, 2 * r + 2, r / 2};
        expect_ptolemy([&](Index i, Index j) { return std::abs(x[at(i)] - x[at(j)]); }, "horocycle");
    }
}

TEST(EdgeFlip, TenThousandRandomFlipsKeepTheConnectivity) {
    Random random(6);
    for (const Triangulation& start : sample_surfaces()) {
        Triangulation t = start;
        const Topology before = topology_of(t.connectivity);
        int loops = 0;
        for (int k = 0; k < 10000; ++k) {
            const auto h = random.below(t.connectivity.halfedge_count());
            if (!flippable(t.connectivity, h)) continue;
            // Any length will do: this is about the gluing. (Ptolemy lengths would overflow after so many.)
            flip_edge<Real>(t.connectivity, t.log_chord, h, random.uniform(-1, 1));
            loops +=
                t.connectivity.tail[at(next_halfedge(h))] == t.connectivity.head(next_halfedge(h)) ? 1 : 0;
            if (k % 100 == 0) {
                ASSERT_STREQ(check_connectivity(t.connectivity), "");
            }
        }
        ASSERT_STREQ(check_connectivity(t.connectivity), "");
        const Topology after = topology_of(t.connectivity);
        EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
        EXPECT_EQ(after.vertices, before.vertices);
        EXPECT_EQ(after.edges, before.edges);
        EXPECT_EQ(after.boundaries, before.boundaries);
        EXPECT_EQ(after.genus, before.genus);
        EXPECT_GT(loops, 0);
        lengths_by_edge(t);  // twins equal
    }
}

TEST(EdgeFlip, RandomIsometricFlipsKeepGaussBonnetAndEveryCurvature) {
    Random random(7);
    for (const Triangulation& start : sample_surfaces()) {
        Triangulation t = start;
        const Flatness before = flatness(t);
        int flips = 0;
        for (int k = 0; k < 10000; ++k) {
            const auto h = random.below(t.connectivity.halfedge_count());
            if (!flips_well(t, h, 0.1L)) continue;
            flip(t, h, FlipRule::isometric);
            ++flips;
        }
        EXPECT_GT(flips, 50);
        ASSERT_STREQ(check_connectivity(t.connectivity), "");
        // Each flip adds a few roundings of 5e-20, amplified by 1/sin(0.1)^2 = 100; thousands of them: 1e-13.
        expect_isometric(before, t, 1e-13);
    }
}

/// Random well-shaped isometric flips.
void scramble(Triangulation& t, int attempts, Random& random) {
    for (int k = 0; k < attempts; ++k) {
        const auto h = random.below(t.connectivity.halfedge_count());
        if (flips_well(t, h, 0.1L)) flip(t, h, FlipRule::isometric);
    }
}

TEST(MakeDelaunay, IsUniqueOnASurfaceWithoutTies) {
    Random random(8);
    DelaunayWorkspace workspace;
    for (const SurfaceMesh& mesh :
         {testing::bumpy_torus(6, 5), testing::icosahedron(0.2), testing::wavy_square(5, 0.3)}) {
        Triangulation reference = intrinsic_triangulation<Real>(mesh);
        const Flatness before = flatness(reference);
        EXPECT_TRUE(make_delaunay<Real>(reference, {}, FlipRule::isometric, workspace).finished);
        EXPECT_EQ(count_non_delaunay<Real>(reference, {}), 0);
        expect_isometric(before, reference, 1e-14);
        auto expected = lengths_by_edge(reference);
        std::sort(expected.begin(), expected.end());
        for (int trial = 0; trial < 5; ++trial) {
            Triangulation t = intrinsic_triangulation<Real>(mesh);
            scramble(t, 2000, random);
            EXPECT_GT(count_non_delaunay<Real>(t, {}), 0);
            const FlipCount count = make_delaunay<Real>(t, {}, FlipRule::isometric, workspace);
            EXPECT_TRUE(count.finished);
            EXPECT_EQ(workspace.touched_faces.size(), static_cast<std::size_t>(2 * count.flips));
            EXPECT_EQ(count_non_delaunay<Real>(t, {}), 0);
            auto lengths = lengths_by_edge(t);
            std::sort(lengths.begin(), lengths.end());
            for (std::size_t e = 0; e < lengths.size(); ++e)
                EXPECT_NEAR(static_cast<double>(lengths[e] - expected[e]), 0.0, 1e-13);
        }
    }
}

TEST(MakeDelaunay, PtolemyFlipsAtAnyConformalFactorEndInTrianglesAndAreUnique) {
    Random random(9);
    DelaunayWorkspace workspace;
    Triangulation start = intrinsic_triangulation<Real>(testing::bumpy_torus(7, 6));
    make_delaunay<Real>(start, {}, FlipRule::isometric, workspace);
    for (int trial = 0; trial < 10; ++trial) {
        const auto u = random.uniforms(42, -1.5, 1.5);
        Triangulation t = start;
        const FlipCount count = make_delaunay<Real>(t, u, FlipRule::ptolemy, workspace);
        EXPECT_TRUE(count.finished);
        EXPECT_GT(count.flips, 0);
        EXPECT_EQ(count_non_delaunay<Real>(t, u), 0);
        EXPECT_STREQ(check_connectivity(t.connectivity), "");
        // A Delaunay triangulation of chords satisfies the triangle inequality (Gu, Luo, Sun, Wu 2018).
        std::vector<Real> angle(t.log_chord.size()), total(42);
        EXPECT_EQ(evaluate_faces<Real>(Geometry::euclidean, {t.connectivity.tail, t.log_chord, u},
                                       {angle, {}, {}, {}}, false),
                  0);
        // By way of another conformal factor: the same triangulation of the same metric.
        Triangulation detour = start;
        make_delaunay<Real>(detour, random.uniforms(42, -1.5, 1.5), FlipRule::ptolemy, workspace);
        make_delaunay<Real>(detour, u, FlipRule::ptolemy, workspace);
        auto a = lengths_by_edge(t), b = lengths_by_edge(detour);
        std::sort(a.begin(), a.end());
        std::sort(b.begin(), b.end());
        for (std::size_t e = 0; e < a.size(); ++e) EXPECT_NEAR(static_cast<double>(b[e] / a[e]), 1.0, 1e-15);
        // In double: the same flips end there too.
        IntrinsicTriangulation<double> coarse = rounded(start);
        EXPECT_TRUE(make_delaunay<double>(coarse, u, FlipRule::ptolemy, workspace).finished);
        EXPECT_EQ(count_non_delaunay<double>(coarse, u), 0);
    }
}

TEST(MakeDelaunay, LeavesTiesAlone) {
    // Every square of a flat grid is cocircular to rounding; scaled so that rounding differs from edge to
    // edge.
    DelaunayWorkspace workspace;
    for (const double scale : {1.0, 0.1, 1.0 / 3.0, 1e10}) {
        std::vector<Point> points;
        for (int i = 0; i <= 8; ++i)
            for (int j = 0; j <= 8; ++j) points.push_back({i * scale + 1e3 * scale, j * scale * 0.7, 0.0});
        std::vector<Triangle> triangles;
        for (Index i = 0; i < 8; ++i)
            for (Index j = 0; j < 8; ++j) {
                const Index a = 9 * i + j;
                triangles.push_back({a, a + 9, a + 10});
                triangles.push_back({a, a + 10, a + 1});
            }
        const SurfaceMesh mesh = make_surface_mesh(points, triangles);
        auto t = intrinsic_triangulation<double>(mesh);
        EXPECT_EQ(make_delaunay<double>(t, {}, FlipRule::isometric, workspace).flips, 0) << scale;
        // Through u and back: still no flip, though the logarithms are rounded otherwise.
        const std::vector<double> u(points.size(), 0.3);
        EXPECT_EQ(make_delaunay<double>(t, u, FlipRule::ptolemy, workspace).flips, 0) << scale;
    }
}

TEST(MakeDelaunay, StopsAtBoundariesAndWithinFaces) {
    DelaunayWorkspace workspace;
    Triangulation t = intrinsic_triangulation<Real>(testing::wavy_square(6, 0.4));
    const auto boundary_edges = [&] {
        std::vector<Real> lengths;
        for (std::size_t h = 0; h < t.log_chord.size(); ++h)
            if (t.connectivity.twin[h] == kNoTwin) lengths.push_back(t.log_chord[h]);
        std::sort(lengths.begin(), lengths.end());
        return lengths;
    };
    const auto before = boundary_edges();
    EXPECT_GT(make_delaunay<Real>(t, {}, FlipRule::isometric, workspace).flips, 0);
    EXPECT_EQ(boundary_edges(), before);
    Triangulation folded = testing::folded_square<Real>(1.0L);
    EXPECT_TRUE(make_delaunay<Real>(folded, {}, FlipRule::isometric, workspace).finished);
    EXPECT_EQ(count_non_delaunay<Real>(folded, {}), 0);
}

TEST(MakeDelaunay, ReportsLengthsThatNeverSettle) {
    // NaN lengths: every comparison fails, so nothing flips and nothing hangs.
    Triangulation t = intrinsic_triangulation<Real>(testing::icosahedron());
    t.log_chord.assign(t.log_chord.size(), std::numeric_limits<Real>::quiet_NaN());
    DelaunayWorkspace workspace;
    const FlipCount count = make_delaunay<Real>(t, {}, FlipRule::isometric, workspace);
    EXPECT_EQ(count.flips, 0);
    EXPECT_TRUE(
        std::all_of(workspace.on_stack.begin(), workspace.on_stack.end(), [](auto x) { return x == 0; }));
}

}  // namespace
}  // namespace ricci
