#include "engine/topology/cut_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "engine/topology/canonical_basis.h"
#include "io/mesh/mesh_file.h"
#include "tests/engine/topology/topology_surfaces.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using testing::at;
using testing::basis_of;
using testing::test_surfaces;
using testing::TestSurface;

/// The surface cut open, as connectivity of its own: twins across cuts are gone, corners that are still
/// joined share a vertex.
Connectivity cut_open(const Connectivity& c, std::span<const std::uint8_t> cut) {
    std::vector<Index> twin = c.twin, corner(c.tail.size());
    for (std::size_t h = 0; h < twin.size(); ++h)
        if (cut[at(c.edge[h])] != 0) twin[h] = kNoTwin;
    std::iota(corner.begin(), corner.end(), Index{0});
    for (bool changed = true; changed;) {
        changed = false;
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            const Index t = twin[at(h)];
            if (t == kNoTwin) continue;
            Index& one = corner[at(h)];
            Index& other = corner[at(next_halfedge(t))];
            changed = changed || one != other;
            one = other = std::min(one, other);
        }
    }
    return connectivity_from_gluing(std::move(corner), std::move(twin), c.halfedge_count());
}

void expect_one_disk(const Connectivity& c, const CutGraph& graph) {
    const Connectivity open = cut_open(c, graph.cut);
    ASSERT_STREQ(check_connectivity(open), "");
    const Topology topology = topology_of(open);
    const bool sphere = graph.sides.empty();
    EXPECT_EQ(topology.components, 1);
    EXPECT_EQ(topology.boundaries, sphere ? 0 : 1);
    EXPECT_EQ(topology.euler_characteristic, sphere ? 2 : 1);
    EXPECT_EQ(euler_characteristic_after(c, graph.cut), topology.euler_characteristic);
}

void expect_sides_fit(const Connectivity& c, const CutGraph& graph) {
    std::vector<Index> met(c.tail.size(), 0);
    std::set<std::string> names;
    for (std::size_t i = 0; i < graph.sides.size(); ++i) {
        const CutSide& side = graph.sides[i];
        const CutSide& following = graph.sides[(i + 1) % graph.sides.size()];
        EXPECT_EQ(c.head(side.halfedges.back()), c.tail[at(following.halfedges.front())]);
        for (std::size_t k = 0; k < side.halfedges.size(); ++k) {
            ++met[at(side.halfedges[k])];
            if (k > 0) {
                EXPECT_EQ(c.head(side.halfedges[k - 1]), c.tail[at(side.halfedges[k])]);
            }
        }
        if (side.boundary >= 0) {
            EXPECT_EQ(side.partner, -1);
            continue;
        }
        EXPECT_TRUE(names.insert(side.name).second) << side.name << " occurs twice";
        const CutSide& partner = graph.sides[at(side.partner)];
        EXPECT_EQ(partner.partner, static_cast<Index>(i));
        EXPECT_TRUE(partner.name == side.name + "^-1" || side.name == partner.name + "^-1");
        EXPECT_EQ(partner.halfedges, reversed_path(c, side.halfedges));
    }
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const bool rim = c.twin[at(h)] == kNoTwin || graph.cut[at(c.edge[at(h)])] != 0;
        EXPECT_EQ(met[at(h)], rim ? 1 : 0) << "halfedge " << h;
    }
}

/// Number of cut edge-ends. // V
std::vector<Index> degrees(const Connectivity& c, const CutGraph& graph) {
    std::vector<Index> degree(at(c.vertex_count), 0);
    for (Index h = 0; h < c.halfedge_count(); ++h) degree[at(c.tail[at(h)])] += graph.cut[at(c.edge[at(h)])];
    return degree;
}

TEST(CutGraph, LeavesOneDisk) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const HomotopyBasis basis = basis_of(surface);
        const CutGraph graph = make_cut_graph(surface.connectivity, basis);
        expect_one_disk(surface.connectivity, graph);
        expect_sides_fit(surface.connectivity, graph);
        EXPECT_EQ(graph.sides.empty(), basis.loops() + basis.boundaries() == 0 && surface.cones.size() < 2);
    }
}

TEST(CutGraph, HasNoLooseEndsAndMeetsEveryCone) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const Connectivity& c = surface.connectivity;
        const CutGraph graph = make_cut_graph(c, basis_of(surface));
        const std::vector<Index> degree = degrees(c, graph);
        const std::vector<std::uint8_t> boundary = boundary_vertices(c);
        const auto is_cone = [&](Index v) { return std::ranges::count(surface.cones, v) > 0; };
        for (Index v = 0; v < c.vertex_count; ++v) {
            if (degree[at(v)] == 1) {
                EXPECT_TRUE(boundary[at(v)] != 0 || is_cone(v)) << "vertex " << v;
            }
            if (is_cone(v) && !graph.sides.empty()) {
                EXPECT_GE(degree[at(v)], 1) << "cone " << v;
            }
        }
    }
}

TEST(CutGraph, NothingIsCutOnDisksAndSpheres) {
    for (const char* name : {"disk", "sphere"}) {
        const SurfaceMesh mesh = testing::named_surface(name);
        const Connectivity& c = mesh.connectivity;
        const HomotopyBasis basis = make_homotopy_basis(c, mesh.edge_length);
        const CutGraph graph = make_cut_graph(c, basis);
        EXPECT_EQ(std::ranges::count(graph.cut, 1), 0);
        ASSERT_EQ(graph.sides.size(), at(basis.boundaries()));
        if (graph.sides.empty()) continue;
        EXPECT_EQ(graph.sides[0].name, "c1");
        EXPECT_EQ(graph.sides[0].halfedges.size(), basis.boundary_walk(0).size());
    }
}

TEST(CutGraph, ConesOnASphereAreJoinedByATree) {
    GenerateOptions options;
    options.faces = 320;
    const SurfaceMesh mesh = generate("sphere", options);
    const Connectivity& c = mesh.connectivity;
    const HomotopyBasis basis =
        make_homotopy_basis(c, mesh.edge_length, {.base = -1, .cones = {3, 50, 77, 120}});
    const CutGraph graph = make_cut_graph(c, basis);
    const std::vector<Index> degree = degrees(c, graph);
    // A tree: one vertex more than edges.
    EXPECT_EQ(std::ranges::count_if(degree, [](Index d) { return d > 0; }),
              std::ranges::count(graph.cut, 1) + 1);
    expect_one_disk(c, graph);
}

TEST(CutGraph, OneTorusHasTheSidesOfASquareOrHexagon) {
    const SurfaceMesh mesh = testing::bumpy_torus(12, 9);
    const CutGraph graph =
        make_cut_graph(mesh.connectivity, make_homotopy_basis(mesh.connectivity, mesh.edge_length));
    // One node of degree four, or two of degree three, and the base where it lies on a side: then two more.
    EXPECT_TRUE(graph.sides.size() == 4 || graph.sides.size() == 6 || graph.sides.size() == 8);
    EXPECT_EQ(graph.sides[0].name, "s1");
}

void expect_topology_of_file(const std::string& path, Index genus, Index boundaries) {
    const LoadedMesh loaded = load_mesh(path);
    ASSERT_EQ(loaded.components.size(), 1u);
    const SurfaceMesh& mesh = loaded.components[0];
    const HomotopyBasis basis = make_homotopy_basis(mesh.connectivity, mesh.edge_length);
    EXPECT_EQ(basis.genus(), genus);
    EXPECT_EQ(basis.boundaries(), boundaries);
    const CanonicalBasis canonical = make_canonical_basis(basis.relator(), basis.loops(), basis.punctures());
    EXPECT_TRUE(are_conjugate(canonical.product(), basis.relator()));
    const CutGraph graph = make_cut_graph(mesh.connectivity, basis);
    EXPECT_EQ(euler_characteristic_after(mesh.connectivity, graph.cut), 1);
    expect_sides_fit(mesh.connectivity, graph);
}

TEST(CutGraph, CheeseOfGenus133) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g5plus/cheese_g133.off");
    expect_topology_of_file(path, 133, 0);
}

TEST(CutGraph, ElephantWith106Holes) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/handles_with_boundary/elephant-with-holes_g3b106.off");
    expect_topology_of_file(path, 3, 106);
}

TEST(CutGraph, PizzaOfGenus73) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/handles_with_boundary/pizza_g73b1.obj");
    expect_topology_of_file(path, 73, 1);
}

}  // namespace
}  // namespace ricci
