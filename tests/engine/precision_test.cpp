// Solves that need more digits than double: they say so, the numbers hold, and those that need none are as
// before.
#include "engine/flow/precision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/surfaces/generate.h"
#include "engine/sweep/sweep_solver.h"
#include "tests/support/random_targets.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::check_flow;
using testing::FlowCheck;
using testing::random_target;
using testing::TargetDraw;

SurfaceMesh surface(const std::string& name, Index faces = 2000) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = 0.3;
    options.seed = 1;
    return generate(name, options);
}

FlowResult solve(const SurfaceMesh& mesh, std::vector<double> target,
                 Precision precision = Precision::automatic, bool parallel = false) {
    FlowOptions options;
    options.geometry = Geometry::euclidean;
    options.target = TargetKind::values;
    options.target_values = std::move(target);
    options.precision = precision;
    options.parallel = parallel;
    return solve_flow(mesh, options);
}

/// The short form of bench/stress_protocol.
void expect_reached(const std::string& name, TargetDraw draw, int count) {
    const SurfaceMesh mesh = surface(name);
    for (int seed = 0; seed < count; ++seed) {
        const std::vector<double> target = random_target(mesh, draw, static_cast<std::uint64_t>(seed));
        const FlowResult flow = solve(mesh, target);
        const FlowCheck check = check_flow(mesh, flow, target);
        const std::string what = name + " " + std::string(name_of(draw)) + " " + std::to_string(seed);
        EXPECT_EQ(flow.outcome.status, Status::converged) << what << ": " << flow.message;
        EXPECT_LE(flow.outcome.residual_max, 1e-10) << what;
        // A tenth of the tolerance may hide in rounding.
        EXPECT_LE(check.residual_max, 1.1e-10) << what;
        EXPECT_LE(std::max(flow.gauss_bonnet_error, check.gauss_bonnet_error), 1e-9) << what;
        EXPECT_TRUE(check.triangles) << what;
        EXPECT_EQ(check.non_delaunay, 0) << what;
        EXPECT_EQ(check.edges_that_differ, 0U) << what;
    }
}

TEST(Precision, EveryRandomTargetIsReached) {
    for (const std::string name : {"sphere", "eight"}) {
        expect_reached(name, TargetDraw::mild, 4);
        expect_reached(name, TargetDraw::random, 10);
        expect_reached(name, TargetDraw::harsh, 5);
    }
}

TEST(Precision, WhatIsNotReachedIsToldTruly) {
    // Angles over twelve decades: cotangents of 1e9 and more, where the double Hessian may hold a solve up.
    const SurfaceMesh mesh = surface("sphere");
    for (const std::uint64_t seed : {0U, 2U}) {
        const std::vector<double> target = random_target(mesh, TargetDraw::extreme, seed);
        const FlowResult flow = solve(mesh, target);
        const FlowCheck check = check_flow(mesh, flow, target);
        EXPECT_EQ(flow.precision_digits, 50);
        EXPECT_EQ(flow.outcome.status == Status::converged, check.residual_max <= 1e-10) << seed;
        EXPECT_EQ(flow.outcome.status == Status::converged, flow.message.empty()) << seed;
        EXPECT_NEAR(flow.outcome.residual_max, check.residual_max, 1e-12 + 1e-6 * check.residual_max) << seed;
        EXPECT_TRUE(check.triangles) << seed;
        EXPECT_EQ(check.non_delaunay, 0) << seed;
        EXPECT_EQ(check.edges_that_differ, 0U) << seed;
    }
}

/// A target that double does not reach (sphere, random, 3).
struct Hard {
    SurfaceMesh mesh = surface("sphere");
    std::vector<double> target = random_target(mesh, TargetDraw::random, 3);
};

TEST(Precision, DoubleAloneSaysWhereItEnds) {
    const Hard hard;
    const FlowResult plain = solve(hard.mesh, hard.target, Precision::plain);
    EXPECT_EQ(plain.precision_digits, 16);
    EXPECT_TRUE(plain.conformal_factor_low.empty());
    EXPECT_EQ(plain.outcome.status, Status::stalled);
    EXPECT_GT(plain.outcome.residual_max, 1e-10);
    // Not far off: the check in long double sees a residual of the same kind.
    EXPECT_GT(check_flow(hard.mesh, plain, hard.target).residual_max, 1e-10);
    EXPECT_LT(check_flow(hard.mesh, plain, hard.target).residual_max, 1e-5);
    const FlowResult more = solve(hard.mesh, hard.target);
    EXPECT_EQ(more.outcome.status, Status::converged);
    EXPECT_GT(more.precision_digits, 16);
    EXPECT_GT(more.outcome.iterations, plain.outcome.iterations) << "it starts where double stopped";
    ASSERT_EQ(more.outcome.log.size(), static_cast<std::size_t>(more.outcome.iterations) + 1);
    for (std::size_t k = 0; k < more.outcome.log.size(); ++k)
        EXPECT_EQ(more.outcome.log[k].iteration, static_cast<std::int32_t>(k));
}

TEST(Precision, ALowPartIsThereWhereItIsNeeded) {
    const Hard hard;
    const FlowResult flow = solve(hard.mesh, hard.target);
    ASSERT_EQ(flow.conformal_factor_low.size(), flow.conformal_factor.size());
    FlowResult rounded = flow;
    rounded.conformal_factor_low.clear();
    EXPECT_LE(check_flow(hard.mesh, flow, hard.target).residual_max, 1.1e-10);
    EXPECT_GT(check_flow(hard.mesh, rounded, hard.target).residual_max, 1.1e-10);
    for (std::size_t v = 0; v < flow.conformal_factor.size(); ++v)
        EXPECT_LE(std::abs(flow.conformal_factor_low[v]), 0x1p-52 * std::abs(flow.conformal_factor[v]));
}

TEST(Precision, SameBitsAgainAndInParallel) {
    const Hard hard;
    const FlowResult a = solve(hard.mesh, hard.target), b = solve(hard.mesh, hard.target),
                     c = solve(hard.mesh, hard.target, Precision::automatic, true);
    for (const FlowResult* other : {&b, &c}) {
        EXPECT_EQ(a.conformal_factor, other->conformal_factor);
        EXPECT_EQ(a.conformal_factor_low, other->conformal_factor_low);
        EXPECT_EQ(a.outcome.residual_max, other->outcome.residual_max);
        EXPECT_EQ(a.outcome.iterations, other->outcome.iterations);
        EXPECT_EQ(a.curvature, other->curvature);
    }
}

TEST(Precision, ExtendedFromTheStartReachesTheSameMetric) {
    const Hard hard;
    const FlowResult a = solve(hard.mesh, hard.target),
                     b = solve(hard.mesh, hard.target, Precision::extended);
    ASSERT_EQ(b.outcome.status, Status::converged);
    EXPECT_GT(b.precision_digits, 16);
    EXPECT_LE(check_flow(hard.mesh, b, hard.target).residual_max, 1.1e-10);
    // The energy is convex, its smallest eigenvalue about that of a Laplacian on 1,000 vertices: 1e-10 over
    // 1e-4.
    for (std::size_t v = 0; v < a.conformal_factor.size(); ++v)
        EXPECT_NEAR(a.conformal_factor[v], b.conformal_factor[v], 1e-6);
}

TEST(Precision, StepsRunOutForAllLevelsTogether) {
    const Hard hard;
    FlowOptions options;
    options.geometry = Geometry::euclidean;
    options.target = TargetKind::values;
    options.target_values = hard.target;
    options.parallel = false;
    for (const Precision precision : {Precision::automatic, Precision::extended}) {
        options.precision = precision;
        options.max_iterations = 0;
        const std::int32_t needed = solve_flow(hard.mesh, options).outcome.iterations;
        for (const std::int32_t allowed : {1, needed / 2, needed - 1, needed}) {
            options.max_iterations = allowed;
            const SolveOutcome outcome = solve_flow(hard.mesh, options).outcome;
            EXPECT_LE(outcome.iterations, allowed);
            EXPECT_EQ(outcome.status, allowed < needed ? Status::max_iterations : Status::converged)
                << allowed << " of " << needed << ", " << name_of(precision);
        }
    }
}

TEST(Precision, WhoeverIsToldToStopSaysSo) {
    // In 50 digits, from a level that gains nothing too.
    const SurfaceMesh mesh = surface("sphere", 1000);
    const std::vector<double> hard = random_target(mesh, TargetDraw::random, 3);
    for (const double tolerance : {1e-10, 1e-22}) {
        FlowOptions options;
        options.geometry = Geometry::euclidean;
        options.target = TargetKind::values;
        options.target_values = hard;
        options.tolerance = tolerance;
        options.parallel = false;
        int asked = 0;
        options.interrupted = [&]() -> std::optional<Status> {
            ++asked;
            return std::nullopt;
        };
        solve_flow(mesh, options);
        const int calls = asked;
        ASSERT_GT(calls, 10);
        for (int at = 1; at <= calls; at += 1 + calls / 40) {
            asked = 0;
            options.interrupted = [&]() -> std::optional<Status> {
                return ++asked >= at ? std::optional(Status::cancelled) : std::nullopt;
            };
            EXPECT_EQ(solve_flow(mesh, options).outcome.status, Status::cancelled)
                << "call " << at << " of " << calls << ", " << tolerance;
            EXPECT_EQ(asked, at) << "nothing more is begun";
        }
    }
}

TEST(Precision, NothingChangesWhereDoubleSuffices) {
    for (const std::string name : {"torus", "eight", "pants", "punctured-torus"}) {
        const SurfaceMesh mesh = surface(name, 1200);
        FlowOptions options;
        options.parallel = false;
        const FlowResult automatic = solve_flow(mesh, options);
        options.precision = Precision::plain;
        const FlowResult plain = solve_flow(mesh, options);
        EXPECT_EQ(automatic.outcome.status, Status::converged) << name;
        EXPECT_EQ(automatic.precision_digits, 16) << name;
        EXPECT_EQ(automatic.conformal_factor, plain.conformal_factor) << name;
        EXPECT_EQ(automatic.outcome.residual_max, plain.outcome.residual_max) << name;
        options.precision = Precision::extended;
        const FlowResult extended = solve_flow(mesh, options);
        EXPECT_EQ(extended.outcome.status, Status::converged) << name;
        EXPECT_EQ(extended.precision_digits, 19) << name;
        EXPECT_TRUE(extended.conformal_factor_low.empty()) << name << ": a double holds it";
        for (std::size_t v = 0; v < plain.conformal_factor.size(); ++v)
            EXPECT_NEAR(extended.conformal_factor[v], plain.conformal_factor[v], 1e-6) << name;
    }
}

TEST(Precision, TheLevelsAgreeOnOneMetric) {
    const SurfaceMesh mesh = surface("pants", 800);
    const FlowSurface doubled = make_flow_surface(mesh, true, true);
    testing::Random random(6);
    const std::vector<double> u = random.uniforms(at(doubled.vertex_count()), -0.8, 0.8);
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic}) {
        std::vector<std::unique_ptr<Metric>> metrics;
        for (const int digits : {16, 19, 50}) {
            metrics.push_back(make_scaled_metric(mesh, doubled, geometry, false, digits));
            EXPECT_EQ(metrics.back()->digits(), digits);
            ASSERT_TRUE(metrics.back()->move_to(u));
            ASSERT_TRUE(metrics.back()->evaluate(true));
        }
        EXPECT_GT(metrics[0]->rounding_floor(), 1000.0 * metrics[1]->rounding_floor());
        EXPECT_GT(metrics[1]->rounding_floor(), 1000.0 * metrics[2]->rounding_floor());
        for (const Index v : {0, 50, 200}) {
            const double k = metrics[2]->curvature()[at(v)];
            EXPECT_NEAR(metrics[0]->curvature()[at(v)], k, metrics[0]->rounding_floor() + 1e-13);
            EXPECT_NEAR(metrics[1]->curvature()[at(v)], k, 1e-15 * (1.0 + std::abs(k)));
        }
        EXPECT_EQ(metrics[0]->flips(), metrics[2]->flips());
        EXPECT_NEAR(metrics[0]->area() / metrics[2]->area(), 1.0, 1e-12);
    }
}

TEST(Precision, SumsOfTwoDoublesKeepWhatIsAdded) {
    double high = 1.0, low = 0.0;
    for (int k = 0; k < 1000; ++k) add_to(0x1p-70, high, low);
    EXPECT_EQ(high, 1.0);
    EXPECT_EQ(low, 1000.0 * 0x1p-70);
    add_to(-1.0, high, low);
    EXPECT_EQ(high, 1000.0 * 0x1p-70);
    EXPECT_EQ(low, 0.0);
    add_to(1e20, high, low);
    EXPECT_EQ(high, 1e20);
    EXPECT_EQ(low, 1000.0 * 0x1p-70);
}

TEST(Precision, SweepsSayHowFarRowsAreToBeTrusted) {
    const SurfaceMesh mesh = surface("eight", 1200);
    for (const SweepSolverKind solver : {SweepSolverKind::lanes, SweepSolverKind::newton}) {
        SweepOptions options;
        options.solver = solver;
        SweepWorker worker(std::make_shared<SweepSurface>(mesh, options));
        std::vector<Index> vertices = {3, 100, 321};
        std::vector<SweepSolve> solved;
        worker.run({[&]() -> std::optional<Index> {
                        if (vertices.empty()) return std::nullopt;
                        const Index v = vertices.back();
                        vertices.pop_back();
                        return v;
                    },
                    [&](SweepSolve s) { solved.push_back(std::move(s)); },
                    {}});
        ASSERT_EQ(solved.size(), 3U);
        for (const SweepSolve& s : solved) {
            ASSERT_EQ(s.status, Status::converged);
            EXPECT_EQ(s.precision_digits, 16);
            std::vector<double> target(s.conformal_factor.size(), 0.0);
            target[at(s.vertex)] = -4.0 * std::numbers::pi;
            const Recomputed again =
                recompute_scaling(mesh, s.conformal_factor, Geometry::euclidean, Boundary::geodesic, true);
            double residual = 0.0;
            for (std::size_t v = 0; v < target.size(); ++v)
                residual = std::max(residual, std::abs(again.curvature[v] - target[v]));
            EXPECT_NEAR(residual, s.residual_max, 1e-11) << name_of(solver);
            // One rounding of some units per vertex.
            EXPECT_LT(s.gauss_bonnet_error, 1e-11) << name_of(solver);
            EXPECT_LT(again.gauss_bonnet_error, 1e-12) << name_of(solver);
        }
    }
    SweepOptions extended;
    extended.precision = Precision::extended;
    const SweepSurface no_lanes(mesh, extended);
    EXPECT_EQ(no_lanes.lanes(), 0);
}

}  // namespace
}  // namespace ricci
