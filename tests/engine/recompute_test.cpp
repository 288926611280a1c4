// The second opinion agrees with the solver wherever both speak, and notices when a stored solution was
// changed.
#include "engine/verify/recompute.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/surfaces/generate.h"
#include "engine/sweep/area_distortion.h"
#include "tests/support/dense_metric.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::at;
using testing::Random;

double largest_difference(const std::vector<double>& a, std::span<const double> b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0.0;
    for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, std::abs(a[v] - b[v]));
    return largest;
}

SurfaceMesh scaled(SurfaceMesh mesh, double size) {
    for (Point& p : mesh.points)
        for (double& x : p) x *= size;
    return make_surface_mesh(mesh.points, triangles_of(mesh.connectivity));
}

void expect_agreement(const SurfaceMesh& mesh, Geometry geometry, Boundary boundary, bool delaunay,
                      double spread, Random& random) {
    const FlowSurface surface = make_flow_surface(mesh, boundary != Boundary::free, delaunay);
    ScaledMetric<double> metric(surface, geometry, false);
    const auto u = random.uniforms(at(surface.vertex_count()), -spread, spread);
    const auto expected = testing::curvature_at(metric, u);
    const Recomputed r = recompute_scaling(mesh, u, geometry, boundary, delaunay);
    const std::string what =
        std::string(name_of(geometry)) + " " + std::string(name_of(boundary)) + (delaunay ? "" : " none");
    ASSERT_FALSE(expected.empty()) << what;
    EXPECT_TRUE(r.valid) << what;
    // Double against long double: valences below 10, angles above 0.05: some 100 eps / 0.05.
    EXPECT_LT(largest_difference(r.curvature, expected), 1e-11) << what;
    EXPECT_EQ(r.isometric_flips, surface.isometric_flips) << what;
    EXPECT_NEAR(r.area_distortion, area_distortion_of_scaling(face_areas(mesh), mesh.connectivity.tail, u),
                1e-12);
}

TEST(Recompute, AgreesWithTheSolverForScaling) {
    Random random(1);
    const SurfaceMesh torus = testing::bumpy_torus(8, 6), square = testing::wavy_square(6, 0.3);
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical}) {
        const double size = geometry == Geometry::spherical ? 0.15 : 1.0,
                     spread = geometry == Geometry::spherical ? 0.3 : 1.0;
        for (int trial = 0; trial < 3; ++trial) {
            expect_agreement(scaled(torus, size), geometry, Boundary::geodesic, true, spread, random);
            for (const Boundary boundary : {Boundary::geodesic, Boundary::curvature})
                expect_agreement(scaled(square, size), geometry, boundary, true, spread, random);
            // Edges that stop flipping at the boundary may break: a mild factor.
            expect_agreement(scaled(square, size), geometry, Boundary::free, true, 0.15, random);
        }
    }
    const SurfaceMesh plain = testing::bumpy_torus(12, 6, 0.0);
    expect_agreement(plain, Geometry::euclidean, Boundary::geodesic, false, 0.05, random);
}

TEST(Recompute, AgreesWithSolvedFlows) {
    GenerateOptions options;
    options.faces = 800;
    options.jitter = 0.2;
    for (const std::string name : {"torus", "eight", "pants", "annulus-planar", "punctured-torus"}) {
        const SurfaceMesh mesh = generate(name, options);
        for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic}) {
            const Index chi = topology_of(mesh.connectivity).euler_characteristic;
            if (geometry == Geometry::hyperbolic && chi >= 0) continue;
            FlowOptions flow;
            flow.geometry = geometry;
            const auto boundary = boundary_vertices(mesh.connectivity);
            const Index inside = static_cast<Index>(
                std::find(boundary.begin(), boundary.end(), std::uint8_t{0}) - boundary.begin());
            if (geometry == Geometry::euclidean && chi < 0) flow.cones = {{inside, 2 * pi * chi}};
            const FlowResult solved = solve_flow(mesh, flow);
            ASSERT_EQ(solved.outcome.status, Status::converged) << name << ": " << solved.message;
            const Recomputed r =
                recompute_scaling(mesh, solved.conformal_factor, geometry, Boundary::geodesic, true);
            EXPECT_TRUE(r.valid);
            EXPECT_LT(largest_difference(r.curvature, solved.target_curvature), 1.1e-10) << name;
            // A factor that was tampered with is noticed.
            std::vector<double> changed = solved.conformal_factor;
            changed[changed.size() / 2] += 1e-6;
            const Recomputed other = recompute_scaling(mesh, changed, geometry, Boundary::geodesic, true);
            EXPECT_GT(largest_difference(other.curvature, solved.target_curvature), 1e-7) << name;
        }
    }
}

TEST(Recompute, AgreesOnIntrinsicSurfaces) {
    GenerateOptions options;
    options.faces = 250;
    const SurfaceMesh klein = generate("klein-quartic", options);
    const FlowResult solved = solve_flow(klein, {});
    ASSERT_EQ(solved.outcome.status, Status::converged);
    const Recomputed r =
        recompute_scaling(klein, solved.conformal_factor, Geometry::hyperbolic, Boundary::geodesic, true);
    EXPECT_LT(largest_difference(r.curvature, std::vector<double>(solved.curvature.size(), 0.0)), 1e-10);
    // Loops and an edge glued within one face.
    const SurfaceMesh pillow = testing::intrinsic_mesh(testing::folded_square<long double>(1.0L));
    const Recomputed folded =
        recompute_scaling(pillow, std::vector<double>(3, 0.0), Geometry::euclidean, Boundary::geodesic, true);
    EXPECT_TRUE(folded.valid);
    EXPECT_NEAR(folded.curvature[0], pi, 1e-15);
    EXPECT_NEAR(folded.curvature[1], 1.5 * pi, 1e-15);
    // The parallelogram whose long diagonal is cut: one isometric flip.
    const SurfaceMesh torus =
        testing::intrinsic_mesh(testing::one_vertex_torus<long double>(1.0L, 1.1L, 1.9L));
    const Recomputed flipped =
        recompute_scaling(torus, std::vector<double>(1, 0.0), Geometry::euclidean, Boundary::geodesic, true);
    EXPECT_GE(flipped.isometric_flips, 1);
    EXPECT_NEAR(flipped.curvature[0], 0.0, 1e-15);
    EXPECT_EQ(flipped.ptolemy_flips, 0);
}

TEST(Recompute, AgreesWithTheSolverForPackings) {
    Random random(2);
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical})
        for (const Scheme scheme :
             {Scheme::inversive_distance, Scheme::thurston, Scheme::tangential, Scheme::virtual_radius})
            for (const SurfaceMesh& mesh :
                 {scaled(testing::bumpy_torus(8, 6), 0.1), scaled(testing::wavy_square(5), 0.5)}) {
                const FlowSurface surface = make_flow_surface(mesh, false, false);
                const CirclePacking packing =
                    initial_circle_packing(mesh.connectivity, mesh.edge_length, geometry, scheme);
                PackedMetric metric(surface, packing, geometry, false);
                std::vector<double> u = packing.u;
                for (double& x : u) x += random.uniform(-0.02, 0.02);
                const auto expected = testing::curvature_at(metric, u);
                ASSERT_FALSE(expected.empty());
                const Recomputed r = recompute_packing(mesh, packing.eta, packing.eps, u, geometry);
                EXPECT_TRUE(r.valid);
                EXPECT_LT(largest_difference(r.curvature, expected), 1e-11)
                    << name_of(geometry) << name_of(scheme);
                EXPECT_NEAR(r.area_distortion,
                            area_distortion_of_areas(face_areas(mesh), metric.face_areas()), 1e-11);
            }
}

TEST(Recompute, SaysSoWhereATriangleBreaks) {
    // eta of 1 on two circles and a third far too small to span the gap of an edge with eta = 3.
    const SurfaceMesh mesh = testing::octahedron();
    std::vector<double> eta(24, 1.0);
    for (Index h = 0; h < 24; ++h)
        if (mesh.connectivity.edge[at(h)] == 0) eta[at(h)] = 30.0;
    const Recomputed r = recompute_packing(mesh, eta, std::vector<double>(6, 1.0),
                                           std::vector<double>(6, 0.0), Geometry::euclidean);
    EXPECT_FALSE(r.valid);
}

}  // namespace
}  // namespace ricci
