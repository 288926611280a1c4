// Targets and the conditions that every triangulation shares.
#include "engine/flow/target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using std::numbers::pi;

FlowSurface surface_of(const SurfaceMesh& mesh) {
    return make_flow_surface(mesh, false, true);
}

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(Target, KindsAreWhatTheyAreCalled) {
    const FlowSurface ball = surface_of(testing::icosahedron()), square = surface_of(testing::wavy_square(4));
    FlowOptions options;
    options.target = TargetKind::uniform;
    for (const double k : make_target(ball, options, Geometry::euclidean, Boundary::geodesic).curvature)
        EXPECT_DOUBLE_EQ(k, 4 * pi / 12);
    for (const double k : make_target(ball, options, Geometry::spherical, Boundary::geodesic).curvature)
        EXPECT_EQ(k, 0.0);
    EXPECT_THROW(make_target(square, options, Geometry::euclidean, Boundary::curvature),
                 std::invalid_argument);
    options.target = TargetKind::boundary;
    EXPECT_THROW(make_target(ball, options, Geometry::euclidean, Boundary::curvature), std::invalid_argument);
    const CurvatureTarget boundary = make_target(square, options, Geometry::euclidean, Boundary::curvature);
    for (std::size_t v = 0; v < 25; ++v)
        EXPECT_DOUBLE_EQ(boundary.curvature[v], square.boundary[v] ? 2 * pi / 16 : 0.0);
    EXPECT_EQ(boundary.unknown_count, 25);
    EXPECT_TRUE(boundary.scale_free);
    EXPECT_FALSE(make_target(square, options, Geometry::hyperbolic, Boundary::curvature).scale_free);
}

TEST(Target, FreeBoundariesHaveNoUnknowns) {
    const FlowSurface square = surface_of(testing::wavy_square(4));
    FlowOptions options;
    options.cones = {{12, 0.5}};
    const CurvatureTarget target = make_target(square, options, Geometry::euclidean, Boundary::free);
    EXPECT_EQ(target.unknown_count, 9);
    EXPECT_FALSE(target.scale_free);
    EXPECT_EQ(target.curvature[12], 0.5);
    for (std::size_t v = 0; v < 25; ++v) EXPECT_EQ(target.unknown[v] < 0, square.boundary[v] == 1);
    // One square of two triangles has no interior vertex.
    EXPECT_THROW(make_target(surface_of(testing::wavy_square(1)), {}, Geometry::euclidean, Boundary::free),
                 std::invalid_argument);
}

TEST(Target, RefusesWhatDoesNotFitTheSurface) {
    SurfaceMesh mesh = testing::wavy_square(4);
    const FlowSurface square = surface_of(mesh);
    const auto refuses = [&](const FlowOptions& options, Boundary boundary) {
        EXPECT_THROW(make_target(square, options, Geometry::euclidean, boundary), std::invalid_argument);
    };
    FlowOptions options;
    options.cones = {{25, 0.5}};
    refuses(options, Boundary::curvature);
    options.cones = {{-1, 0.5}};
    refuses(options, Boundary::curvature);
    options.cones = {{0, 0.5}};
    refuses(options, Boundary::geodesic);  // a corner of the square: geodesic boundaries are straight
    EXPECT_EQ(make_target(square, options, Geometry::euclidean, Boundary::curvature).curvature[0], 0.5);
    options.cones.clear();
    options.target = TargetKind::values;
    options.target_values.assign(24, 0.0);
    refuses(options, Boundary::curvature);
    options.target_values.assign(25, 0.25);
    const CurvatureTarget geodesic = make_target(square, options, Geometry::euclidean, Boundary::geodesic);
    for (std::size_t v = 0; v < 25; ++v) EXPECT_EQ(geodesic.curvature[v], square.boundary[v] ? 0.0 : 0.25);
}

TEST(Target, UnusedVerticesAreLeftOut) {
    std::vector<Point> points = testing::icosahedron().points;
    points.push_back({9, 9, 9});
    const SurfaceMesh mesh = make_surface_mesh(points, testing::icosahedron_triangles());
    FlowOptions options;
    options.target = TargetKind::uniform;
    const CurvatureTarget target =
        make_target(surface_of(mesh), options, Geometry::euclidean, Boundary::geodesic);
    EXPECT_EQ(target.unknown[12], -1);
    EXPECT_EQ(target.curvature[12], 0.0);
    EXPECT_NEAR(sum(target.curvature), 4 * pi, 1e-14);
    options.cones = {{12, 0.1}};
    EXPECT_THROW(make_target(surface_of(mesh), options, Geometry::euclidean, Boundary::geodesic),
                 std::invalid_argument);
}

/// What inadmissibility() says of given curvatures.
std::string verdict(const FlowSurface& surface, const std::vector<double>& values, Geometry geometry,
                    Boundary boundary) {
    FlowOptions options;
    options.target = TargetKind::values;
    options.target_values = values;
    return inadmissibility(surface, make_target(surface, options, geometry, boundary), geometry, boundary);
}

TEST(Inadmissibility, SumsMustFollowGaussBonnet) {
    const FlowSurface torus = surface_of(testing::bumpy_torus(4, 4));
    std::vector<double> k(16, 0.0);
    EXPECT_EQ(verdict(torus, k, Geometry::euclidean, Boundary::geodesic), "");
    k[3] = 1e-8;
    EXPECT_NE(verdict(torus, k, Geometry::euclidean, Boundary::geodesic), "");
    // Hyperbolic: strictly more than 2 pi chi; spherical: strictly less.
    EXPECT_EQ(verdict(torus, k, Geometry::hyperbolic, Boundary::geodesic), "");
    EXPECT_NE(verdict(torus, k, Geometry::spherical, Boundary::geodesic), "");
    k[3] = 0.0;
    EXPECT_NE(verdict(torus, k, Geometry::hyperbolic, Boundary::geodesic), "");
    EXPECT_NE(verdict(torus, k, Geometry::spherical, Boundary::geodesic), "");
    k[3] = -1e-8;
    EXPECT_NE(verdict(torus, k, Geometry::hyperbolic, Boundary::geodesic), "");
    EXPECT_EQ(verdict(torus, k, Geometry::spherical, Boundary::geodesic), "");
    EXPECT_NE(verdict(torus, k, Geometry::euclidean, Boundary::geodesic), "");
    k[3] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(verdict(torus, k, Geometry::euclidean, Boundary::geodesic), "");
}

TEST(Inadmissibility, ConesStayBelowTwoPiAndBoundaryConesBelowPi) {
    const FlowSurface torus = surface_of(testing::bumpy_torus(4, 4)),
                      square = surface_of(testing::wavy_square(4));
    std::vector<double> k(16, 0.0);
    k[3] = 2 * pi;
    k[4] = -2 * pi;
    EXPECT_NE(verdict(torus, k, Geometry::euclidean, Boundary::geodesic), "");
    k[3] = 6.28;
    k[4] = -6.28;
    EXPECT_EQ(verdict(torus, k, Geometry::euclidean, Boundary::geodesic), "");
    std::vector<double> b(25, 0.0);
    b[0] = pi;  // a corner
    b[24] = pi;
    EXPECT_NE(verdict(square, b, Geometry::euclidean, Boundary::curvature), "");
    b[0] = b[24] = 3.1415;
    b[12] = 2 * (pi - 3.1415);
    EXPECT_EQ(verdict(square, b, Geometry::euclidean, Boundary::curvature), "");
    b[12] = 2 * pi;
    b[0] = b[24] = 0.0;
    EXPECT_NE(verdict(square, b, Geometry::euclidean, Boundary::curvature), "");
    // A free boundary takes any rest, but no cone of 2 pi.
    b[12] = 3.0;
    EXPECT_EQ(verdict(square, b, Geometry::euclidean, Boundary::free), "");
    b[12] = 2 * pi;
    EXPECT_NE(verdict(square, b, Geometry::euclidean, Boundary::free), "");
}

TEST(InitialScale, GivesTheAreaThatGaussBonnetAsksFor) {
    const SurfaceMesh torus = testing::bumpy_torus(4, 4);
    std::vector<double> k(16, 0.1);
    EXPECT_EQ(initial_log_scale(torus, k, Geometry::euclidean), 0.0);
    double area = 0.0;
    for (const double a : face_areas(torus)) area += a;
    const double scale = std::exp(initial_log_scale(torus, k, Geometry::hyperbolic));
    EXPECT_NEAR(scale * scale * area, 1.6, 1e-14);
    k.assign(16, -0.1);
    const double spherical = std::exp(initial_log_scale(torus, k, Geometry::spherical));
    EXPECT_NEAR(spherical * spherical * area, 1.6, 1e-14);
    EXPECT_EQ(initial_log_scale(torus, k, Geometry::hyperbolic), 0.0);  // no such metric
}

TEST(ResolveGeometry, FollowsTheEulerCharacteristic) {
    const Topology sphere = topology_of(testing::octahedron().connectivity),
                   torus = topology_of(testing::bumpy_torus(4, 4).connectivity),
                   disk = topology_of(testing::wavy_square(3).connectivity);
    Topology eight = torus;
    eight.euler_characteristic = -2;
    FlowOptions options;
    EXPECT_EQ(resolve_geometry(options, sphere), Geometry::spherical);
    EXPECT_EQ(resolve_geometry(options, disk), Geometry::spherical);
    EXPECT_EQ(resolve_geometry(options, torus), Geometry::euclidean);
    EXPECT_EQ(resolve_geometry(options, eight), Geometry::hyperbolic);
    options.cones = {{0, 1.0}};
    EXPECT_EQ(resolve_geometry(options, eight), Geometry::euclidean);
    options.geometry = Geometry::hyperbolic;
    EXPECT_EQ(resolve_geometry(options, eight), Geometry::hyperbolic);
}

}  // namespace
}  // namespace ricci
