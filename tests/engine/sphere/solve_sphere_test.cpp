#include "engine/sphere/solve_sphere.h"

#include <numbers>
#include <stdexcept>

#include "io/mesh/mesh_file.h"
#include "tests/engine/sphere/sphere_checks.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;

SphereResult solved(const FlowSurface& surface, const SphereOptions& options = {}) {
    SphereResult result = solve_sphere(surface, options);
    EXPECT_EQ(result.outcome.status, Status::converged) << result.message;
    EXPECT_LE(result.outcome.residual_max, options.tolerance);
    return result;
}

SphereOptions equal_masses(const FlowSurface& surface) {
    SphereOptions options;
    options.mass.assign(surface.used.size(), 1.0);
    return options;
}

TEST(SolveSphere, RegularPolyhedraAreInscribed) {
    // Nothing iterates in double here that could lose more than a few roundings.
    for (const double u : solved(make_flow_surface(testing::octahedron(), false, true)).u)
        EXPECT_NEAR(u, 0.0, 1e-14);
    const double radius = std::sqrt(1.0 + std::numbers::phi * std::numbers::phi);
    for (const double u : solved(make_flow_surface(testing::icosahedron(), false, true)).u)
        EXPECT_NEAR(u, -std::log(radius), 1e-14);
}

TEST(SolveSphere, PointsOfTheSphereComeBack) {
    // The chords of a convex hull, multiplied by arbitrary factors at the vertices: they come back, and the
    // points up to a rotation. Hulls of 30 points have angles down to 1e-2, a condition number of 1e4 at
    // most.
    Random random(1);
    for (int trial = 0; trial < 5; ++trial) {
        const std::vector<Point> points = testing::antipodal_points(15, random);
        const SurfaceMesh mesh = make_surface_mesh(points, testing::hull_triangles(points));
        ASSERT_EQ(topology_of(mesh.connectivity).euler_characteristic, 2);
        FlowSurface surface = make_flow_surface(mesh, false, false);
        const std::vector<double> factor = random.uniforms(points.size(), -3.0, 3.0);
        const Connectivity& c = surface.triangulation.connectivity;
        for (Index h = 0; h < c.halfedge_count(); ++h)
            surface.triangulation.log_chord[at(h)] -=
                (static_cast<long double>(factor[at(c.tail[at(h)])]) + factor[at(c.head(h))]) / 2;
        const SphereResult result = solved(surface, equal_masses(surface));
        EXPECT_LT(result.imbalance, 1e-15);
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_NEAR(result.u[i], factor[i], 1e-11) << trial << ", vertex " << i;
            for (std::size_t j = 0; j < i; ++j)
                EXPECT_NEAR(testing::distance(result.position[i], result.position[j]),
                            testing::distance(points[i], points[j]), 1e-11);
        }
    }
}

TEST(SolveSphere, DoesNotDependOnTheVertexAtInfinity) {
    for (const bool closed : {true, false}) {
        const SurfaceMesh mesh = testing::jittered(closed ? "ellipsoid" : "disk", 400);
        const FlowSurface surface = make_flow_surface(mesh, true, true);
        const SphereResult first = solved(surface);
        int others = 0;
        for (Index v = 0; v < surface.vertex_count() && others < 6; v += 5) {
            if (!closed && !surface.boundary[at(v)]) continue;
            SphereOptions options;
            options.infinity = v;
            const SphereResult other = solved(surface, options);
            EXPECT_EQ(other.infinity, v);
            // Curvatures below 1e-13 over eigenvalues of some 1e-2 (400 faces).
            for (std::size_t i = 0; i < first.u.size(); ++i) EXPECT_NEAR(other.u[i], first.u[i], 1e-11);
            ++others;
        }
        EXPECT_GE(others, 4);
    }
}

TEST(SolveSphere, InversionOfSpaceChangesNothingButTheFactor) {
    // x -> x / |x|^2 divides chords by |x_i| |x_j|: the same conformal class, so u grows by 2 log |x_i|.
    SurfaceMesh mesh = testing::jittered("ellipsoid", 300);
    for (Point& p : mesh.points) p[0] += 1.7;
    std::vector<Point> inverted = mesh.points;
    for (Point& p : inverted) {
        const double square = testing::dot(p, p);
        for (double& x : p) x /= square;
    }
    const std::vector<Triangle> triangles = triangles_of(mesh.connectivity);
    const FlowSurface before = make_flow_surface(make_surface_mesh(mesh.points, triangles), false, false),
                      after = make_flow_surface(make_surface_mesh(inverted, triangles), false, false);
    const SphereResult a = solved(before, equal_masses(before)), b = solved(after, equal_masses(after));
    for (std::size_t i = 0; i < a.u.size(); ++i)  // points are rounded: 1e-16 over angles of 1e-1, as above
        EXPECT_NEAR(b.u[i], a.u[i] + std::log(testing::dot(mesh.points[i], mesh.points[i])), 1e-11);
}

TEST(SolveSphere, MassesAreBalanced) {
    const SurfaceMesh mesh = testing::jittered("ellipsoid", 400);
    const FlowSurface surface = make_flow_surface(mesh, false, false);
    std::vector<double> area(mesh.points.size(), 0.0);
    const std::vector<double> faces = face_areas(mesh);
    for (std::size_t h = 0; h < mesh.connectivity.tail.size(); ++h)
        area[at(mesh.connectivity.tail[h])] += faces[h / 3];
    const SphereResult result = solved(surface);
    for (std::size_t x = 0; x < 3; ++x) {
        double sum = 0.0, total = 0.0;
        for (std::size_t i = 0; i < area.size(); ++i) {
            sum += area[i] * result.position[i][x];
            total += area[i];
        }
        EXPECT_NEAR(sum / total, 0.0, 1e-14);  // some hundred roundings of 1e-16, averaged
    }
}

TEST(SolveSphere, HalfOfTheMassAtOneVertexIsReported) {
    const FlowSurface surface = make_flow_surface(testing::icosahedron(), false, true);
    for (const Index infinity : {0, 1}) {
        SphereOptions options = equal_masses(surface);
        options.mass[0] = 12.0;
        options.infinity = infinity;
        const SphereResult result = solve_sphere(surface, options);
        EXPECT_GT(result.imbalance, 1e-3);
        EXPECT_NE(result.message.find("half of the mass"), std::string::npos) << result.message;
    }
}

TEST(SolveSphere, DisksAreHalvesOfTheSphere) {
    const FlowSurface surface = make_flow_surface(testing::jittered("disk", 600), true, true);
    const SphereResult result = solved(surface);
    // The mirror is a great circle through the north pole; everything lies on it or in mirror images.
    Point normal{0, 0, 0};
    for (std::size_t v = 0; v < surface.used.size(); ++v)
        if (surface.boundary[v] && std::abs(result.position[v][2]) < 0.9)
            normal = {result.position[v][1], -result.position[v][0], 0.0};
    const double length = std::sqrt(testing::dot(normal, normal));
    ASSERT_GT(length, 0.1);
    for (double& x : normal) x /= length;
    std::vector<Index> image(surface.used.size(), -1);
    for (std::size_t s = surface.used.size(); s < surface.orbit.size(); ++s)
        image[at(surface.orbit[s])] = static_cast<Index>(s);
    int sign = 0;
    for (std::size_t v = 0; v < surface.used.size(); ++v) {
        const double height = testing::dot(result.position[v], normal);
        if (surface.boundary[v]) {
            EXPECT_NEAR(height, 0.0, 1e-12);
            continue;
        }
        Point reflected = result.position[v];
        for (std::size_t x = 0; x < 3; ++x) reflected[x] -= 2.0 * height * normal[x];
        EXPECT_LT(testing::distance(reflected, result.position[at(image[v])]), 1e-12);
        if (sign == 0) sign = height > 0.0 ? 1 : -1;
        EXPECT_GT(sign * height, 0.0) << "all on one side";
    }
}

TEST(SolveSphere, ParallelIsSerialBitForBit) {
    const FlowSurface surface = make_flow_surface(testing::jittered("ellipsoid", 3000), false, true);
    SphereOptions serial;
    serial.parallel = false;
    EXPECT_EQ(solved(surface).u, solved(surface, serial).u);
}

TEST(SolveSphere, WhatHasNoRouteThrows) {
    const FlowSurface torus = make_flow_surface(testing::bumpy_torus(7, 6), true, true);
    EXPECT_FALSE(sphere_route_exists(torus));
    EXPECT_THROW(solve_sphere(torus, {}), std::invalid_argument);
    const SurfaceMesh disk = testing::wavy_square(4);
    EXPECT_FALSE(sphere_route_exists(make_flow_surface(disk, false, true))) << "a disk needs its double";
    const FlowSurface surface = make_flow_surface(disk, true, true);
    SphereOptions options;
    options.infinity = 12;  // the middle
    EXPECT_THROW(solve_sphere(surface, options), std::invalid_argument);
    options.infinity = 25;
    EXPECT_THROW(solve_sphere(surface, options), std::invalid_argument);
    options.infinity.reset();
    options.mass.assign(3, 1.0);
    EXPECT_THROW(solve_sphere(surface, options), std::invalid_argument);
}

TEST(SolveSphere, FlatPolyhedraAreReported) {
    // Doubles of a triangle and of a square without inner vertices: all vertices lie on one circle.
    for (const Index n : {3, 4}) {
        std::vector<Point> points{{0, 0, 0}, {1, 0, 0}, {1.1, 1, 0}, {0, 0.9, 0}};
        std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
        points.resize(at(n));
        triangles.resize(at(n - 2));
        const FlowSurface surface = make_flow_surface(make_surface_mesh(points, triangles), true, true);
        const SphereResult result = solve_sphere(surface, {});
        EXPECT_NE(result.outcome.status, Status::converged);
        EXPECT_FALSE(result.message.empty());
    }
}

TEST(SolveSphere, StopsWhenAsked) {
    const FlowSurface surface = make_flow_surface(testing::jittered("ellipsoid", 400), false, true);
    SphereOptions options;
    options.interrupted = [] { return std::optional(Status::timeout); };
    const SphereResult result = solve_sphere(surface, options);
    EXPECT_EQ(result.outcome.status, Status::timeout);
    EXPECT_FALSE(result.reached_sphere);
    options.interrupted = nullptr;
    options.max_iterations = 1;
    EXPECT_EQ(solve_sphere(surface, options).outcome.status, Status::max_iterations);
}

void expect_solves(const std::string& path, double smallest_range) {
    for (const SurfaceMesh& mesh : load_mesh(path).components) {
        const FlowSurface surface = make_flow_surface(mesh, true, true);
        const SphereResult result = solved(surface);
        EXPECT_LT(result.imbalance, 1e-12);
        const auto [low, high] = std::minmax_element(result.u.begin(), result.u.end());
        EXPECT_GT(*high - *low, smallest_range);
    }
}

// Legs, tails and tubes shrink to e^-15 ... e^-600 of the sphere.
TEST(SolveSphere, Triceratops) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g0/triceratops.off");
    expect_solves(path, 10.0);
}

TEST(SolveSphere, SmallIntestine) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/tube_colon/ct_small_intestine_20k_g0.off");
    expect_solves(path, 150.0);
}

TEST(SolveSphere, Maze) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/disk/maze.obj");
    expect_solves(path, 400.0);
}

}  // namespace
}  // namespace ricci
