#include "engine/shape_space/spherical_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "engine/remesh/resample.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;

FlowResult flow_of(const SurfaceMesh& mesh, const FlowOptions& options = {}) {
    FlowResult flow = solve_flow(mesh, options);
    if (flow.outcome.status != Status::converged) throw std::runtime_error("the flow did not converge");
    return flow;
}

double chord(const Point& p, const Point& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

Point centre_of(const std::vector<SphereSample>& samples, double& total) {
    Point sum{};
    total = 0.0;
    for (const SphereSample& s : samples) {
        EXPECT_NEAR(chord(s.position, {}), 1.0, 1e-12);
        for (std::size_t k = 0; k < 3; ++k) sum[k] += s.weight * s.position[k];
        total += s.weight;
    }
    for (double& x : sum) x /= total;
    return sum;
}

double area_of(const SurfaceMesh& mesh) {
    double sum = 0.0;
    for (const double a : face_areas(mesh)) sum += a;
    return sum;
}

TEST(SphericalImage, APolyhedronInTheSphereIsItsOwnImage) {
    // An inscribed convex polyhedron with the symmetry of the icosahedron: the normalised map is a rotation.
    const SurfaceMesh mesh = testing::generated("sphere", 1280);
    const SphericalImage image = make_spherical_image(mesh, flow_of(mesh));
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h)
        EXPECT_NEAR(chord(image.position[at(mesh.connectivity.tail[at(h)])],
                          image.position[at(mesh.connectivity.head(h))]),
                    mesh.edge_length[at(h)], 1e-9);
    for (const double s : image.scale) EXPECT_NEAR(s, 1.0, 1e-9);
    EXPECT_FALSE(image.hemisphere);
    EXPECT_LE(image.closing_error, 1e-12);
}

TEST(SphericalImage, AFlatDiskIsProjectedStereographically) {
    // Stereographic projection is a Moebius map of space, so exact for discrete surfaces too.
    const SurfaceMesh mesh = testing::generated("disk", 600);
    const SphericalImage image = make_spherical_image(mesh, flow_of(mesh));
    EXPECT_TRUE(image.hemisphere);
    EXPECT_LE(image.equator_error, 1e-10);
    double turn = 0.0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const double x = mesh.points[v][0], y = mesh.points[v][1], r = std::hypot(x, y);
        const Point& p = image.position[v];
        EXPECT_NEAR(p[2], (1 - r * r) / (1 + r * r), 1e-9);
        EXPECT_NEAR(image.scale[v], (1 + r * r) / 2, 1e-9);
        if (r < 1e-9) continue;
        // One turn for all (the faces are seen from outside or inside: one sense for all).
        const double angle = std::remainder(std::atan2(p[1], p[0]) - std::atan2(y, x), 2 * std::numbers::pi);
        if (turn == 0.0) turn = angle;
        EXPECT_NEAR(std::remainder(angle - turn, 2 * std::numbers::pi), 0.0, 1e-8);
    }
}

TEST(SphericalImage, AreaIsInBalanceAndComplete) {
    for (const SurfaceMesh& mesh : {testing::generated("ellipsoid", 500, 0.3), testing::icosahedron(0.4, 2),
                                    testing::wavy_square(9, 0.3, 4), testing::generated("disk", 100, 0.4)}) {
        const SphericalImage image = make_spherical_image(mesh, flow_of(mesh));
        double total = 0.0;
        const Point centre = centre_of(area_samples(mesh, image), total);
        EXPECT_NEAR(total, area_of(mesh), 1e-12 * total);
        EXPECT_LE(std::hypot(centre[0], centre[1], image.hemisphere ? 0.0 : centre[2]), 1e-12);
        EXPECT_LE(image.imbalance, 1e-12);
        if (image.hemisphere) {
            EXPECT_GT(centre[2], 0.1);
        }
        // Chords of the map at edges that the final triangulation keeps.
        EXPECT_LE(image.closing_error, 1e-12);
    }
}

TEST(SphericalImage, ScaleIsLengthOverLength) {
    // Light cone: length^2 = scale_i scale_j chord^2 for all edges that never flipped, here most.
    const SurfaceMesh mesh = testing::generated("ellipsoid", 1300);
    const FlowResult flow = flow_of(mesh);
    const SphericalImage image = make_spherical_image(mesh, flow);
    std::int64_t kept = 0;
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h) {
        const auto i = at(mesh.connectivity.tail[at(h)]), j = at(mesh.connectivity.head(h));
        const double expected = mesh.edge_length[at(h)] / std::sqrt(image.scale[i] * image.scale[j]);
        kept += std::abs(chord(image.position[i], image.position[j]) / expected - 1.0) < 1e-8;
    }
    EXPECT_GE(kept, mesh.connectivity.halfedge_count() * 9 / 10);
}

TEST(SphericalImage, SamplesLieWhereTheProjectiveMapPutsThem) {
    // A flat disk by its symmetry needs no boost; scale times position is (x, y, (1 - r^2) / 2) up to a turn,
    // so the heights of a narrow face's three samples are those of its sides' middles.
    const SurfaceMesh mesh = testing::generated("disk", 9600);
    const SphericalImage image = make_spherical_image(mesh, flow_of(mesh));
    const std::vector<SphereSample> samples = area_samples(mesh, image);
    ASSERT_EQ(samples.size(), mesh.connectivity.tail.size());
    for (std::size_t h = 0; h < samples.size(); ++h) {
        const Point &p = mesh.points[at(mesh.connectivity.tail[h])],
                    &q = mesh.points[at(mesh.connectivity.head(static_cast<Index>(h)))];
        const double x = (p[0] + q[0]) / 2, y = (p[1] + q[1]) / 2;
        const double z = (2 - p[0] * p[0] - p[1] * p[1] - q[0] * q[0] - q[1] * q[1]) / 4;
        EXPECT_NEAR(samples[h].position[2], z / std::hypot(x, y, z), 1e-9);
    }
}

TEST(SphericalImage, VerticesAndSamplesMoveTogether) {
    // Coarse and uneven: vertices in balance are not the area in balance.
    const SurfaceMesh mesh = testing::icosahedron(0.4, 2);
    const SphericalImage image = make_spherical_image(mesh, flow_of(mesh));
    double moved = 0.0;
    for (std::size_t v = 0; v < image.position.size(); ++v) {
        const Point& c = image.corner[v];
        const double norm = chord(c, {});
        Point x{};
        double time = image.boost[15];
        for (std::size_t i = 0; i < 3; ++i) {
            x[i] = image.boost[4 * i + 3];
            for (std::size_t k = 0; k < 3; ++k) x[i] += image.boost[4 * i + k] * c[k] / norm;
            time += image.boost[12 + i] * c[i] / norm;
        }
        for (double& value : x) value /= time;
        EXPECT_LE(chord(x, image.position[v]), 1e-12);
        EXPECT_NEAR(image.scale[v], norm * time, 1e-12 * norm);
        moved = std::max(moved, std::abs(time - 1.0));
    }
    EXPECT_GT(moved, 1e-3);
}

TEST(SphericalImage, NormalisationDoesNotDependOnTheRoute) {
    // The direct flow ends anywhere in the Moebius group.
    const SurfaceMesh mesh = testing::generated("ellipsoid", 500, 0.2);
    FlowOptions direct;
    direct.sphere_route = SphereRoute::direct;
    const FlowResult other = flow_of(mesh, direct), flow = flow_of(mesh);
    double moved = 0.0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        moved = std::max(moved, std::abs(flow.conformal_factor[v] - other.conformal_factor[v]));
    const SphericalImage a = make_spherical_image(mesh, flow), b = make_spherical_image(mesh, other);
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        EXPECT_NEAR(a.scale[v], b.scale[v], 1e-6 * a.scale[v]);
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h) {
        const auto i = at(mesh.connectivity.tail[at(h)]), j = at(mesh.connectivity.head(h));
        EXPECT_NEAR(chord(a.position[i], a.position[j]), chord(b.position[i], b.position[j]), 1e-6);
    }
    EXPECT_GT(moved, 1e-6);  // there was something to undo
}

TEST(SphericalImage, MeanCurvatureOfABox) {
    // Steiner: half of pi/2 along every edge; flat edges count nothing.
    const double a = 1.0, b = 2.0, c = 0.7;
    std::vector<Point> points;
    for (int k = 0; k < 8; ++k) points.push_back({k & 1 ? a : 0.0, k & 2 ? b : 0.0, k & 4 ? c : 0.0});
    const std::vector<Triangle> triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                             {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                             {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const SurfaceMesh box = subdivide_midpoint(make_surface_mesh(points, triangles));
    const SphericalImage image = make_spherical_image(box, flow_of(box));
    double total = 0.0;
    centre_of(mean_curvature_samples(box, image), total);
    EXPECT_NEAR(total, std::numbers::pi * (a + b + c), 1e-12);
}

TEST(SphericalImage, FactorsBeyondSquares) {
    // A long strip, three cells wide: lengths over lengths reach e^(pi 130), whose squares no double holds.
    std::vector<Point> points;
    std::vector<Triangle> triangles;
    constexpr Index kCells = 780, kWide = 3;
    const auto vertex = [](Index i, Index j) { return i * (kWide + 1) + j; };
    for (Index i = 0; i <= kCells; ++i)
        for (Index j = 0; j <= kWide; ++j) points.push_back({1.0 * i, 1.0 * j, 0.0});
    for (Index i = 0; i < kCells; ++i)
        for (Index j = 0; j < kWide; ++j) {
            triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    const SurfaceMesh strip = make_surface_mesh(points, triangles);
    const SphericalImage image = make_spherical_image(strip, flow_of(strip));
    double total = 0.0;
    const Point centre = centre_of(area_samples(strip, image), total);
    EXPECT_GT(*std::max_element(image.scale.begin(), image.scale.end()), 1e155);
    EXPECT_LE(std::hypot(centre[0], centre[1]), 1e-12);
}

TEST(SphericalImage, RefusesWhatIsNoSphere) {
    const SurfaceMesh torus = testing::generated("torus", 200), disk = testing::generated("disk", 100),
                      sphere = testing::generated("sphere", 80);
    EXPECT_THROW(make_spherical_image(torus, flow_of(torus)), std::invalid_argument);
    FlowOptions flat;
    flat.geometry = Geometry::euclidean;
    flat.boundary = Boundary::free;
    EXPECT_THROW(make_spherical_image(disk, flow_of(disk, flat)), std::invalid_argument);
    EXPECT_THROW(make_spherical_image(sphere, FlowResult{}), std::invalid_argument);
    SurfaceMesh intrinsic = sphere;
    intrinsic.points.clear();
    EXPECT_THROW(mean_curvature_samples(intrinsic, make_spherical_image(intrinsic, flow_of(intrinsic))),
                 std::invalid_argument);
}

}  // namespace
}  // namespace ricci
