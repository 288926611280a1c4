#include "engine/shape_space/path_holonomy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/shape_space/closed_geodesic.h"
#include "engine/shape_space/drawn_geodesic.h"
#include "engine/surfaces/generate.h"
#include "engine/topology/boundary_loops.h"

namespace ricci {
namespace {

SurfaceMesh sample(const std::string& name, Index faces) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = 0.2;
    return generate(name, options);
}

void append(EdgePath& path, const EdgePath& more) {
    path.insert(path.end(), more.begin(), more.end());
}

TEST(PathHolonomy, AgreesWithTheWordsOfTheGroup) {
    const SurfaceMesh mesh = sample("eight", 800);
    const SurfaceStructure s = make_sharp_structure(mesh, {}, 16);
    const PathHolonomy holonomy(s, mesh.connectivity);
    for (Index x = 0; x < s.basis->loops(); ++x)
        for (Index y = 0; y < s.basis->loops(); ++y) {
            if (x == y) continue;
            EdgePath path = s.basis->loop_path(x);
            append(path, s.basis->loop_path(y));
            const PathLength l = holonomy.length_of(path);
            EXPECT_NEAR(l.length, loop_length(s, path), 1e-8);
            EXPECT_LT(l.spread, 1e-9);
            const Isometry<double> there = holonomy.of(path),
                                   back = holonomy.of(reversed_path(mesh.connectivity, path));
            EXPECT_LT(distance_to_identity(compose(-1, there, back)), 1e-7);
            for (std::size_t first = 0; first < path.size(); first += 1 + path.size() / 7)
                EXPECT_NEAR(translation_length(holonomy.of(path, first)), l.length, 1e-8) << first;
        }
}

TEST(PathHolonomy, WalksBoundaryEdgesBothWays) {
    const SurfaceMesh mesh = sample("pants", 500);
    const SurfaceStructure s = make_sharp_structure(mesh, {}, 16);
    ASSERT_EQ(s.flow.outcome.status, Status::converged);
    const PathHolonomy holonomy(s, mesh.connectivity);
    for (const std::vector<Index>& loop : boundary_loops(mesh.connectivity)) {
        const EdgePath path(loop.begin(), loop.end()), back = reversed_path(mesh.connectivity, path);
        ASSERT_LT(back.front(), 0);
        const double length = holonomy.length_of(path).length;
        EXPECT_NEAR(length, loop_length(s, path), 1e-8);
        EXPECT_NEAR(holonomy.length_of(back).length, length, 1e-10);
        EXPECT_LT(distance_to_identity(compose(-1, holonomy.of(path), holonomy.of(back))), 1e-9);
    }
}

TEST(PathHolonomy, SaysWhatADetourCosts) {
    const SurfaceMesh mesh = sample("eight", 800);
    const SurfaceStructure s = make_sharp_structure(mesh, {}, 16);
    const PathHolonomy holonomy(s, mesh.connectivity);
    const EdgePath loop = s.basis->loop_path(0);
    EdgePath there;
    for (int turns = 0; turns < 5; ++turns) append(there, s.basis->loop_path(1));
    EdgePath path = there;
    append(path, loop);
    append(path, reversed_path(mesh.connectivity, there));
    const PathLength near = holonomy.length_of(loop), far = holonomy.length_of(path);
    EXPECT_LT(near.spread, 1e-12);
    EXPECT_GT(far.spread, 100 * near.spread);
    EXPECT_LT(std::abs(far.length - near.length), 100 * far.spread * near.length);
    EXPECT_EQ(holonomy.length_of(EdgePath{}).length, 0.0);
    EXPECT_EQ(holonomy.length_of(EdgePath{}).spread, 0.0);
    EXPECT_EQ(
        holonomy.length_of(EdgePath{loop[0], reversed_path(mesh.connectivity, EdgePath{loop[0]})[0]}).length,
        0.0);
}

}  // namespace
}  // namespace ricci
