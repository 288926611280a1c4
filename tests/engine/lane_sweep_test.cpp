// Sweeps in lanes: the plain solver's answers, bits that depend on the vertex alone, every way to end early.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/surfaces/generate.h"
#include "engine/sweep/scheduler.h"
#include "engine/sweep/sweep_solver.h"
#include "io/mesh/mesh_file.h"
#include "tests/engine/sweep_checks.h"
#include "tests/support/small_surfaces.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using testing::expect_same;

using Solves = std::map<Index, SweepSolve>;

SurfaceMesh made(const std::string& name, Index faces, double jitter = 0.2) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    options.genus = 3;
    return generate(name, options);
}

std::shared_ptr<const SweepSurface> surface_of(SurfaceMesh mesh, const SweepOptions& options = {}) {
    return std::make_shared<SweepSurface>(std::move(mesh), options);
}

/// Solves `vertices` in the order given.
Solves run(SweepWorker& worker, const std::vector<Index>& vertices,
           const std::function<std::optional<Status>(double)>& interrupted = {}) {
    Solves solves;
    std::size_t given = 0;
    const auto next = [&]() -> std::optional<Index> {
        return given < vertices.size() ? std::optional(vertices[given++]) : std::nullopt;
    };
    const auto finished = [&](SweepSolve solve) {
        const Index vertex = solve.vertex;
        EXPECT_TRUE(solves.emplace(vertex, std::move(solve)).second) << "vertex " << vertex << " twice";
    };
    worker.run({next, finished, interrupted});
    EXPECT_EQ(solves.size(), vertices.size());
    return solves;
}

Solves run(const std::shared_ptr<const SweepSurface>& surface, const std::vector<Index>& vertices,
           int lanes = 0) {
    SweepWorker worker(surface, lanes);
    return run(worker, vertices);
}

void expect_same(const Solves& a, const Solves& b) {
    ASSERT_EQ(a.size(), b.size());
    for (const auto& [vertex, solve] : a) {
        ASSERT_TRUE(b.contains(vertex)) << vertex;
        expect_same(solve, b.at(vertex));
    }
}

/// Every vertex of `vertices` converges in lanes, to what Newton's method finds.
///
/// Two solutions with residuals below the tolerance differ by at most twice that times the largest entry of
/// the inverse Hessian: below 100 on these surfaces. The distortion is quadratic in u, which is of order 10.
void expect_oracle(const std::shared_ptr<const SweepSurface>& surface, const std::vector<Index>& vertices) {
    ASSERT_EQ(surface->inadmissible(), "");
    ASSERT_GT(surface->lanes(), 0) << "solved without lanes";
    const double tolerance = surface->options().tolerance;
    SweepWorker oracle(surface);
    for (const auto& [vertex, solve] : run(surface, vertices)) {
        ASSERT_EQ(solve.status, Status::converged) << "vertex " << vertex << ": " << solve.message;
        EXPECT_LE(solve.residual_max, tolerance);
        EXPECT_GT(solve.newton_iterations, 0);
        EXPECT_GT(solve.seconds, 0.0);
        const SweepSolve expected = oracle.solve(vertex, {});
        ASSERT_EQ(expected.status, Status::converged) << vertex;
        EXPECT_NEAR(solve.area_distortion, expected.area_distortion,
                    1e4 * tolerance * expected.area_distortion);
        ASSERT_EQ(solve.conformal_factor.size(), expected.conformal_factor.size());
        double largest = 0.0;
        for (std::size_t v = 0; v < expected.conformal_factor.size(); ++v)
            largest = std::max(largest, std::abs(solve.conformal_factor[v] - expected.conformal_factor[v]));
        EXPECT_LE(largest, 1e2 * tolerance) << "vertex " << vertex;
    }
}

std::vector<Index> some(const std::shared_ptr<const SweepSurface>& surface, std::int64_t count) {
    return sample_vertices(surface->candidates(), count, 3);
}

TEST(LaneSweep, ClosedSurfacesAgreeWithNewton) {
    for (const std::string name : {"eight", "genus-g"})
        for (const double tolerance : {1e-10, 1e-12}) {
            SweepOptions options;
            options.tolerance = tolerance;
            const auto surface = surface_of(made(name, 900), options);
            SCOPED_TRACE(name + " at " + std::to_string(-std::log10(tolerance)));
            expect_oracle(surface, some(surface, 40));
        }
}

TEST(LaneSweep, BoundariesAgreeWithNewton) {
    for (const std::string name : {"pants", "punctured-torus"})
        for (const Boundary boundary : {Boundary::geodesic, Boundary::free}) {
            SweepOptions options;
            options.boundary = boundary;
            if (boundary == Boundary::free) options.cone_curvature = -1.0;
            const auto surface = surface_of(made(name, 1000), options);
            SCOPED_TRACE(name + (boundary == Boundary::free ? ", free" : ", geodesic"));
            expect_oracle(surface, some(surface, 30));
        }
}

TEST(LaneSweep, WithoutIsometricDelaunayOnlyADelaunayInputSuitsLanes) {
    SweepOptions options;
    options.delaunay = false;
    const SurfaceMesh mesh = made("eight", 1000);
    const auto delaunay =
        surface_of(testing::intrinsic_mesh(make_flow_surface(mesh, false, true).triangulation), options);
    expect_oracle(delaunay, some(delaunay, 20));
    const auto other = surface_of(mesh, options);
    EXPECT_EQ(other->lanes(), 0);
    SweepWorker oracle(other);
    for (const auto& [vertex, solve] : run(other, some(other, 5))) {
        EXPECT_EQ(solve.status, Status::converged);
        expect_same(solve, oracle.solve(vertex, {}));
    }
}

TEST(LaneSweep, CirclePackingsAndTheNewtonSolverRunOneAtATime) {
    SweepOptions options;
    options.solver = SweepSolverKind::newton;
    const auto plain = surface_of(made("eight", 1000), options);
    EXPECT_EQ(plain->lanes(), 0);
    options.solver = SweepSolverKind::lanes;
    options.scheme = Scheme::inversive_distance;
    const auto packing = surface_of(made("eight", 1000), options);
    EXPECT_EQ(packing->lanes(), 0);
    for (const auto& surface : {plain, packing}) {
        SweepWorker oracle(surface);
        for (const auto& [vertex, solve] : run(surface, some(surface, 6)))
            if (solve.status == Status::converged) expect_same(solve, oracle.solve(vertex, {}));
    }
}

TEST(LaneSweep, BitsDependOnTheVertexAlone) {
    for (const std::string name : {"eight", "pants"}) {
        const auto surface = surface_of(made(name, 1000));
        ASSERT_GT(surface->lanes(), 0);
        std::vector<Index> vertices = some(surface, 50);
        SweepWorker worker(surface);
        const Solves expected = run(worker, vertices);
        for (const int lanes : {1, 3, 16}) expect_same(run(surface, vertices, lanes), expected);
        std::reverse(vertices.begin(), vertices.end());
        expect_same(run(worker, vertices), expected);
        vertices.resize(7);
        for (const auto& [vertex, solve] : run(worker, vertices)) expect_same(solve, expected.at(vertex));
        for (const auto& [vertex, solve] : run(surface_of(made(name, 1000)), vertices, 2))
            expect_same(solve, expected.at(vertex));
    }
}

TEST(LaneSweep, WorkersAtTheSameTimeAgree) {
    const auto surface = surface_of(made("eight", 1500));
    const std::vector<Index> vertices = some(surface, 24);
    const Solves expected = run(surface, vertices);
    std::vector<Solves> solves(3);
    std::vector<std::thread> threads;
    threads.reserve(solves.size());
    for (Solves& s : solves) threads.emplace_back([&] { s = run(surface, vertices, 5); });
    for (std::thread& thread : threads) thread.join();
    for (const Solves& s : solves) expect_same(s, expected);
}

/// A bound on the steps that lanes miss sends their vertices to Newton's method.
TEST(LaneSweep, WhatLanesDoNotSolveNewtonDoes) {
    const auto unbounded = surface_of(made("eight", 1000));
    const std::vector<Index> vertices = some(unbounded, 40);
    ASSERT_GT(unbounded->lanes(), 0);
    int fewest = 1000;
    for (const auto& [vertex, solve] : run(unbounded, vertices))
        fewest = std::min(fewest, solve.newton_iterations);
    for (const int most : {fewest - 1, fewest + 1}) {
        SweepOptions options;
        options.max_iterations = most;
        const auto surface = surface_of(made("eight", 1000), options);
        SweepWorker oracle(surface);
        Solves expected;
        for (const Index v : vertices) expected[v] = oracle.solve(v, {});
        for (const int lanes : {1, 4, 16}) {
            int by_newton = 0;
            for (const auto& [vertex, solve] : run(surface, vertices, lanes)) {
                if (solve.conformal_factor == expected[vertex].conformal_factor) {
                    ++by_newton;
                    expect_same(solve, expected[vertex]);
                } else {
                    EXPECT_EQ(solve.status, Status::converged);
                    EXPECT_LE(solve.newton_iterations, most);
                }
            }
            EXPECT_GT(by_newton, 0);
            EXPECT_EQ(by_newton == 40, most < fewest);
        }
    }
}

TEST(LaneSweep, InterruptedSolvesLeaveTheOthersAlone) {
    const auto surface = surface_of(made("eight", 1000));
    const std::vector<Index> vertices = some(surface, 30);
    SweepWorker worker(surface);
    const Solves expected = run(worker, vertices);
    // One question in ten.
    int asked = 0;
    const auto now_and_then = [&](double seconds) -> std::optional<Status> {
        EXPECT_GT(seconds, 0.0);
        return ++asked % 10 == 0 ? std::optional(Status::timeout) : std::nullopt;
    };
    int timed_out = 0;
    for (const auto& [vertex, solve] : run(worker, vertices, now_and_then)) {
        if (solve.status == Status::converged) {
            expect_same(solve, expected.at(vertex));
            continue;
        }
        ++timed_out;
        EXPECT_EQ(solve.status, Status::timeout);
        EXPECT_TRUE(std::isnan(solve.area_distortion));
        EXPECT_FALSE(solve.message.empty());
    }
    EXPECT_GT(timed_out, 0);
    EXPECT_LT(timed_out, 30);
    for (const auto& [vertex, solve] : run(worker, vertices, [](double) { return Status::cancelled; }))
        EXPECT_EQ(solve.status, Status::cancelled);
    expect_same(run(worker, vertices), expected);
}

TEST(LaneSweep, NothingIsLostWhereMemoryRunsOut) {
    const auto surface = surface_of(made("eight", 1000));
    const std::vector<Index> vertices = some(surface, 30);
    SweepWorker worker(surface), oracle(surface);
    const Solves expected = run(worker, vertices);
    Solves solves;
    std::size_t given = 0;
    bool thrown = false;
    const auto next = [&]() -> std::optional<Index> {
        if (given == 20 && !std::exchange(thrown, true)) throw std::bad_alloc();
        return given < vertices.size() ? std::optional(vertices[given++]) : std::nullopt;
    };
    worker.run({next, [&](SweepSolve solve) { solves[solve.vertex] = std::move(solve); }, {}});
    ASSERT_EQ(solves.size(), vertices.size());
    int by_newton = 0;
    for (const auto& [vertex, solve] : solves) {
        if (solve.conformal_factor == expected.at(vertex).conformal_factor) {
            expect_same(solve, expected.at(vertex));
        } else {
            ++by_newton;
            expect_same(solve, oracle.solve(vertex, {}));
        }
    }
    EXPECT_EQ(by_newton, 15) << "the lanes under way, but for the one that asked";
}

TEST(LaneSweep, ExceptionsOfTheStreamComeThroughAndTheWorkerGoesOn) {
    const auto surface = surface_of(made("eight", 1000));
    const std::vector<Index> vertices = some(surface, 20);
    SweepWorker worker(surface);
    const Solves expected = run(worker, vertices);
    int given = 0;
    const auto out_of_range = [&]() -> std::optional<Index> { return ++given < 5 ? given : -1; };
    EXPECT_THROW(worker.run({out_of_range, [](const SweepSolve&) {}, {}}), std::invalid_argument);
    given = 0;
    const auto disk_full = [](const SweepSolve&) { throw std::runtime_error("disk full"); };
    EXPECT_THROW(worker.run({[&]() -> std::optional<Index> { return ++given; }, disk_full, {}}),
                 std::runtime_error);
    expect_same(run(worker, vertices), expected);
}

TEST(LaneSweep, SecondsAreSharesOfTheWorkersTime) {
    const auto surface = surface_of(made("eight", 1000));
    SweepWorker worker(surface);
    const auto start = std::chrono::steady_clock::now();
    const Solves solves = run(worker, some(surface, 60));
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    double sum = 0.0;
    for (const auto& [vertex, solve] : solves) sum += solve.seconds;
    EXPECT_LE(sum, wall);
    EXPECT_GT(sum, 0.3 * wall) << "the rest prepares the worker and takes in results";
}

TEST(LaneSweep, SmallSurfaces) {
    for (const Index faces : {20, 60, 300, 600}) {
        const auto surface = surface_of(made("eight", faces, 0.0));
        SweepWorker oracle(surface);
        for (const auto& [vertex, solve] : run(surface, some(surface, 60))) {
            const SweepSolve expected = oracle.solve(vertex, {});
            EXPECT_EQ(solve.status, expected.status);
            EXPECT_NEAR(solve.area_distortion, expected.area_distortion, 1e-7 * expected.area_distortion);
        }
    }
}

/// A sample of a real mesh, at the tolerance of sweeps.
void expect_sample(const std::string& file) {
    RICCI_DATA_FILE_OR_SKIP(path, file);
    const LoadedMesh loaded = load_mesh(path);
    ASSERT_EQ(loaded.components.size(), 1U);
    const auto surface = surface_of(loaded.components[0]);
    ASSERT_GT(surface->lanes(), 0);
    SweepWorker oracle(surface);
    int checked = 0;
    for (const auto& [vertex, solve] : run(surface, some(surface, 50))) {
        ASSERT_EQ(solve.status, Status::converged) << file << ", vertex " << vertex << ": " << solve.message;
        EXPECT_LE(solve.residual_max, 1e-10);
        if (++checked % 10 != 0) continue;
        const SweepSolve expected = oracle.solve(vertex, {});
        EXPECT_NEAR(solve.area_distortion, expected.area_distortion, 1e-6 * expected.area_distortion);
        for (std::size_t v = 0; v < expected.conformal_factor.size(); ++v)
            ASSERT_NEAR(solve.conformal_factor[v], expected.conformal_factor[v], 1e-8) << file << ' ' << v;
    }
}

TEST(LaneSweepSamples, Eight) {
    expect_sample("meshes/closed_g2/eight.off");
}
TEST(LaneSweepSamples, ThreeHoles) {
    expect_sample("meshes/closed_g3/3holes.off");
}
TEST(LaneSweepSamples, Deckel) {
    expect_sample("meshes/closed_g4/deckel.off");
}
TEST(LaneSweepSamples, Fertility) {
    expect_sample("meshes/families/fertility_resolutions/fertility_4494v.off");
}

}  // namespace
}  // namespace ricci
