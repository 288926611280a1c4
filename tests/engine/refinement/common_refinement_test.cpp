// What must hold of every common refinement.
#include "engine/refinement/common_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/refinement/null_sides.h"
#include "engine/surfaces/generate.h"
#include "engine/surfaces/regular_map.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using namespace ricci::testing;

SurfaceMesh generated(const std::string& name, Index faces, double jitter = 0.3) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    return generate(name, options);
}

std::vector<double> random_factor(const SurfaceMesh& mesh, double amplitude, std::uint64_t seed) {
    return Random(seed).uniforms(at(mesh.connectivity.vertex_count), -amplitude, amplitude);
}

void expect_sound_connectivity(const SurfaceMesh& mesh, const CommonRefinement& r) {
    Index boundary = 0;
    for (Index c = 0; c < r.corner_count(); ++c) {
        const Index t = r.twin[at(c)], h = r.input_halfedge[at(c)], g = r.final_halfedge[at(c)];
        if (h >= 0) {
            EXPECT_EQ(face_of(h), r.input_face[at(r.piece[at(c)])]);
        }
        if (g >= 0) {
            EXPECT_EQ(face_of(g), r.final_face[at(r.piece[at(c)])]);
        }
        if (t < 0) {
            ++boundary;
            ASSERT_GE(h, 0);
            EXPECT_EQ(mesh.connectivity.twin[at(h)], kNoTwin);
            continue;
        }
        EXPECT_EQ(r.twin[at(t)], c);
        EXPECT_EQ(r.vertex[at(t)], r.vertex[at(r.next(c))]);
        if (g >= 0) {
            EXPECT_EQ(r.final_triangulation.connectivity.twin[at(g)], r.final_halfedge[at(t)]);
        } else {
            EXPECT_EQ(r.final_face[at(r.piece[at(c)])], r.final_face[at(r.piece[at(t)])]);
        }
        if (h < 0) {
            EXPECT_EQ(r.input_face[at(r.piece[at(c)])], r.input_face[at(r.piece[at(t)])]);
        }
    }
    const std::set<Index> vertices(r.vertex.begin(), r.vertex.end());
    const Index edges = (r.corner_count() + boundary) / 2;
    EXPECT_EQ(static_cast<Index>(vertices.size()) - edges + r.piece_count(),
              topology_of(mesh.connectivity).euler_characteristic);
}

void expect_areas(const SurfaceMesh& mesh, const CommonRefinement& r) {
    const PieceAreas areas = piece_areas(r);
    const std::vector<double> face = face_areas(mesh);
    std::vector<double> flat(face.size(), 0.0), share(r.final_triangulation.log_chord.size() / 3, 0.0);
    for (Index p = 0; p < r.piece_count(); ++p) {
        EXPECT_GE(areas.flat[at(p)], -areas.flat_rounding[at(p)]);
        EXPECT_GE(areas.final_share[at(p)], -areas.share_rounding[at(p)]);
        flat[at(r.input_face[at(p)])] += areas.flat[at(p)];
        share[at(r.final_face[at(p)])] += areas.final_share[at(p)];
    }
    // Pieces of a face tile it: corners are rounded once each.
    for (std::size_t f = 0; f < face.size(); ++f) EXPECT_NEAR(flat[f], face[f], 1e-11 * face[f]);
    if (r.doubled) return;  // half of the final faces' pieces are the mirror image's
    for (const double s : share) EXPECT_NEAR(s, 1.0, 1e-11);
}

/// Sides are as long in space as in the flat metric; those along an input halfedge add up to it.
void expect_lengths(const SurfaceMesh& mesh, const CommonRefinement& r) {
    std::vector<double> along(mesh.connectivity.tail.size(), 0.0);
    for (Index c = 0; c < r.corner_count(); ++c) {
        const auto &p = r.flat[at(c)], &q = r.flat[at(r.next(c))];
        const double length = std::hypot(q[0] - p[0], q[1] - p[1]);
        if (r.input_halfedge[at(c)] >= 0) along[at(r.input_halfedge[at(c)])] += length;
        if (mesh.intrinsic()) continue;
        const Point &x = r.points[at(r.vertex[at(c)])], &y = r.points[at(r.vertex[at(r.next(c))])];
        const double in_space = std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                                          (x[2] - y[2]) * (x[2] - y[2]));
        EXPECT_NEAR(in_space, length, 1e-12);
    }
    for (std::size_t h = 0; h < along.size(); ++h) EXPECT_NEAR(along[h], mesh.edge_length[h], 1e-12);
}

/// Both pieces at a side say the same of its ends.
void expect_continuous_map(const CommonRefinement& r) {
    const auto normal = [](std::array<double, 3> w) {
        const double sum = w[0] + w[1] + w[2];
        for (double& x : w) x /= sum;
        return w;
    };
    for (Index c = 0; c < r.corner_count(); ++c) {
        const Index t = r.twin[at(c)], g = r.final_halfedge[at(c)];
        if (t < c) continue;
        for (const auto& [a, b] : {std::pair(c, r.next(t)), std::pair(r.next(c), t)}) {
            const auto x = normal(r.weight[at(a)]), y = normal(r.weight[at(b)]);
            if (g < 0) {
                for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(x[k], y[k], 1e-11);
                continue;
            }
            const Index s = r.final_halfedge[at(t)];
            EXPECT_NEAR(x[at(g % 3)], y[at(next_halfedge(s) % 3)], 1e-11);
            EXPECT_NEAR(x[at(next_halfedge(g) % 3)], y[at(s % 3)], 1e-11);
            EXPECT_NEAR(x[at(prev_halfedge(g) % 3)], 0.0, 1e-11);
        }
    }
}

void expect_sound(const SurfaceMesh& mesh, const CommonRefinement& r) {
    expect_sound_connectivity(mesh, r);
    expect_areas(mesh, r);
    expect_lengths(mesh, r);
    expect_continuous_map(r);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) EXPECT_EQ(r.points[v], mesh.points[v]);
}

TEST(CommonRefinement, HoldsOnClosedSurfaces) {
    std::uint64_t seed = 1;
    for (const SurfaceMesh& mesh : {icosahedron(0.2), bumpy_torus(9, 7, 0.2), generated("eight", 1200),
                                    generated("genus-g", 1500), make_bolza(), make_klein_quartic()})
        for (const double amplitude : {0.0, 0.3, 1.5})
            for (const bool delaunay : {true, false}) {
                SCOPED_TRACE(::testing::Message()
                             << mesh.connectivity.face_count() << " faces, " << amplitude);
                const auto r =
                    make_common_refinement(mesh, random_factor(mesh, amplitude, seed++), false, delaunay);
                if (amplitude > 1) {
                    EXPECT_GT(r.ptolemy_flips, 0);
                }
                expect_sound(mesh, r);
            }
}

TEST(CommonRefinement, HoldsOnSurfacesWithBoundary) {
    std::uint64_t seed = 100;
    for (const SurfaceMesh& mesh : {wavy_square(8, 0.2), generated("pants", 900), generated("annulus", 600),
                                    generated("genus-g-one-boundary", 1200)})
        for (const bool doubled : {true, false}) {
            SCOPED_TRACE(::testing::Message()
                         << mesh.connectivity.face_count() << " faces, doubled " << doubled);
            const auto r = make_common_refinement(mesh, random_factor(mesh, 1.0, seed++), doubled, true);
            EXPECT_EQ(r.doubled, doubled);
            expect_sound(mesh, r);
        }
}

TEST(CommonRefinement, WithoutFlipsThePiecesAreTheFaces) {
    const SurfaceMesh mesh = icosahedron();
    const auto r = make_common_refinement(mesh, random_factor(mesh, 0.0, 1), false, true);
    EXPECT_EQ(r.piece_count(), mesh.connectivity.face_count());
    EXPECT_EQ(r.vertex_count, mesh.connectivity.vertex_count);
}

TEST(CommonRefinement, CrossingsThatFallTogetherLeaveNoPiecesWithoutArea) {
    // A grid of squares, both diagonals alike: with u symmetric about them, edges of all three triangulations
    // meet in the middles of the squares.
    const Index n = 6;
    std::vector<Point> points;
    for (Index i = 0; i <= n; ++i)
        for (Index j = 0; j <= n; ++j) points.push_back({double(i), double(j), 0.0});
    std::vector<Triangle> triangles;
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) {
            const Index a = i * (n + 1) + j, b = a + n + 1;
            triangles.push_back({a, b, b + 1});
            triangles.push_back({a, b + 1, a + 1});
        }
    const SurfaceMesh mesh = make_surface_mesh(std::move(points), triangles);
    std::vector<double> u;
    for (Index i = 0; i <= n; ++i)
        for (Index j = 0; j <= n; ++j) u.push_back((i + j) % 2 == 0 ? 0.4 : -0.4);
    auto r = make_common_refinement(mesh, u, true, true);
    expect_sound_connectivity(mesh, r);
    const PieceAreas areas = piece_areas(r);
    for (const double area : areas.flat) EXPECT_GT(area, 1e-6);
    EXPECT_EQ(collapse_null_sides(r), 0);
}

}  // namespace
}  // namespace ricci
