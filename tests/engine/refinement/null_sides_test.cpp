#include "engine/refinement/null_sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/engine/refinement/refinement_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::NamedMesh;

/// A cube, each side cut along one diagonal: four corners of a square lie on a circle.
SurfaceMesh cube() {
    std::vector<Point> points;
    for (int k = 0; k < 8; ++k) points.push_back({1.0 * (k & 1), 1.0 * (k >> 1 & 1), 1.0 * (k >> 2)});
    std::vector<Triangle> faces;
    const std::vector<std::array<Index, 4>> squares = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& s : squares) {
        faces.push_back({s[0], s[1], s[2]});
        faces.push_back({s[0], s[2], s[3]});
    }
    return make_surface_mesh(std::move(points), faces);
}

/// Symmetric surfaces with factors that keep some of the symmetry and make edges flip.
std::vector<NamedMesh> symmetric_surfaces() {
    std::vector<NamedMesh> surfaces;
    surfaces.push_back({"octahedron", testing::octahedron()});
    surfaces.push_back({"cube", cube()});
    surfaces.push_back({"regular torus", testing::bumpy_torus(6, 6, 0.0)});
    surfaces.push_back({"flat square", testing::wavy_square(4)});
    surfaces.push_back({"bolza", make_bolza()});
    surfaces.push_back({"eight", testing::generated("eight", 400)});
    return surfaces;
}

/// Side lengths relative to the longest, ascending.
double shortest_side(const CommonRefinement& r) {
    double shortest = 1e300, longest = 0;
    for (Index c = 0; c < r.corner_count(); ++c) {
        const auto &p = r.flat[at(c)], &q = r.flat[at(r.next(c))];
        // Two vertices of the input stay apart whatever their distance.
        const double length = std::hypot(q[0] - p[0], q[1] - p[1]);
        shortest = std::min(shortest, length);
        longest = std::max(longest, length);
    }
    return shortest / longest;
}

TEST(NullSides, NoneAreLeftOnSymmetricSurfaces) {
    for (const NamedMesh& surface : symmetric_surfaces()) {
        for (const double amplitude : {1.0, 2.0, 3.0}) {
            SCOPED_TRACE(surface.name + ", amplitude " + std::to_string(amplitude));
            const Connectivity& c = surface.mesh.connectivity;
            std::vector<double> u(at(c.vertex_count));
            for (std::size_t v = 0; v < u.size(); ++v) u[v] = v % 3 == 0 ? amplitude : 0.0;
            CommonRefinement r = make_common_refinement(surface.mesh, u, false, true);
            EXPECT_GT(shortest_side(r), 1e-15);
            EXPECT_EQ(collapse_null_sides(r), 0);
            std::vector<std::uint8_t> used(at(r.vertex_count), 0);
            Index edges = 0;
            for (Index k = 0; k < r.corner_count(); ++k) {
                const Index t = r.twin[at(k)];
                used[at(r.vertex[at(k)])] = 1;
                edges += t < k ? 1 : 0;
                if (t < 0) continue;
                EXPECT_EQ(r.twin[at(t)], k);
                EXPECT_EQ(r.vertex[at(t)], r.vertex[at(r.next(k))]);
            }
            const auto vertices = static_cast<Index>(std::count(used.begin(), used.end(), 1));
            EXPECT_EQ(vertices - edges + r.piece_count(), topology_of(c).euler_characteristic);
        }
    }
}

/// A square cut by an edge of the input and one of the final triangulation that cross within rounding of a
/// corner would have a triangle of no area there: built by hand.
TEST(NullSides, APieceThatLosesItsAreaIsBridged) {
    const SurfaceMesh mesh = testing::bumpy_torus(5, 4, 0.2, 3);
    testing::Random random(2);
    const std::vector<double> u = random.uniforms(at(mesh.connectivity.vertex_count), -1, 1);
    CommonRefinement r = make_common_refinement(mesh, u, false, true);
    // A side between two crossings that is no edge of a triangle's loss: shrink it in both its pieces.
    Index side = -1;
    for (Index k = 0; k < r.corner_count() && side < 0; ++k) {
        const auto sides = [&](Index c) {
            return r.first[at(r.piece[at(c)]) + 1] - r.first[at(r.piece[at(c)])];
        };
        if (r.vertex[at(k)] < r.input_vertices || r.vertex[at(r.next(k))] < r.input_vertices) continue;
        if (sides(k) == 3 && sides(r.twin[at(k)]) > 3) side = k;
    }
    ASSERT_GE(side, 0);
    const Index before = r.piece_count(), twin = r.twin[at(side)];
    r.flat[at(r.next(side))] = r.flat[at(side)];
    r.flat[at(r.next(twin))] = r.flat[at(twin)];
    const Index gone = r.vertex[at(side)], other = r.vertex[at(r.next(side))];
    EXPECT_EQ(collapse_null_sides(r), 1);
    EXPECT_EQ(r.piece_count(), before - 1);
    EXPECT_EQ(std::count(r.vertex.begin(), r.vertex.end(), std::max(gone, other)), 0);
    for (Index k = 0; k < r.corner_count(); ++k) {
        const Index t = r.twin[at(k)];
        ASSERT_GE(t, 0);
        EXPECT_EQ(r.twin[at(t)], k);
        EXPECT_EQ(r.vertex[at(t)], r.vertex[at(r.next(k))]);
        EXPECT_EQ(r.vertex[at(r.next(t))], r.vertex[at(k)]);
    }
}

}  // namespace
}  // namespace ricci
