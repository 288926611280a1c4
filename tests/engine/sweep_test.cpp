// One surface, every vertex the only cone in turn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "engine/surfaces/generate.h"
#include "engine/sweep/area_distortion.h"
#include "engine/sweep/scheduler.h"
#include "engine/sweep/sweep_solver.h"
#include "engine/verify/recompute.h"
#include "io/mesh/mesh_file.h"
#include "tests/engine/sweep_checks.h"
#include "tests/support/small_surfaces.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using testing::expect_same;

using std::numbers::pi;
using testing::at;

SurfaceMesh made(const std::string& name, Index faces, double jitter = 0.0) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    return generate(name, options);
}

TEST(SweepSurface, ExplainsWhyNoVertexCanBeTheOnlyCone) {
    const auto reason = [](const SurfaceMesh& mesh, const SweepOptions& options) {
        return SweepSurface(mesh, options).inadmissible();
    };
    EXPECT_NE(reason(testing::bumpy_torus(5, 5), {}).find("chi = 0"), std::string::npos);
    EXPECT_NE(reason(testing::octahedron(), {}).find("chi = 2"), std::string::npos);
    EXPECT_NE(reason(testing::wavy_square(4), {}).find("chi = 1"), std::string::npos);
    EXPECT_EQ(reason(made("eight", 300), {}), "");
    SweepOptions options;
    options.cone_curvature = -3 * pi;
    EXPECT_NE(reason(made("eight", 300), options).find("Gauss-Bonnet"), std::string::npos);
    options.cone_curvature = -4 * pi;
    EXPECT_EQ(reason(made("eight", 300), options), "");
    options.boundary = Boundary::free;
    options.cone_curvature = 1.0;
    EXPECT_EQ(reason(testing::wavy_square(4), options), "");
    options.cone_curvature = 2 * pi;
    EXPECT_NE(reason(testing::wavy_square(4), options), "");
    options.cone_curvature = 1.0;
    EXPECT_NE(reason(testing::wavy_square(1), options), "") << "no interior vertex";
}

TEST(SweepSurface, CandidatesAreTheInteriorVertices) {
    SweepOptions options;
    options.boundary = Boundary::free;
    options.cone_curvature = 1.0;
    EXPECT_EQ(SweepSurface(testing::wavy_square(3), options).candidates(), (std::vector<Index>{5, 6, 9, 10}));
}

TEST(Sweep, RefusesVerticesThatAreNoCandidates) {
    SweepOptions options;
    options.boundary = Boundary::free;
    options.cone_curvature = 0.3;
    SweepWorker worker(std::make_shared<SweepSurface>(testing::wavy_square(3), options));
    for (const Index v : {-1, 0, 3, 16}) EXPECT_THROW(worker.solve(v, {}), std::invalid_argument) << v;
    EXPECT_EQ(worker.solve(5, {}).status, Status::converged);
}

TEST(Sweep, SymmetricSurfacesHaveSymmetricDistortion) {
    const SurfaceMesh mesh = made("eight", 500);
    const auto vertex_at = [&](const Point& p) {
        for (Index v = 0; v < mesh.connectivity.vertex_count; ++v) {
            const Point& q = mesh.points[at(v)];
            if (std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) < 1e-9) return v;
        }
        return Index{-1};
    };
    SweepWorker worker(std::make_shared<SweepSurface>(mesh, SweepOptions{}));
    int pairs = 0;
    for (const Index v : {3, 50, 77, 131, 180}) {
        ASSERT_LT(v, mesh.connectivity.vertex_count);
        const double expected = worker.solve(v, {}).area_distortion;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Point mirrored = mesh.points[at(v)];
            mirrored[axis] = -mirrored[axis];
            const Index match = vertex_at(mirrored);
            ASSERT_GE(match, 0) << "vertex " << v << ", axis " << axis;
            if (match == v) continue;
            ++pairs;
            EXPECT_NEAR(worker.solve(match, {}).area_distortion, expected, 1e-6)
                << "vertex " << v << ", axis " << axis;
        }
    }
    EXPECT_GE(pairs, 8);
}

TEST(Sweep, BitsDependOnTheVertexAlone) {
    const auto surface = std::make_shared<SweepSurface>(made("eight", 700, 0.3), SweepOptions{});
    std::vector<Index> vertices;
    vertices.reserve(40);
    for (Index v = 0; v < 40; ++v) vertices.push_back(8 * v);
    ASSERT_LT(vertices.back(), surface->mesh().connectivity.vertex_count);
    SweepWorker first(surface);
    std::map<Index, SweepSolve> expected;
    for (const Index v : vertices) expected[v] = first.solve(v, {});
    std::reverse(vertices.begin(), vertices.end());
    for (const Index v : vertices) expect_same(first.solve(v, {}), expected[v]);
    SweepWorker second(surface);
    for (const Index v : {Index{160}, Index{0}, Index{312}, Index{160}})
        expect_same(second.solve(v, {}), expected[v]);
    // After a solve that was interrupted half way.
    int asked = 0;
    const SweepSolve broken_off = second.solve(88, [&]() -> std::optional<Status> {
        return ++asked > 2 ? std::optional(Status::timeout) : std::nullopt;
    });
    EXPECT_EQ(broken_off.status, Status::timeout);
    EXPECT_TRUE(std::isnan(broken_off.area_distortion));
    expect_same(second.solve(80, {}), expected[80]);
    // Another surface object of the same mesh.
    SweepWorker third(std::make_shared<SweepSurface>(made("eight", 700, 0.3), SweepOptions{}));
    expect_same(third.solve(8, {}), expected[8]);
}

TEST(Sweep, WorkersMadeAtTheSameTimeAgree) {
    // METIS, behind the orderings, draws from the process's one random generator.
    const auto surface = std::make_shared<SweepSurface>(made("eight", 3000, 0.2), SweepOptions{});
    const SweepSolve expected = SweepWorker(surface).solve(17, {});
    for (int round = 0; round < 3; ++round) {
        std::vector<SweepSolve> solves(4);
        std::vector<std::thread> threads;
        threads.reserve(solves.size());
        for (SweepSolve& solve : solves)
            threads.emplace_back([&] { solve = SweepWorker(surface).solve(17, {}); });
        for (std::thread& thread : threads) thread.join();
        for (const SweepSolve& solve : solves) expect_same(solve, expected);
    }
}

TEST(Sweep, AgreesWithTheSingleFlowAndTheSecondOpinion) {
    const SurfaceMesh mesh = made("eight", 600, 0.3);
    SweepWorker worker(std::make_shared<SweepSurface>(mesh, SweepOptions{}));
    for (const Index v : {5, 123}) {
        const SweepSolve solved = worker.solve(v, {});
        ASSERT_EQ(solved.status, Status::converged);
        EXPECT_LE(solved.residual_max, 1e-10);
        FlowOptions options;
        options.cones = {{v, -4 * pi}};
        const FlowResult flow = solve_flow(mesh, options);
        for (std::size_t k = 0; k < flow.conformal_factor.size(); ++k)
            EXPECT_NEAR(solved.conformal_factor[k], flow.conformal_factor[k], 1e-8);
        const Recomputed r =
            recompute_scaling(mesh, solved.conformal_factor, Geometry::euclidean, Boundary::geodesic, true);
        EXPECT_NEAR(r.area_distortion, solved.area_distortion, 1e-10 * solved.area_distortion);
        for (std::size_t k = 0; k < r.curvature.size(); ++k)
            EXPECT_NEAR(r.curvature[k], static_cast<Index>(k) == v ? -4 * pi : 0.0, 1.1e-10);
        EXPECT_NEAR(
            area_distortion_of_scaling(face_areas(mesh), mesh.connectivity.tail, solved.conformal_factor),
            solved.area_distortion, 1e-14);
    }
}

TEST(Sweep, BoundariesAreGeodesicThroughTheDoubleOrFree) {
    for (const Boundary boundary : {Boundary::geodesic, Boundary::free})
        for (const std::string name : {"pants", "punctured-torus"}) {
            const SurfaceMesh mesh = made(name, 600, 0.2);
            SweepOptions options;
            options.boundary = boundary;
            const double cone = 2 * pi * topology_of(mesh.connectivity).euler_characteristic;
            if (boundary == Boundary::free) options.cone_curvature = -1.0;
            const auto surface = std::make_shared<SweepSurface>(mesh, options);
            SweepWorker worker(surface);
            const auto on_boundary = boundary_vertices(mesh.connectivity);
            const std::vector<Index>& candidates = surface->candidates();
            for (const Index v : {candidates[7], candidates[candidates.size() / 2]}) {
                const SweepSolve solved = worker.solve(v, {});
                ASSERT_EQ(solved.status, Status::converged) << name << solved.message;
                const Recomputed r =
                    recompute_scaling(mesh, solved.conformal_factor, Geometry::euclidean, boundary, true);
                EXPECT_TRUE(r.valid);
                double total = 0.0;
                for (std::size_t k = 0; k < r.curvature.size(); ++k) {
                    total += r.curvature[k];
                    if (on_boundary[k] && boundary == Boundary::free) {
                        EXPECT_EQ(solved.conformal_factor[k], 0.0);
                    } else {
                        const double target =
                            static_cast<Index>(k) == v ? options.cone_curvature.value_or(cone) : 0.0;
                        EXPECT_NEAR(r.curvature[k], target, 1.1e-10) << name << ", vertex " << k;
                    }
                }
                EXPECT_NEAR(total, cone, 1e-11);
            }
        }
}

TEST(Sweep, PackingsAgreeWithTheSecondOpinionOrNameTheViolatedSet) {
    const SurfaceMesh mesh = made("eight", 400);
    for (const Scheme scheme : {Scheme::tangential, Scheme::thurston, Scheme::inversive_distance}) {
        SweepOptions options;
        options.scheme = scheme;
        SweepWorker worker(std::make_shared<SweepSurface>(mesh, options));
        const CirclePacking packing =
            initial_circle_packing(mesh.connectivity, mesh.edge_length, Geometry::euclidean, scheme);
        int converged = 0;
        for (Index v = 0; v < mesh.connectivity.vertex_count; v += 9) {
            const SweepSolve solved = worker.solve(v, {});
            EXPECT_EQ(solved.vertex, v);
            if (solved.status != Status::converged) {
                EXPECT_TRUE(std::isnan(solved.area_distortion));
                EXPECT_FALSE(solved.message.empty());
                continue;
            }
            ++converged;
            const Recomputed r = recompute_packing(mesh, packing.eta, packing.eps, solved.conformal_factor,
                                                   Geometry::euclidean);
            EXPECT_NEAR(r.area_distortion, solved.area_distortion, 1e-9 * (1 + solved.area_distortion));
            // The cone's -4 pi leaves radii in the ratio e^-5 or so: three digits fewer than 1e-13.
            for (std::size_t k = 0; k < r.curvature.size(); ++k)
                EXPECT_NEAR(r.curvature[k], static_cast<Index>(k) == v ? -4 * pi : 0.0, 2e-10)
                    << name_of(scheme);
        }
        if (scheme != Scheme::tangential) continue;
        // Valence 6: the bound is 2 pi - 6 pi, which the cone meets exactly; only higher valences reach it.
        const Index seven = [&] {
            std::vector<int> valence(at(mesh.connectivity.vertex_count), 0);
            for (const Index t : mesh.connectivity.tail) ++valence[at(t)];
            return static_cast<Index>(
                std::find_if(valence.begin(), valence.end(), [](int n) { return n >= 7; }) - valence.begin());
        }();
        if (seven < mesh.connectivity.vertex_count) {
            EXPECT_EQ(worker.solve(seven, {}).status, Status::converged);
        }
    }
}

/// Fifty sampled vertices all converge, and a second opinion agrees about the best.
void expect_sweeps(const std::string& file) {
    RICCI_DATA_FILE_OR_SKIP(path, file);
    const LoadedMesh loaded = load_mesh(path);
    ASSERT_EQ(loaded.components.size(), 1U);
    const auto surface = std::make_shared<SweepSurface>(loaded.components[0], SweepOptions{});
    ASSERT_EQ(surface->inadmissible(), "");
    SweepWorker worker(surface);
    SweepSolve best;
    for (const Index v : sample_vertices(surface->candidates(), 50, 1)) {
        SweepSolve solved = worker.solve(v, {});
        ASSERT_EQ(solved.status, Status::converged) << file << ", vertex " << v << ": " << solved.message;
        EXPECT_LE(solved.residual_max, 1e-10);
        if (best.conformal_factor.empty() || solved.area_distortion < best.area_distortion)
            best = std::move(solved);
    }
    const Recomputed r = recompute_scaling(surface->mesh(), best.conformal_factor, Geometry::euclidean,
                                           Boundary::geodesic, true);
    EXPECT_TRUE(r.valid);
    EXPECT_NEAR(r.area_distortion, best.area_distortion, 1e-10 * best.area_distortion);
    const double cone = 2 * pi * surface->topology().euler_characteristic;
    // The tolerance, and rounding in the thinnest triangles of a real mesh.
    for (std::size_t k = 0; k < r.curvature.size(); ++k)
        EXPECT_NEAR(r.curvature[k], static_cast<Index>(k) == best.vertex ? cone : 0.0, 2e-10)
            << file << ", vertex " << k;
}

TEST(SweepSamples, Eight) {
    expect_sweeps("meshes/closed_g2/eight.off");
}
TEST(SweepSamples, ThreeHoles) {
    expect_sweeps("meshes/closed_g3/3holes.off");
}
TEST(SweepSamples, Deckel) {
    expect_sweeps("meshes/closed_g4/deckel.off");
}
TEST(SweepSamples, Fertility) {
    expect_sweeps("meshes/families/fertility_resolutions/fertility_4494v.off");
}

/// Meshes with angles down to 0.0002 degrees reach the uniform target.
void expect_uniform(const std::string& file) {
    RICCI_DATA_FILE_OR_SKIP(path, file);
    const LoadedMesh loaded = load_mesh(path);
    ASSERT_EQ(loaded.components.size(), 1U);
    FlowOptions options;
    options.target = TargetKind::uniform;
    const FlowResult result = solve_flow(loaded.components[0], options);
    EXPECT_EQ(result.outcome.status, Status::converged)
        << file << ": " << result.outcome.residual_max << ", " << result.message;
    const Recomputed r = recompute_scaling(loaded.components[0], result.conformal_factor, Geometry::euclidean,
                                           Boundary::geodesic, true);
    EXPECT_TRUE(r.valid);
    double largest = 0.0;
    for (std::size_t k = 0; k < r.curvature.size(); ++k)
        largest = std::max(largest, std::abs(r.curvature[k] - result.target_curvature[k]));
    EXPECT_LT(largest, 1e-9) << file;
}

TEST(HardMeshes, Triceratops) {
    expect_uniform("meshes/closed_g0/triceratops.off");
}
TEST(HardMeshes, AnchorDense) {
    expect_uniform("meshes/closed_g4/anchor_dense.off");
}
TEST(HardMeshes, Block) {
    expect_uniform("meshes/closed_g3/block.off");
}
TEST(HardMeshes, Thingi72214) {
    expect_uniform("meshes/closed_g1/thingi_72214.stl");
}
TEST(HardMeshes, FixedTop) {
    expect_uniform("meshes/closed_g5plus/fixed_top_g7.ply");
}

}  // namespace
}  // namespace ricci
