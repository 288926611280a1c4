// Newton and gradient descent on manufactured targets, without the convenience layer around them.
#include "engine/flow/newton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/dense_metric.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::at;
using testing::Random;
constexpr std::array kGeometries = {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical};

SurfaceMesh scaled(SurfaceMesh mesh, double size) {
    for (Point& p : mesh.points)
        for (double& x : p) x *= size;
    for (double& l : mesh.edge_length) l *= size;
    return mesh;
}

/// All vertices prescribed, but for those marked in `fixed`.
CurvatureTarget target_of(std::vector<double> curvature, Geometry geometry,
                          const std::vector<std::uint8_t>& fixed = {}) {
    CurvatureTarget target;
    target.unknown.assign(curvature.size(), -1);
    bool any = false;
    for (std::size_t v = 0; v < curvature.size(); ++v) {
        if (!fixed.empty() && fixed[v]) {
            any = true;
            continue;
        }
        target.unknown[v] = target.unknown_count++;
    }
    target.curvature = std::move(curvature);
    target.scale_free = geometry == Geometry::euclidean && !any;
    return target;
}

SolveOptions options_for(Geometry geometry, Scheme scheme) {
    SolveOptions options;
    options.tolerance = 1e-11;
    options.convex = geometry != Geometry::spherical && scheme != Scheme::virtual_radius;
    return options;
}

Definiteness definiteness_of(Geometry geometry) {
    return geometry == Geometry::spherical ? Definiteness::indefinite : Definiteness::positive;
}

/// Subtracts the mean where a constant is free.
void settle(std::vector<double>& u, bool scale_free) {
    if (!scale_free) return;
    const double mean = std::accumulate(u.begin(), u.end(), 0.0) / static_cast<double>(u.size());
    for (double& x : u) x -= mean;
}

void expect_gauss_bonnet(const Metric& metric, Geometry geometry, const std::string& what) {
    const auto curvature = metric.curvature();
    const double total =
        std::accumulate(curvature.begin(), curvature.end(), 0.0) + curvature_sign(geometry) * metric.area();
    // Every angle to a few eps pi: some 100 vertices.
    EXPECT_NEAR(total, 2 * pi * metric.surface().topology.euler_characteristic, 1e-12) << what;
}

/// Flows from `start` to K(goal) and expects `goal`.
void expect_recovers(Metric& metric, Geometry geometry, Scheme scheme, std::vector<double> goal,
                     std::vector<double> start, const std::vector<std::uint8_t>& fixed,
                     const std::string& what) {
    const std::vector<double> curvature = testing::curvature_at(metric, goal);
    ASSERT_FALSE(curvature.empty()) << what << ": the goal is broken";
    expect_gauss_bonnet(metric, geometry, what);
    const CurvatureTarget target = target_of(curvature, geometry, fixed);
    NewtonSolver solver(metric.surface(), target, definiteness_of(geometry), false);
    const SolveOutcome outcome = solver.solve(metric, target, options_for(geometry, scheme), start);
    ASSERT_EQ(outcome.status, Status::converged) << what << ": " << outcome.residual_max;
    expect_gauss_bonnet(metric, geometry, what);
    settle(goal, target.scale_free);
    settle(start, target.scale_free);
    // Residual 1e-11 over the smallest eigenvalue, about 0.1.
    for (std::size_t v = 0; v < goal.size(); ++v)
        ASSERT_NEAR(start[v], goal[v], 1e-9) << what << ", vertex " << v;
}

TEST(Newton, RecoversManufacturedPackingsInEveryGeometry) {
    Random random(1);
    for (const Geometry geometry : kGeometries)
        for (const Scheme scheme :
             {Scheme::inversive_distance, Scheme::thurston, Scheme::tangential, Scheme::virtual_radius})
            for (const bool closed : {true, false})
                for (const bool free : {false, true}) {
                    if (closed && free) continue;
                    // The doubled noise keeps inversive distances generic; the square has obtuse ones
                    // nowhere.
                    const SurfaceMesh mesh = closed ? scaled(testing::bumpy_torus(8, 6), 0.1)
                                                    : scaled(testing::wavy_square(5, 0.1), 0.6);
                    const FlowSurface surface = make_flow_surface(mesh, false, false);
                    const CirclePacking packing =
                        initial_circle_packing(mesh.connectivity, mesh.edge_length, geometry, scheme);
                    PackedMetric metric(surface, packing, geometry, false);
                    const double size = scheme == Scheme::virtual_radius ? 0.01 : 0.04;
                    std::vector<double> goal = packing.u;
                    for (std::size_t v = 0; v < goal.size(); ++v)
                        if (!(free && surface.boundary[v])) goal[v] += random.uniform(-size, size);
                    expect_recovers(metric, geometry, scheme, goal, packing.u,
                                    free ? surface.boundary : std::vector<std::uint8_t>{},
                                    std::string(name_of(geometry)) + " " + std::string(name_of(scheme)) +
                                        (closed ? " closed" : (free ? " free" : " curvature")));
                }
}

TEST(Newton, RecoversManufacturedScalingFarAway) {
    Random random(2);
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic})
        for (int trial = 0; trial < 5; ++trial) {
            const SurfaceMesh mesh = testing::bumpy_torus(9, 7);
            const FlowSurface surface = make_flow_surface(mesh, false, true);
            ScaledMetric<double> metric(surface, geometry, false);
            const std::vector<double> goal = random.uniforms(63, -1.5, 1.5);
            const std::vector<double> curvature = testing::curvature_at(metric, goal);
            metric.reset(rounded(surface.triangulation));
            const CurvatureTarget target = target_of(curvature, geometry);
            NewtonSolver solver(surface, target, Definiteness::positive, false);
            std::vector<double> u(63, 0.0);
            const SolveOutcome outcome =
                solver.solve(metric, target, options_for(geometry, Scheme::vertex_scaling), u);
            ASSERT_EQ(outcome.status, Status::converged);
            EXPECT_GT(outcome.flips, 0);
            std::vector<double> expected = goal;
            settle(expected, target.scale_free);
            settle(u, target.scale_free);
            for (std::size_t v = 0; v < 63; ++v) ASSERT_NEAR(u[v], expected[v], 1e-9);
        }
}

TEST(Newton, LogIsCompleteAndDecreasing) {
    Random random(3);
    const SurfaceMesh mesh = testing::bumpy_torus(9, 7);
    const FlowSurface surface = make_flow_surface(mesh, false, true);
    ScaledMetric<double> metric(surface, Geometry::euclidean, false);
    const CurvatureTarget target = target_of(std::vector<double>(63, 0.0), Geometry::euclidean);
    NewtonSolver solver(surface, target, Definiteness::positive, false);
    std::vector<double> u(63, 0.0);
    std::vector<double> told;
    SolveOptions options;
    options.progress = [&](const IterationLog& line) { told.push_back(line.residual_max); };
    const SolveOutcome outcome = solver.solve(metric, target, options, u);
    ASSERT_EQ(outcome.status, Status::converged);
    ASSERT_EQ(outcome.log.size(), static_cast<std::size_t>(outcome.iterations) + 1);
    EXPECT_EQ(told.size(), outcome.log.size());
    EXPECT_EQ(outcome.log.back().residual_max, outcome.residual_max);
    EXPECT_EQ(outcome.log.back().flips, outcome.flips);
    EXPECT_EQ(residual_max(metric.curvature(), target), outcome.residual_max);
    for (std::size_t k = 1; k < outcome.log.size(); ++k) {
        EXPECT_LT(outcome.log[k].residual_max, outcome.log[k - 1].residual_max);
        EXPECT_GE(outcome.log[k].seconds, outcome.log[k - 1].seconds);
        EXPECT_EQ(outcome.log[k].iteration, static_cast<std::int32_t>(k));
        EXPECT_GT(outcome.log[k].step, 0.0);
    }
    // Newton's last steps square the residual, but for a factor; solved by the last factor and conjugate
    // gradients (to a relative 1e-2 at worst, or to a tenth of the tolerance) they still gain two digits
    // each.
    const double last = outcome.log.back().residual_max,
                 before = outcome.log[outcome.log.size() - 2].residual_max;
    EXPECT_LT(last, std::max(100 * before * before, 0.1 * options.tolerance));
}

TEST(Newton, StopsWhereItIsTold) {
    const SurfaceMesh mesh = testing::bumpy_torus(9, 7);
    const FlowSurface surface = make_flow_surface(mesh, false, true);
    const CurvatureTarget target = target_of(std::vector<double>(63, 0.0), Geometry::euclidean);
    for (const bool newton : {true, false}) {
        const auto run = [&](const SolveOptions& options) {
            ScaledMetric<double> metric(surface, Geometry::euclidean, false);
            std::vector<double> u(63, 0.0);
            SolveOutcome outcome;
            if (newton) {
                NewtonSolver solver(surface, target, Definiteness::positive, false);
                outcome = solver.solve(metric, target, options, u);
            } else {
                outcome = gradient_descent(metric, target, options, u);
            }
            // The metric stands at u, and the outcome speaks of it.
            EXPECT_EQ(residual_max(metric.curvature(), target), outcome.residual_max);
            const auto there = testing::curvature_at(metric, u);
            EXPECT_NEAR(residual_max(there, target), outcome.residual_max, 1e-12);
            return outcome;
        };
        SolveOptions options;
        options.max_iterations = 2;
        SolveOutcome outcome = run(options);
        EXPECT_EQ(outcome.status, Status::max_iterations);
        EXPECT_EQ(outcome.iterations, 2);
        int asked = 0;
        options.max_iterations = 200;
        options.interrupted = [&]() -> std::optional<Status> {
            return ++asked > 3 ? std::optional(Status::timeout) : std::nullopt;
        };
        outcome = run(options);
        EXPECT_EQ(outcome.status, Status::timeout);
        EXPECT_EQ(outcome.iterations, 3);
        options.interrupted = []() -> std::optional<Status> { return Status::cancelled; };
        outcome = run(options);
        EXPECT_EQ(outcome.status, Status::cancelled);
        EXPECT_EQ(outcome.iterations, 0);
        options = {};
        options.tolerance = 1e-30;  // below the rounding floor
        if (newton) {
            EXPECT_EQ(run(options).status, Status::stalled);
        }
    }
}

TEST(Newton, AWrongStartIsReportedNotThrown) {
    const SurfaceMesh mesh = testing::icosahedron();
    const FlowSurface surface = make_flow_surface(mesh, false, true);
    const CurvatureTarget target = target_of(std::vector<double>(12, 0.1), Geometry::spherical);
    NewtonSolver solver(surface, target, Definiteness::indefinite, false);
    ScaledMetric<double> metric(surface, Geometry::spherical, false);
    std::vector<double> u(12, 1.0);  // chords of 2 e > 2: no spherical edge
    EXPECT_EQ(solver.solve(metric, target, {}, u).status, Status::inadmissible_metric);
    u.assign(12, std::nan(""));
    const Status status = solver.solve(metric, target, {}, u).status;
    EXPECT_TRUE(status == Status::not_finite || status == Status::inadmissible_metric) << name_of(status);
}

TEST(GradientDescent, AgreesWithNewton) {
    const SurfaceMesh mesh = testing::bumpy_torus(6, 5);
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic}) {
        Random random(4);
        const FlowSurface surface = make_flow_surface(mesh, false, true);
        ScaledMetric<double> metric(surface, geometry, false);
        const std::vector<double> curvature = testing::curvature_at(metric, random.uniforms(30, -0.4, 0.4));
        const CurvatureTarget target = target_of(curvature, geometry);
        SolveOptions options;
        options.tolerance = 1e-10;
        options.max_iterations = 100000;
        std::vector<double> by_newton(30, 0.0), by_descent(30, 0.0);
        metric.reset(rounded(surface.triangulation));
        NewtonSolver solver(surface, target, Definiteness::positive, false);
        ASSERT_EQ(solver.solve(metric, target, options, by_newton).status, Status::converged);
        ScaledMetric<double> other(surface, geometry, false);
        const SolveOutcome descent = gradient_descent(other, target, options, by_descent);
        ASSERT_EQ(descent.status, Status::converged);
        EXPECT_GT(descent.iterations, 10);
        settle(by_newton, target.scale_free);
        settle(by_descent, target.scale_free);
        // Residuals of 1e-10 over the smallest eigenvalue (above 0.05).
        for (std::size_t v = 0; v < 30; ++v) EXPECT_NEAR(by_newton[v], by_descent[v], 4e-9);
        // Descent lowers the energy, not always the largest residual; over ten steps it must fall.
        for (std::size_t k = 10; k < descent.log.size(); ++k)
            EXPECT_LT(descent.log[k].residual_max, descent.log[k - 10].residual_max);
    }
}

TEST(GradientDescent, AgreesWithNewtonForAPacking) {
    const SurfaceMesh mesh = testing::bumpy_torus(6, 5);
    const FlowSurface surface = make_flow_surface(mesh, false, false);
    const CirclePacking packing =
        initial_circle_packing(mesh.connectivity, mesh.edge_length, Geometry::euclidean, Scheme::tangential);
    PackedMetric metric(surface, packing, Geometry::euclidean, false);
    const CurvatureTarget target = target_of(std::vector<double>(30, 0.0), Geometry::euclidean);
    SolveOptions options;
    options.max_iterations = 100000;
    std::vector<double> by_newton = packing.u, by_descent = packing.u;
    NewtonSolver solver(surface, target, Definiteness::positive, false);
    ASSERT_EQ(solver.solve(metric, target, options, by_newton).status, Status::converged);
    ASSERT_EQ(gradient_descent(metric, target, options, by_descent).status, Status::converged);
    settle(by_newton, true);
    settle(by_descent, true);
    for (std::size_t v = 0; v < 30; ++v) EXPECT_NEAR(by_newton[v], by_descent[v], 4e-9);
}

TEST(Newton, SolvesDoNotRememberOneAnother) {
    Random random(5);
    const SurfaceMesh mesh = testing::bumpy_torus(9, 7);
    const FlowSurface surface = make_flow_surface(mesh, false, true);
    const auto start = rounded(surface.triangulation);
    ScaledMetric<double> metric(surface, Geometry::euclidean, false);
    CurvatureTarget target = target_of(std::vector<double>(63, 0.0), Geometry::euclidean);
    NewtonSolver solver(surface, target, Definiteness::positive, true);
    solver.prepare_first_factor(metric, std::vector<double>(63, 0.0));
    const auto solve = [&](Index plus) {
        target.curvature.assign(63, 0.0);
        target.curvature[at(plus)] = 1.5;
        target.curvature[at((plus + 30) % 63)] = -1.5;
        metric.reset(start);
        std::vector<double> u(63, 0.0);
        const SolveOutcome outcome = solver.solve(metric, target, {}, u);
        EXPECT_EQ(outcome.status, Status::converged);
        return u;
    };
    const auto alone = solve(7);
    int others = 0;
    for (int k = 0; k < 20; ++k) {
        others += solve(random.below(Index{63})) != alone ? 1 : 0;
        EXPECT_EQ(solve(7), alone);
    }
    EXPECT_GT(others, 10);
}

}  // namespace
}  // namespace ricci
