// Spheres and disks on the sphere: nothing turned over, everything covered once, closed forms.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::position_of;
using testing::structure_of;
using Vector = std::array<double, 3>;

/// Every piece turns counterclockwise, and together they cover the sphere (or half of it) once.
void expect_covered_once(const SurfaceMesh& mesh, double area) {
    const SurfaceStructure s = structure_of(mesh);
    ASSERT_EQ(s.kappa, 1);
    EXPECT_EQ(s.layout.flipped, 0);
    double sum = 0, lowest = 0;
    for (Index p = 0; p < s.refinement->piece_count(); ++p) {
        const double piece = testing::image_area(*s.refinement, s.layout, p);
        sum += piece;
        lowest = std::min(lowest, piece);
    }
    // Positions are rounded to 1e-16, sides are at most 1: an area may be off by as much.
    EXPECT_GE(lowest, -2e-16);
    EXPECT_NEAR(sum, area, 1e-9);
    for (const Vector& p : s.layout.position) EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), 1.0, 1e-14);
}

TEST(SphericalLayout, CoversTheSphereOnce) {
    constexpr double kSphere = 4 * std::numbers::pi;
    expect_covered_once(testing::octahedron(), kSphere);
    expect_covered_once(testing::icosahedron(0.4, 2), kSphere);
    expect_covered_once(testing::generated("sphere", 1280), kSphere);
    expect_covered_once(testing::generated("sphere", 1280, 0.45), kSphere);
    expect_covered_once(testing::generated("ellipsoid", 2000, 0.4), kSphere);
    GenerateOptions needle;
    needle.faces = 1280;
    needle.semi_axes = {1.0, 0.2, 0.2};
    expect_covered_once(generate("ellipsoid", needle), kSphere);
}

TEST(SphericalLayout, CoversTheSphereOnceByScans) {
    for (const char* file : {"spot.obj", "bunny.obj", "fandisk.obj", "maxplanck.nf25k.off"}) {
        SCOPED_TRACE(file);
        RICCI_DATA_FILE_OR_SKIP(path, std::string("meshes/closed_g0/") + file);
        expect_covered_once(testing::load_component(path), 4 * std::numbers::pi);
    }
}

void expect_half_sphere(const SurfaceMesh& mesh) {
    expect_covered_once(mesh, 2 * std::numbers::pi);
    const SurfaceStructure s = structure_of(mesh);
    const CommonRefinement& r = *s.refinement;
    for (Index c = 0; c < r.corner_count(); ++c) {
        const std::array<double, 2> z = conformal_point(1, position_of(s.layout, c));
        const bool boundary = r.twin[at(c)] < 0 || r.twin[at(r.previous(c))] < 0;
        // Boundary crossings lie on great circles between vertices whose angles are pi to 1e-12.
        if (boundary) {
            EXPECT_NEAR(std::hypot(z[0], z[1]), 1.0, 1e-10);
        } else if (r.vertex[at(c)] < r.input_vertices &&
                   !boundary_vertices(mesh.connectivity)[at(r.vertex[at(c)])]) {
            EXPECT_LT(std::hypot(z[0], z[1]), 1.0);
        }
    }
}

TEST(SphericalLayout, ADiskIsTheUnitDisk) {
    expect_half_sphere(testing::generated("disk", 600));
    expect_half_sphere(testing::generated("disk", 600, 0.4));
    expect_half_sphere(testing::wavy_square(12, 0.3, 2));
}

TEST(SphericalLayout, SoIsAScanWithAHole) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/disk/spotwithhole.obj");
    expect_half_sphere(testing::load_component(path));
}

/// The point of the unit sphere that corresponds conformally to a point of the ellipsoid of revolution with
/// semi-axes a, a, c. Its latitude chi is the conformal one: with the geodetic latitude phi and e^2 = 1 - c^2
/// / a^2, atanh(sin chi) = atanh(sin phi) - e atanh(e sin phi) (Snyder 1987, Map Projections, 3-1); for c >
/// a, e is imaginary.
Vector conformal_image(const Point& p, double a, double c) {
    const double across = std::hypot(p[0], p[1]);
    const double up = p[2] / (c * c), out = across / (a * a);
    const double sine = up / std::hypot(up, out);
    const double square = 1 - c * c / (a * a), e = std::sqrt(std::abs(square));
    const double shift = square > 0 ? -e * std::atanh(e * sine) : e * std::atan(e * sine);
    const double t = std::asinh(up / out) + shift;  // atanh(sin phi) = asinh(tan phi)
    return {p[0] / across / std::cosh(t), p[1] / across / std::cosh(t), std::tanh(t)};
}

/// Largest distance of the vertices' images from the closed form after the best rotation.
double ellipsoid_error(Index faces, double a, double c) {
    GenerateOptions options;
    options.faces = faces;
    options.semi_axes = {a, a, c};
    const SurfaceMesh mesh = generate("ellipsoid", options);
    const SurfaceStructure s = structure_of(mesh);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    std::vector<std::array<Eigen::Vector3d, 2>> pairs;
    for (std::size_t v = 0; v < s.layout.position.size(); ++v) {
        const Index vertex = s.layout.refinement_vertex[v];
        if (vertex >= s.refinement->input_vertices) continue;
        const Point& p = mesh.points[at(vertex)];
        if (std::hypot(p[0], p[1]) < 1e-9) continue;  // the poles have no longitude
        const Vector image = conformal_image(p, a, c);
        pairs.push_back({Eigen::Vector3d(s.layout.position[v].data()), Eigen::Vector3d(image.data())});
        covariance += pairs.back()[1] * pairs.back()[0].transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
    sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    const Eigen::Matrix3d rotation = svd.matrixU() * sign * svd.matrixV().transpose();
    double worst = 0;
    for (const auto& [x, y] : pairs) worst = std::max(worst, (rotation * x - y).norm());
    return worst;
}

TEST(SphericalLayout, AnEllipsoidOfRevolutionTendsToItsConformalLatitude) {
    // Both centres of area are the origin by symmetry (antipodes), so that a rotation is all that is left.
    // Faces shrink to a half from one to the next.
    for (const double c : {0.6, 1.6}) {
        SCOPED_TRACE("polar semi-axis " + std::to_string(c));
        const double coarse = ellipsoid_error(1280, 1.0, c), middle = ellipsoid_error(5120, 1.0, c),
                     fine = ellipsoid_error(20480, 1.0, c);
        EXPECT_GT(coarse, 3.0 * middle);
        EXPECT_GT(middle, 3.0 * fine);
        EXPECT_LT(fine, 1e-3);
    }
}

}  // namespace
}  // namespace ricci
