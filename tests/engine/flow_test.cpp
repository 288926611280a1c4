// Whole solves: manufactured targets, boundaries, uniformization, and surfaces whose metric is known in
// closed form.
#include "engine/flow/flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/surfaces/generate.h"
#include "tests/support/dense_metric.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::at;
using testing::Random;

SurfaceMesh scaled(SurfaceMesh mesh, double size) {
    for (Point& p : mesh.points)
        for (double& x : p) x *= size;
    for (double& l : mesh.edge_length) l *= size;
    return mesh;
}

SurfaceMesh made(const std::string& name, Index faces, double jitter = 0.0, Index genus = 2) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    options.genus = genus;
    return generate(name, options);
}

void expect_converged(const FlowResult& result, const std::string& what) {
    ASSERT_EQ(result.outcome.status, Status::converged) << what << ": " << result.message;
    EXPECT_LE(result.outcome.residual_max, 1e-10) << what;
    // Every angle to a few eps pi; at most some 10^4 corners, their errors adding like a random walk.
    EXPECT_LT(result.gauss_bonnet_error, 1e-11) << what;
    EXPECT_STREQ(check_connectivity(result.triangulation), "") << what;
    for (std::size_t v = 0; v < result.curvature.size(); ++v)
        ASSERT_NEAR(result.curvature[v], result.target_curvature[v], 1e-10) << what << ", vertex " << v;
}

/// Flows to K(u0) of random u0 and expects u0.
void expect_recovers(const SurfaceMesh& mesh, Geometry geometry, Boundary boundary, double spread,
                     Random& random) {
    const std::string what = std::string(name_of(geometry)) + ", " + std::string(name_of(boundary));
    const FlowSurface surface = make_flow_surface(mesh, boundary != Boundary::free, true);
    ScaledMetric<double> metric(surface, geometry, false);
    std::vector<double> goal = random.uniforms(at(surface.vertex_count()), -spread, spread);
    const bool has_boundary = surface.topology.boundaries > 0;
    for (std::size_t v = 0; v < goal.size(); ++v)
        if (boundary == Boundary::free && surface.boundary[v]) goal[v] = 0.0;
    FlowOptions options;
    options.geometry = geometry;
    options.boundary = boundary;
    options.target = TargetKind::values;
    options.target_values = testing::curvature_at(metric, goal);
    ASSERT_FALSE(options.target_values.empty()) << what;
    const FlowResult result = solve_flow(mesh, options);
    expect_converged(result, what);
    EXPECT_EQ(result.doubled, has_boundary && boundary != Boundary::free);
    double mean = 0.0;
    if (geometry == Geometry::euclidean && !(has_boundary && boundary == Boundary::free))
        mean = std::accumulate(goal.begin(), goal.end(), 0.0) / static_cast<double>(goal.size());
    // Residual 1e-10 over the smallest eigenvalue, above 0.1 on these few dozen vertices.
    for (std::size_t v = 0; v < goal.size(); ++v)
        ASSERT_NEAR(result.conformal_factor[v], goal[v] - mean, 1e-9) << what << ", vertex " << v;
}

TEST(Flow, RecoversManufacturedMetrics) {
    Random random(1);
    for (int trial = 0; trial < 3; ++trial) {
        for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic}) {
            expect_recovers(testing::bumpy_torus(7, 6), geometry, Boundary::geodesic, 1.0, random);
            expect_recovers(made("eight", 300, 0.2), geometry, Boundary::geodesic, 0.5, random);
            expect_recovers(testing::wavy_square(6, 0.2), geometry, Boundary::curvature, 0.7, random);
            expect_recovers(testing::wavy_square(6, 0.2), geometry, Boundary::free, 0.5, random);
            expect_recovers(made("annulus-planar", 100, 0.2), geometry, Boundary::curvature, 0.5, random);
        }
        // Not convex: from nearby only.
        expect_recovers(scaled(testing::bumpy_torus(7, 6), 0.1), Geometry::spherical, Boundary::geodesic,
                        0.03, random);
        expect_recovers(scaled(testing::wavy_square(6, 0.1), 0.5), Geometry::spherical, Boundary::curvature,
                        0.03, random);
        expect_recovers(scaled(testing::wavy_square(6, 0.1), 0.5), Geometry::spherical, Boundary::free, 0.03,
                        random);
    }
}

TEST(Flow, RecoversManufacturedPackings) {
    // In the plane the packing does not depend on the target, so that K(u0) can be made beforehand.
    Random random(2);
    for (const Scheme scheme :
         {Scheme::inversive_distance, Scheme::thurston, Scheme::tangential, Scheme::virtual_radius})
        for (const bool closed : {true, false})
            for (const Boundary boundary : {Boundary::curvature, Boundary::free}) {
                const SurfaceMesh mesh = closed ? testing::bumpy_torus(7, 6) : testing::wavy_square(6, 0.1);
                const FlowSurface surface = make_flow_surface(mesh, false, false);
                const CirclePacking packing =
                    initial_circle_packing(mesh.connectivity, mesh.edge_length, Geometry::euclidean, scheme);
                PackedMetric metric(surface, packing, Geometry::euclidean, false);
                std::vector<double> goal = packing.u;
                for (std::size_t v = 0; v < goal.size(); ++v)
                    if (boundary != Boundary::free || !surface.boundary[v])
                        goal[v] += random.uniform(-0.02, 0.02);
                FlowOptions options;
                options.geometry = Geometry::euclidean;
                options.scheme = scheme;
                options.boundary = boundary;
                options.target = TargetKind::values;
                options.target_values = testing::curvature_at(metric, goal);
                ASSERT_FALSE(options.target_values.empty());
                const FlowResult result = solve_flow(mesh, options);
                expect_converged(result, std::string(name_of(scheme)));
                double shift = 0.0;
                if (closed || boundary == Boundary::curvature)
                    for (std::size_t v = 0; v < goal.size(); ++v)
                        shift += (result.conformal_factor[v] - goal[v]) / static_cast<double>(goal.size());
                for (std::size_t v = 0; v < goal.size(); ++v)
                    EXPECT_NEAR(result.conformal_factor[v], goal[v] + shift, 2e-9) << name_of(scheme);
            }
}

TEST(Flow, AnnulusBecomesAFlatCylinderWithItsModulus) {
    // Similar triangles of a plane annulus unroll to a cylinder whose rows are all alike: u is constant along
    // circles and linear across, -log r. The target: flat inside, straight boundaries.
    GenerateOptions annulus;
    annulus.faces = 400;
    const SurfaceMesh mesh = generate("annulus-planar", annulus);
    FlowOptions options;
    options.target = TargetKind::boundary;  // 2 pi chi / B = 0
    const FlowResult result = solve_flow(mesh, options);
    EXPECT_EQ(result.boundary, Boundary::curvature);
    expect_converged(result, "annulus");
    double mean = 0.0;
    for (const Point& p : mesh.points)
        mean -= std::log(std::hypot(p[0], p[1])) / static_cast<double>(mesh.points.size());
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        EXPECT_NEAR(result.conformal_factor[v],
                    -std::log(std::hypot(mesh.points[v][0], mesh.points[v][1])) - mean, 1e-9);
    // Geodesic boundaries say the same.
    options.target = TargetKind::flat;
    options.geometry = Geometry::euclidean;
    options.boundary = Boundary::geodesic;
    const FlowResult geodesic = solve_flow(mesh, options);
    expect_converged(geodesic, "annulus, geodesic");
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        EXPECT_NEAR(geodesic.conformal_factor[v], result.conformal_factor[v], 1e-9);
}

TEST(Flow, DiskWithBoundaryTargetIsSymmetricUnderTurnsOfSixty) {
    const SurfaceMesh mesh = made("disk", 600);
    FlowOptions options;
    options.target = TargetKind::boundary;
    const FlowResult result = solve_flow(mesh, options);
    expect_converged(result, "disk");
    const auto boundary = boundary_vertices(mesh.connectivity);
    const auto count = static_cast<double>(std::count(boundary.begin(), boundary.end(), std::uint8_t{1}));
    for (std::size_t v = 0; v < boundary.size(); ++v)
        EXPECT_NEAR(result.curvature[v], boundary[v] ? 2 * pi / count : 0.0, 1e-10);
    // Ring k holds 6k vertices, six sectors of k: vertex 1 + 3k(k-1) + i.
    for (Index k = 1, first = 1; first + 6 * k <= mesh.connectivity.vertex_count; first += 6 * k, ++k)
        for (Index i = 0; i < 6 * k; ++i)
            EXPECT_NEAR(result.conformal_factor[at(first + i)],
                        result.conformal_factor[at(first + (i + k) % (6 * k))], 1e-9);
}

TEST(Flow, FreeBoundaryKeepsItsLengths) {
    const SurfaceMesh mesh = testing::wavy_square(8, 0.2);
    FlowOptions options;
    options.geometry = Geometry::euclidean;
    options.boundary = Boundary::free;
    const FlowResult result = solve_flow(mesh, options);
    expect_converged(result, "free");
    for (std::size_t h = 0; h < result.edge_length.size(); ++h) {
        if (result.triangulation.twin[h] != kNoTwin) continue;
        const auto i = result.triangulation.tail[h], j = result.triangulation.head(static_cast<Index>(h));
        const Point &p = mesh.points[at(i)], &q = mesh.points[at(j)];
        EXPECT_NEAR(result.edge_length[h], std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), 1e-14);
    }
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        if (boundary_vertices(mesh.connectivity)[v]) {
            EXPECT_EQ(result.conformal_factor[v], 0.0);
        }
}

TEST(Flow, GeodesicDoubleOfPantsAgreesWithTheClosedEight) {
    // pants is the upper half of eight, whose mirror symmetry the uniformization must have.
    const SurfaceMesh pants = made("pants", 800), eight = made("eight", 1600);
    ASSERT_EQ(2 * pants.connectivity.face_count(), eight.connectivity.face_count());
    FlowOptions options;
    options.geometry = Geometry::hyperbolic;
    const FlowResult half = solve_flow(pants, options), whole = solve_flow(eight, options);
    expect_converged(half, "pants");
    expect_converged(whole, "eight");
    EXPECT_TRUE(half.doubled);
    EXPECT_NEAR(half.area, 2 * pi, 1e-8);  // -2 pi chi, off by the sum of the curvatures
    EXPECT_NEAR(whole.area, 4 * pi, 1e-8);
    std::map<Point, double> factor;
    for (std::size_t v = 0; v < eight.points.size(); ++v) factor[eight.points[v]] = whole.conformal_factor[v];
    std::size_t found = 0;
    for (std::size_t v = 0; v < pants.points.size(); ++v) {
        const auto match = factor.find(pants.points[v]);
        if (match == factor.end()) continue;
        ++found;
        EXPECT_NEAR(half.conformal_factor[v], match->second, 1e-8);
    }
    EXPECT_EQ(found, pants.points.size());
}

TEST(Flow, UniformizesGenusTwoAndThree) {
    for (const Index genus : {2, 3}) {
        const SurfaceMesh mesh = made("genus-g", 2000, 0.2, genus);
        const FlowResult result = solve_flow(mesh, {});
        EXPECT_EQ(result.geometry, Geometry::hyperbolic);
        expect_converged(result, "genus");
        EXPECT_NEAR(result.area, 4 * pi * (genus - 1), 1e-7);
        EXPECT_LE(result.outcome.iterations, 12);
    }
}

/// All vertices alike: equilateral hyperbolic triangles with the angle 2 pi / valence.
void expect_equilateral(const std::string& name, int valence) {
    const SurfaceMesh mesh = made(name, 10);
    const FlowResult result = solve_flow(mesh, {});
    EXPECT_EQ(result.geometry, Geometry::hyperbolic);
    expect_converged(result, name);
    const double angle = 2 * pi / valence;
    const double length = std::acosh(std::cos(angle) / (1 - std::cos(angle)));
    for (const double l : result.edge_length) EXPECT_NEAR(l, length, 1e-10) << name;
    for (const double u : result.conformal_factor) EXPECT_NEAR(u, result.conformal_factor[0], 1e-10) << name;
    // And so it is for every finer one: at the old vertices and, by symmetry, at all midpoints.
    const SurfaceMesh fine = made(name, 4 * mesh.connectivity.face_count());
    const FlowResult finer = solve_flow(fine, {});
    expect_converged(finer, name + ", finer");
    const Index old = mesh.connectivity.vertex_count;
    for (Index v = 0; v < fine.connectivity.vertex_count; ++v)
        EXPECT_NEAR(finer.conformal_factor[at(v)], finer.conformal_factor[at(v < old ? 0 : old)], 1e-10);
    EXPECT_GT(std::abs(finer.conformal_factor[0] - finer.conformal_factor[at(old)]), 0.01);
}

TEST(Flow, KleinQuarticIsMadeOfEquilateralTriangles) {
    expect_equilateral("klein-quartic", 7);
}
TEST(Flow, BolzaIsMadeOfEquilateralTriangles) {
    expect_equilateral("bolza", 8);
}

TEST(Flow, UniformTargetOnASphere) {
    const SurfaceMesh mesh = made("ellipsoid", 500, 0.2);
    FlowOptions options;
    options.target = TargetKind::uniform;
    const FlowResult result = solve_flow(mesh, options);
    EXPECT_EQ(result.geometry, Geometry::euclidean);
    expect_converged(result, "uniform");
    for (const double k : result.curvature) EXPECT_NEAR(k, 4 * pi / mesh.connectivity.vertex_count, 1e-10);
}

TEST(Flow, ConesAnywhereOnGenusTwo) {
    const SurfaceMesh mesh = made("eight", 1500, 0.3);
    FlowOptions options;
    for (const Index v : {0, 100, 333}) {
        options.cones = {{v, -4 * pi}};
        const FlowResult result = solve_flow(mesh, options);
        EXPECT_EQ(result.geometry, Geometry::euclidean);
        expect_converged(result, "cone");
        EXPECT_GT(result.outcome.flips, 0);
        EXPECT_NEAR(std::accumulate(result.conformal_factor.begin(), result.conformal_factor.end(), 0.0), 0.0,
                    1e-8);
    }
}

TEST(Flow, GradientMethodAgreesWithNewton) {
    FlowOptions options;
    options.geometry = Geometry::euclidean;
    const SurfaceMesh mesh = testing::bumpy_torus(7, 6);
    const FlowResult newton = solve_flow(mesh, options);
    options.method = Method::gradient;
    const FlowResult gradient = solve_flow(mesh, options);
    expect_converged(newton, "newton");
    expect_converged(gradient, "gradient");
    EXPECT_GT(gradient.outcome.iterations, newton.outcome.iterations);
    for (std::size_t v = 0; v < 42; ++v)
        EXPECT_NEAR(newton.conformal_factor[v], gradient.conformal_factor[v], 4e-9);
}

TEST(Flow, InadmissibleTargetsAreAStatusWithAReason) {
    const SurfaceMesh mesh = testing::bumpy_torus(5, 5);
    for (const Scheme scheme : {Scheme::vertex_scaling, Scheme::tangential}) {
        FlowOptions options;
        options.scheme = scheme;
        options.cones = {{3, 1.0}};
        FlowResult result = solve_flow(mesh, options);
        EXPECT_EQ(result.outcome.status, Status::inadmissible_target);
        EXPECT_NE(result.message.find("Gauss-Bonnet"), std::string::npos) << result.message;
        EXPECT_EQ(result.curvature.size(), 25U);
        EXPECT_GT(result.outcome.residual_max, 0.1);
        options.cones = {{3, 2 * pi}, {4, -2 * pi}};
        result = solve_flow(mesh, options);
        EXPECT_EQ(result.outcome.status, Status::inadmissible_target);
        EXPECT_NE(result.message.find("vertex 3"), std::string::npos) << result.message;
        options.geometry = Geometry::hyperbolic;
        options.cones.clear();
        EXPECT_EQ(solve_flow(mesh, options).outcome.status, Status::inadmissible_target)
            << "a flat torus is not hyperbolic";
    }
    FlowOptions options;
    options.cones = {{25, 0.0}};
    EXPECT_THROW(solve_flow(mesh, options), std::invalid_argument);
}

TEST(Flow, StopsWhereItIsTold) {
    const SurfaceMesh mesh = made("eight", 600);
    FlowOptions options;
    options.max_iterations = 1;
    EXPECT_EQ(solve_flow(mesh, options).outcome.status, Status::max_iterations);
    options.max_iterations = 0;
    options.interrupted = []() -> std::optional<Status> { return Status::cancelled; };
    const FlowResult cancelled = solve_flow(mesh, options);
    EXPECT_EQ(cancelled.outcome.status, Status::cancelled);
    EXPECT_EQ(cancelled.conformal_factor.size(), mesh.points.size());
    options.interrupted = []() -> std::optional<Status> { return Status::timeout; };
    EXPECT_EQ(solve_flow(mesh, options).outcome.status, Status::timeout);
}

TEST(Flow, ParallelIsSerialBitForBit) {
    // More than 2048 faces, so that there is more than one task.
    const SurfaceMesh mesh = made("eight", 8000, 0.2);
    FlowOptions options;
    const FlowResult parallel = solve_flow(mesh, options);
    options.parallel = false;
    const FlowResult serial = solve_flow(mesh, options);
    EXPECT_EQ(parallel.conformal_factor, serial.conformal_factor);
    EXPECT_EQ(parallel.edge_length, serial.edge_length);
    EXPECT_EQ(parallel.triangulation.tail, serial.triangulation.tail);
}

}  // namespace
}  // namespace ricci
