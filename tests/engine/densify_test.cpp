// Refinement around a cone: the same surface, a higher valence, and targets that become admissible.
#include "engine/remesh/densify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/surfaces/generate.h"
#include "engine/sweep/sweep_solver.h"
#include "kernels/face_kernels.h"
#include "kernels/intrinsic_triangulation.h"
#include "tests/engine/surface_checks.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::at;

std::vector<double> angle_sums(const SurfaceMesh& mesh) {
    const auto t = intrinsic_triangulation<double>(mesh);
    std::vector<double> angle(t.log_chord.size()), total(at(mesh.connectivity.vertex_count));
    const std::vector<double> u(total.size(), 0.0);
    EXPECT_EQ(evaluate_faces<double>(Geometry::euclidean, {t.connectivity.tail, t.log_chord, u},
                                     {angle, {}, {}, {}}, false),
              0);
    sum_corners<double>(t.connectivity.tail, angle, total);
    return total;
}

Index valence_of(const SurfaceMesh& mesh, Index vertex) {
    Index count = 0;
    for (const Index v : mesh.connectivity.tail) count += v == vertex ? 1 : 0;
    return count;
}

TEST(Densify, KeepsTheSurfaceAndRaisesTheValence) {
    for (const SurfaceMesh& mesh : {testing::bumpy_torus(6, 5), testing::icosahedron(0.2),
                                    testing::wavy_square(4, 0.2), testing::octahedron()}) {
        const auto before = angle_sums(mesh);
        const auto boundary = boundary_vertices(mesh.connectivity);
        for (const Index vertex : {Index{2}, mesh.connectivity.vertex_count / 2}) {
            if (boundary[at(vertex)]) continue;
            for (const Index valence : {3, 9, 17})
                for (const int levels : {0, 1, 2}) {
                    const DensifiedMesh dense = densify_around(mesh, vertex, valence, 2, levels);
                    EXPECT_STREQ(check_connectivity(dense.mesh.connectivity), "");
                    const Topology a = topology_of(mesh.connectivity),
                                   b = topology_of(dense.mesh.connectivity);
                    EXPECT_EQ(a.genus, b.genus);
                    EXPECT_EQ(a.boundaries, b.boundaries);
                    EXPECT_EQ(dense.valence, valence_of(dense.mesh, vertex));
                    EXPECT_GE(dense.valence, std::max(valence, valence_of(mesh, vertex)));
                    EXPECT_NEAR(testing::total_area(dense.mesh) / testing::total_area(mesh), 1.0, 1e-13);
                    // Old vertices where they were, with their angles; new ones flat (pi on the boundary).
                    // Angles of the thin triangles around the vertex, above 0.01, lose 1e-16 / 0.01 each.
                    const auto after = angle_sums(dense.mesh);
                    const auto on_boundary = boundary_vertices(dense.mesh.connectivity);
                    for (std::size_t v = 0; v < after.size(); ++v) {
                        if (v < before.size()) {
                            EXPECT_EQ(dense.mesh.points[v], mesh.points[v]);
                            EXPECT_EQ(dense.mesh.input_vertex[v], mesh.input_vertex[v]);
                            EXPECT_NEAR(after[v], before[v], 1e-12);
                        } else {
                            EXPECT_EQ(dense.mesh.input_vertex[v], -1);
                            EXPECT_NEAR(after[v], on_boundary[v] ? pi : 2 * pi, 1e-12);
                        }
                    }
                }
        }
    }
}

TEST(Densify, MakesAConeAdmissible) {
    // Valence 6 allows a tangential packing K > 2 pi - 6 pi; the cone of genus 3 needs -8 pi.
    GenerateOptions generate_options;
    generate_options.faces = 900;
    generate_options.genus = 3;
    const SurfaceMesh mesh = generate("genus-g", generate_options);
    Index vertex = 0;
    while (valence_of(mesh, vertex) != 6) ++vertex;
    FlowOptions options;
    options.scheme = Scheme::tangential;
    options.cones = {{vertex, -8 * pi}};
    const FlowResult coarse = solve_flow(mesh, options);
    EXPECT_EQ(coarse.outcome.status, Status::inadmissible_target);
    EXPECT_NE(coarse.message.find("{" + std::to_string(vertex) + "}"), std::string::npos) << coarse.message;
    const DensifiedMesh dense = densify_around(mesh, vertex, 12);
    const FlowResult fine = solve_flow(dense.mesh, options);
    EXPECT_EQ(fine.outcome.status, Status::converged) << fine.message;
    SweepOptions sweep;
    sweep.scheme = Scheme::tangential;
    sweep.densify = true;
    SweepWorker worker(std::make_shared<SweepSurface>(mesh, sweep));
    const SweepSolve solved = worker.solve(vertex, {});
    EXPECT_EQ(solved.status, Status::converged) << solved.message;
    EXPECT_EQ(solved.vertex, vertex);
    EXPECT_EQ(solved.conformal_factor.size(), mesh.points.size());
}

TEST(Densify, RefusesIntrinsicSurfaces) {
    const SurfaceMesh torus = testing::intrinsic_mesh(testing::one_vertex_torus<double>(1, 1, 1));
    EXPECT_THROW(densify_around(torus, 0, 12), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
