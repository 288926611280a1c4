#include "kernels/connectivity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {
namespace {

const std::vector<Triangle> kTetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

/// n x m grid of squares glued to a torus, each square cut in two.
std::vector<Triangle> torus_triangles(Index n, Index m) {
    std::vector<Triangle> triangles;
    const auto vertex = [n, m](Index i, Index j) { return (i % n) * m + j % m; };
    for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j < m; ++j) {
            triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    }
    return triangles;
}

/// The torus from one square: one vertex, two faces, three loops.
Connectivity one_vertex_torus() {
    // face 0: sides a, b, c (diagonal); face 1: sides a', b', c' reversed.
    return connectivity_from_gluing({0, 0, 0, 0, 0, 0}, {3, 4, 5, 0, 1, 2}, 1);
}

void expect_topology(const Topology& t, Index vertices, Index edges, Index faces, Index components,
                     Index boundaries, Index genus) {
    EXPECT_EQ(t.vertices, vertices);
    EXPECT_EQ(t.edges, edges);
    EXPECT_EQ(t.faces, faces);
    EXPECT_EQ(t.components, components);
    EXPECT_EQ(t.boundaries, boundaries);
    EXPECT_EQ(t.genus, genus);
    EXPECT_EQ(t.euler_characteristic, vertices - edges + faces);
}

TEST(Connectivity, HalfedgeArithmeticIsCyclic) {
    for (Index h = 0; h < 9; ++h) {
        EXPECT_EQ(prev_halfedge(next_halfedge(h)), h);
        EXPECT_EQ(next_halfedge(next_halfedge(next_halfedge(h))), h);
        EXPECT_EQ(face_of(next_halfedge(h)), face_of(h));
        EXPECT_NE(next_halfedge(h), h);
    }
}

TEST(Connectivity, TetrahedronIsAClosedSphere) {
    const Connectivity c = build_connectivity(kTetrahedron, 4);
    EXPECT_STREQ(check_connectivity(c), "");
    expect_topology(topology_of(c), 4, 6, 4, 1, 0, 0);
    for (const Index t : c.twin) EXPECT_NE(t, kNoTwin);
    EXPECT_EQ(triangles_of(c), kTetrahedron);
}

TEST(Connectivity, GridTorusHasGenusOne) {
    const Connectivity c = build_connectivity(torus_triangles(5, 7), 35);
    EXPECT_STREQ(check_connectivity(c), "");
    expect_topology(topology_of(c), 35, 105, 70, 1, 0, 1);
}

TEST(Connectivity, TorusWithOneFaceLessHasOneBoundary) {
    std::vector<Triangle> triangles = torus_triangles(4, 4);
    triangles.pop_back();
    const Connectivity c = build_connectivity(triangles, 16);
    expect_topology(topology_of(c), 16, 48, 31, 1, 1, 1);
    Index on_boundary = 0;
    for (const std::uint8_t b : boundary_vertices(c)) on_boundary += b;
    EXPECT_EQ(on_boundary, 3);
}

TEST(Connectivity, OneVertexTorusHasLoops) {
    const Connectivity c = one_vertex_torus();
    EXPECT_STREQ(check_connectivity(c), "");
    expect_topology(topology_of(c), 1, 3, 2, 1, 0, 1);
}

TEST(Connectivity, BoundariesAreCountedAsLoopsOfHalfedges) {
    // A square ring: eight vertices, four quads, two boundaries.
    std::vector<Triangle> triangles;
    for (Index i = 0; i < 4; ++i) {
        const Index j = (i + 1) % 4;
        triangles.push_back({i, j, 4 + j});
        triangles.push_back({i, 4 + j, 4 + i});
    }
    expect_topology(topology_of(build_connectivity(triangles, 8)), 8, 16, 8, 1, 2, 0);
}

TEST(Connectivity, UnusedVerticesAreNotCounted) {
    const Connectivity c = build_connectivity(std::vector<Triangle>{{1, 3, 5}}, 7);
    expect_topology(topology_of(c), 3, 3, 1, 1, 1, 0);
    EXPECT_EQ(used_vertices(c), (std::vector<std::uint8_t>{0, 1, 0, 1, 0, 1, 0}));
    EXPECT_EQ(boundary_vertices(c), used_vertices(c));
}

TEST(Connectivity, ComponentsAreNumberedByLowestVertex) {
    // Face 0 lies in the component of vertex 1, face 1 in that of vertex 0.
    const std::vector<Triangle> triangles = {{4, 5, 1}, {0, 2, 3}, {4, 1, 6}};
    const Connectivity c = build_connectivity(triangles, 7);
    EXPECT_EQ(face_components(c), (std::vector<Index>{1, 0, 1}));
    const Topology t = topology_of(c);
    EXPECT_EQ(t.components, 2);
    EXPECT_EQ(t.genus, 0);
}

TEST(Connectivity, GenusIsSummedOverComponents) {
    std::vector<Triangle> triangles = torus_triangles(3, 3);
    for (const Triangle& t : torus_triangles(3, 3)) triangles.push_back({t[0] + 9, t[1] + 9, t[2] + 9});
    for (const Triangle& t : kTetrahedron) triangles.push_back({t[0] + 18, t[1] + 18, t[2] + 18});
    expect_topology(topology_of(build_connectivity(triangles, 22)), 22, 60, 40, 3, 0, 2);
}

TEST(Connectivity, EdgeHalfedgesAreTheLowerNumberedOnes) {
    const Connectivity c = build_connectivity(kTetrahedron, 4);
    const std::vector<Index> halfedges = edge_halfedges(c);
    ASSERT_EQ(halfedges.size(), 6U);
    for (Index e = 0; e < 6; ++e) {
        const Index h = halfedges[static_cast<std::size_t>(e)];
        EXPECT_EQ(c.edge[static_cast<std::size_t>(h)], e);
        EXPECT_LT(h, c.twin[static_cast<std::size_t>(h)]);
    }
}

TEST(Connectivity, RejectsWhatIsNotAnOrientedManifold) {
    const auto build = [](const std::vector<Triangle>& triangles) {
        return build_connectivity(triangles, 5);
    };
    EXPECT_THROW(build({{0, 1, 5}}), std::invalid_argument);
    EXPECT_THROW(build({{0, -1, 2}}), std::invalid_argument);
    EXPECT_THROW(build({{0, 1, 1}}), std::invalid_argument);
    EXPECT_THROW(build({{0, 1, 2}, {0, 1, 3}}), std::invalid_argument);             // same direction
    EXPECT_THROW(build({{0, 1, 2}, {1, 0, 3}, {1, 0, 4}}), std::invalid_argument);  // three faces
    EXPECT_THROW(build_connectivity(std::vector<Triangle>{}, -1), std::invalid_argument);
}

TEST(Connectivity, RejectsBadGluings) {
    using Indices = std::vector<Index>;
    EXPECT_THROW(connectivity_from_gluing({0, 1}, {-1, -1}, 2), std::invalid_argument);
    EXPECT_THROW(connectivity_from_gluing({0, 1, 2}, {-1, -1}, 3), std::invalid_argument);
    EXPECT_THROW(connectivity_from_gluing({0, 1, 3}, {-1, -1, -1}, 3), std::invalid_argument);
    EXPECT_THROW(connectivity_from_gluing({0, 1, 2}, {0, -1, -1}, 3), std::invalid_argument);  // own twin
    EXPECT_THROW(connectivity_from_gluing({0, 1, 2}, {9, -1, -1}, 3), std::invalid_argument);
    const Indices tail = {0, 1, 2, 1, 0, 3};
    EXPECT_NO_THROW(connectivity_from_gluing(tail, {3, -1, -1, 0, -1, -1}, 4));
    EXPECT_THROW(connectivity_from_gluing(tail, {3, -1, -1, 1, -1, -1}, 4), std::invalid_argument);
    EXPECT_THROW(connectivity_from_gluing(tail, {4, -1, -1, -1, 0, -1}, 4), std::invalid_argument);
}

TEST(Connectivity, CheckNoticesEachBrokenInvariant) {
    const Connectivity good = build_connectivity(kTetrahedron, 4);
    Connectivity bad = good;
    bad.tail[0] = 9;
    EXPECT_STRNE(check_connectivity(bad), "");
    bad = good;
    bad.twin[0] = kNoTwin;
    EXPECT_STRNE(check_connectivity(bad), "");
    bad = good;
    bad.edge[0] = bad.edge[1];
    EXPECT_STRNE(check_connectivity(bad), "");
    bad = good;
    bad.edge_count += 1;
    EXPECT_STRNE(check_connectivity(bad), "");
    // Two triangles that touch at a vertex only: a pinch.
    const Connectivity pinch = build_connectivity(std::vector<Triangle>{{0, 1, 2}, {0, 3, 4}}, 5);
    EXPECT_STREQ(check_connectivity(pinch), "a vertex has more than one fan of faces");
}

TEST(SurfaceMesh, MeasuresEdgesAndAreas) {
    const SurfaceMesh mesh = make_surface_mesh({{0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {0, 4, 0}},
                                               std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
    EXPECT_EQ(mesh.edge_length, (std::vector<double>{3, 4, 5, 5, 3, 4}));
    EXPECT_EQ(mesh.input_vertex, (std::vector<Index>{0, 1, 2, 3}));
    EXPECT_FALSE(mesh.intrinsic());
    const std::vector<double> areas = face_areas(mesh);  // 3-4-5: every operation is exact
    EXPECT_EQ(areas, (std::vector<double>{6, 6}));
}

TEST(SurfaceMesh, LengthsSurviveExtremeScales) {
    for (const double scale : {1e-200, 1e200}) {
        const SurfaceMesh mesh = make_surface_mesh({{0, 0, 0}, {3 * scale, 4 * scale, 0}, {0, scale, 0}},
                                                   std::vector<Triangle>{{0, 1, 2}});
        EXPECT_NEAR(mesh.edge_length[0] / (5 * scale), 1.0, 1e-15);
    }
}

TEST(SurfaceMesh, NeedleAreaKeepsItsDigits) {
    // Sides exact in double, and so are the four factors of Kahan's product; s(s-a)(s-b)(s-c) with a rounded
    // s would lose half of the digits here.
    SurfaceMesh mesh;
    mesh.connectivity = connectivity_from_gluing({0, 1, 2}, {-1, -1, -1}, 3);
    const double c = std::ldexp(1.0, -20);
    const double d = std::ldexp(1.0, -40);
    mesh.edge_length = {1.0, 1.0 - c + d, c};
    const double expected = 0.25 * std::sqrt((2 + d) * d * (2 * c - d) * (2 - 2 * c + d));
    EXPECT_NEAR(face_areas(mesh)[0] / expected, 1.0, 1e-15);
}

}  // namespace
}  // namespace ricci
