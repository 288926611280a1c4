#include "engine/topology/shortest_paths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/engine/topology/topology_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;
using testing::test_surfaces;
using testing::TestSurface;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Distances by relaxing every edge until nothing changes. // V
std::vector<double> relaxed_distances(const TestSurface& surface, Index root) {
    const Connectivity& c = surface.connectivity;
    std::vector<double> d(at(c.vertex_count), kInfinity);
    d[at(root)] = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            double& tail = d[at(c.tail[at(h)])];
            double& head = d[at(c.head(h))];
            const double length = surface.length[at(h)];
            changed = changed || head > tail + length || tail > head + length;
            head = std::min(head, tail + length);
            tail = std::min(tail, head + length);
        }
    }
    return d;
}

TEST(ShortestPaths, AgreeWithRelaxation) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const Connectivity& c = surface.connectivity;
        const Index root = c.tail[0];
        const ShortestPaths paths = shortest_paths(c, vertex_stars(c), surface.length, root);
        // Both take minima of the same rounded sums along paths.
        EXPECT_EQ(paths.distance, relaxed_distances(surface, root));
        for (Index v = 0; v < c.vertex_count; ++v) {
            if (std::isinf(paths.distance[at(v)])) continue;
            Index here = root;
            double walked = 0;
            for (const Step s : paths.path_to(c, v)) {
                ASSERT_EQ(step_tail(c, s), here);
                here = step_head(c, s);
                walked += surface.length[at(halfedge_of(s))];
            }
            EXPECT_EQ(here, v);
            EXPECT_EQ(walked, paths.distance[at(v)]);
        }
    }
}

TEST(ShortestPaths, AvoidedVerticesAreLeavesWhereTheyCanBe) {
    const SurfaceMesh mesh = testing::bumpy_torus(8, 8);
    const Connectivity& c = mesh.connectivity;
    std::vector<std::uint8_t> avoided(at(c.vertex_count), 0);
    for (const Index v : {9, 12, 30, 50}) avoided[at(v)] = 1;  // no two are neighbours
    const ShortestPaths paths = shortest_paths(c, vertex_stars(c), mesh.edge_length, 0, avoided);
    for (Index v = 0; v < c.vertex_count; ++v) {
        if (paths.arriving[at(v)] != kNoStep) {
            EXPECT_EQ(avoided[at(step_tail(c, paths.arriving[at(v)]))], 0) << "parent of " << v;
        }
        EXPECT_FALSE(std::isinf(paths.distance[at(v)]));
    }
}

TEST(ChooseBase, FindsTheCentreOfADisk) {
    // The rounds suffice on a disk: the centre is as good as any vertex, checked against all.
    const SurfaceMesh mesh = testing::wavy_square(9, 0.2);
    const Connectivity& c = mesh.connectivity;
    const VertexStars stars = vertex_stars(c);
    const auto reach = [&](Index v) {
        const std::vector<double> d = shortest_paths(c, stars, mesh.edge_length, v).distance;
        return *std::max_element(d.begin(), d.end());
    };
    double least = kInfinity;
    for (Index v = 0; v < c.vertex_count; ++v) least = std::min(least, reach(v));
    EXPECT_EQ(reach(choose_base(c, mesh.edge_length)), least);
}

TEST(ChooseBase, DoesNotDependOnNumbering) {
    Random random(5);
    const SurfaceMesh mesh = testing::wavy_square(9, 0.3);
    const std::vector<Index> number = random.permutation(mesh.connectivity.vertex_count);
    const SurfaceMesh renumbered = testing::relabelled(mesh, number, random);
    EXPECT_EQ(number[at(choose_base(mesh.connectivity, mesh.edge_length))],
              choose_base(renumbered.connectivity, renumbered.edge_length));
}

TEST(ChooseBase, LeavesOutExcludedAndBoundaryVertices) {
    const SurfaceMesh mesh = testing::wavy_square(3);
    const Connectivity& c = mesh.connectivity;
    const std::vector<std::uint8_t> boundary = boundary_vertices(c);
    std::vector<std::uint8_t> excluded(at(c.vertex_count), 0);
    for (int trial = 0; trial < 4; ++trial) {  // the four interior vertices in turn
        const Index base = choose_base(c, mesh.edge_length, excluded);
        EXPECT_EQ(boundary[at(base)], 0);
        EXPECT_EQ(excluded[at(base)]++, 0);
    }
    EXPECT_EQ(boundary[at(choose_base(c, mesh.edge_length, excluded))], 1);
    excluded.assign(excluded.size(), 1);
    EXPECT_EQ(choose_base(c, mesh.edge_length, excluded), -1);
}

}  // namespace
}  // namespace ricci
