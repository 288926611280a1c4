#include "engine/shape_space/sphere_descriptor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "engine/remesh/resample.h"
#include "engine/shape_space/spherical_harmonics.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;

SphereDescriptor descriptor_of(const SurfaceMesh& mesh, const SphereDescriptorOptions& options = {}) {
    const FlowResult flow = solve_flow(mesh, {});
    if (flow.outcome.status != Status::converged) throw std::runtime_error("the flow did not converge");
    SphereDescriptor d = make_sphere_descriptor(mesh, flow, options);
    EXPECT_EQ(d.values.size(), d.names.size());
    EXPECT_EQ(std::set<std::string>(d.names.begin(), d.names.end()).size(), d.names.size());
    return d;
}

double distance(const SphereDescriptor& a, const SphereDescriptor& b) {
    EXPECT_EQ(a.names, b.names);
    double sum = 0.0;
    for (std::size_t k = 0; k < a.values.size(); ++k) sum += std::pow(a.values[k] - b.values[k], 2);
    return std::sqrt(sum);
}

double value(const SphereDescriptor& d, const std::string& name) {
    for (std::size_t k = 0; k < d.names.size(); ++k)
        if (d.names[k] == name) return d.values[k];
    throw std::out_of_range(name);
}

SurfaceMesh transformed(const SurfaceMesh& mesh, const std::function<Point(const Point&)>& map) {
    std::vector<Point> points;
    for (const Point& p : mesh.points) points.push_back(map(p));
    return make_surface_mesh(points, triangles_of(mesh.connectivity));
}

SurfaceMesh turned_over(const SurfaceMesh& mesh) {
    std::vector<Triangle> triangles = triangles_of(mesh.connectivity);
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
    return make_surface_mesh(mesh.points, triangles);
}

/// A closed surface without any symmetry.
Point dented(const Point& p) {
    const double r =
        1 + 0.3 * p[0] + 0.25 * p[1] * p[2] + 0.2 * std::sin(3 * p[2] + p[0]) + 0.1 * p[0] * p[1];
    return {1.3 * r * p[0], r * p[1], 0.8 * r * p[2]};
}
SurfaceMesh pebble(Index faces, double jitter = 0.0) {
    return transformed(testing::generated("sphere", faces, jitter), dented);
}
SurfaceMesh shell(Index faces) {
    return transformed(testing::generated("disk", faces), [](const Point& p) {
        return Point{p[0] + 0.2 * p[1] * p[1], 1.4 * p[1] + 0.1 * p[0],
                     0.5 * p[0] * p[0] + 0.4 * std::sin(2 * p[1])};
    });
}

TEST(SphereDescriptor, OfARoundSphere) {
    for (const double radius : {1.0, 250.0}) {
        const SphereDescriptor d =
            descriptor_of(transformed(testing::generated("sphere", 5000), [&](const Point& p) {
                return Point{radius * p[0] + 3, radius * p[1], radius * p[2]};
            }));
        for (std::size_t k = 0; k < d.values.size(); ++k)
            EXPECT_NEAR(d.values[k], d.names[k] == "mean_curvature_0" ? 1.0 : 0.0, 2e-3) << d.names[k];
        // Three fields of degrees 2 ... 12 with three sums, two of degree 1 with one, two of degree 0.
        EXPECT_EQ(d.values.size(), 11U * 6 + 3 + 2);
        EXPECT_TRUE(d.message.empty()) << d.message;
    }
}

TEST(SphereDescriptor, AMoebiusImageOfTheSphereIsASphere) {
    // Inverted, the sphere is a sphere again with its vertices crowded to one side: the normalisation spreads
    // them out.
    const SurfaceMesh crowded = testing::inverted(testing::generated("sphere", 5000), {0.0, 0.4, 1.7});
    const SphereDescriptor d = descriptor_of(crowded);
    for (std::size_t k = 0; k < d.values.size(); ++k)
        EXPECT_NEAR(d.values[k], d.names[k] == "mean_curvature_0" ? 1.0 : 0.0, 0.01) << d.names[k];
}

TEST(SphereDescriptor, OfAFlatDisk) {
    // Stereographic to the half sphere: with z = (1 - r^2) / (1 + r^2) the factor is log sqrt(2) - log(1 +
    // z), its curvature lies on the equator; means of P_2 and P_4 over the disk in closed form.
    const double ln2 = std::numbers::ln2;
    std::vector<double> error;
    for (const Index faces : {600, 2400, 9600}) {
        const SphereDescriptor d = descriptor_of(testing::generated("disk", faces));
        double worst = 0.0;
        const std::map<std::string, double> expected = {{"factor_0_0", 1 - 1.5 * ln2},
                                                        {"factor_2_0", -std::sqrt(5.0) / 12},
                                                        {"factor_4_0", 9.0 / 160},
                                                        {"area_2_0", (3 * (3 - 4 * ln2) - 1) / 2}};
        for (std::size_t k = 0; k < d.values.size(); ++k) {
            const auto found = expected.find(d.names[k]);
            const bool of_rings = d.names[k].ends_with("_0") && found == expected.end();
            if (of_rings && !d.names[k].starts_with("mean")) continue;
            const double exact = found == expected.end() ? 0.0 : found->second;
            worst = std::max(worst, std::abs(d.values[k] - exact));
        }
        error.push_back(worst);
    }
    EXPECT_LT(error[2], 1e-3);
    EXPECT_NEAR(0.5 * std::log2(error[0] / error[2]), 2.0, 0.3);
}

TEST(SphereDescriptor, MeanCurvatureOfDegreeZeroIsSteiners) {
    // A box: pi (a + b + c) over sqrt(area 4 pi).
    std::vector<Point> points;
    for (int k = 0; k < 8; ++k) points.push_back({k & 1 ? 1.0 : 0.0, k & 2 ? 2.0 : 0.0, k & 4 ? 0.7 : 0.0});
    const SurfaceMesh box = make_surface_mesh(points, std::vector<Triangle>{{0, 2, 1},
                                                                            {1, 2, 3},
                                                                            {4, 5, 6},
                                                                            {5, 7, 6},
                                                                            {0, 1, 4},
                                                                            {1, 5, 4},
                                                                            {2, 6, 3},
                                                                            {3, 6, 7},
                                                                            {0, 4, 2},
                                                                            {2, 4, 6},
                                                                            {1, 3, 5},
                                                                            {3, 7, 5}});
    const double area = 2 * (2.0 + 0.7 + 1.4), pi = std::numbers::pi;
    EXPECT_NEAR(value(descriptor_of(box), "mean_curvature_0"), pi * 3.7 / std::sqrt(area * 4 * pi), 1e-12);
}

TEST(SphereDescriptor, FactorFromAngleDefectsIsTheFactor) {
    // The same coefficients by integrating the log of the scale over the sphere's faces: on one degree at a
    // time both converge to the smooth surface's.
    const SurfaceMesh mesh = pebble(10000);
    const FlowResult flow = solve_flow(mesh, {});
    const SphericalImage image = make_spherical_image(mesh, flow);
    std::vector<double> sum(harmonic_count(6), 0.0), y(sum.size());
    for (Index f = 0; f < mesh.connectivity.face_count(); ++f) {
        Point centre{};
        std::array<Point, 3> p;
        double log_scale = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto v = at(mesh.connectivity.tail[3 * at(f) + k]);
            p[k] = image.position[v];
            log_scale += std::log(image.scale[v]) / 3;
            for (std::size_t i = 0; i < 3; ++i) centre[i] += p[k][i];
        }
        const double norm = std::hypot(centre[0], centre[1], centre[2]);
        for (double& x : centre) x /= norm;
        Point a, b;
        for (std::size_t i = 0; i < 3; ++i) a[i] = p[1][i] - p[0][i], b[i] = p[2][i] - p[0][i];
        const double area =
            0.5 * std::hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
        spherical_harmonics(6, centre, y);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += area * log_scale * y[k];
    }
    const SphereDescriptor d = make_sphere_descriptor(mesh, flow);
    for (int l = 1; l <= 6; ++l) {
        double norm = 0.0;
        for (int m = -l; m <= l; ++m) norm += std::pow(sum[harmonic_index(l, m)], 2);
        EXPECT_NEAR(value(d, "factor_" + std::to_string(l)), std::sqrt(norm / (4 * std::numbers::pi)), 2e-3)
            << l;
    }
    EXPECT_GT(value(d, "factor_2"), 0.1);
}

TEST(SphereDescriptor, AreaIsTheMeanOfLegendreOverPairs) {
    // P_2 is quadratic: its mean over pairs is (3 |M|^2 - 1) / 2, M the second moments.
    const SurfaceMesh mesh = pebble(320);
    const FlowResult flow = solve_flow(mesh, {});
    double moment[3][3] = {}, total = 0.0, norm = 0.0;
    for (const SphereSample& s : area_samples(mesh, make_spherical_image(mesh, flow))) {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) moment[i][j] += s.weight * s.position[i] * s.position[j];
        total += s.weight;
    }
    for (const auto& row : moment)
        for (const double m : row) norm += m * m / (total * total);
    const double area = value(make_sphere_descriptor(mesh, flow), "area_2");
    EXPECT_NEAR(area * area, (3 * norm - 1) / 2, 1e-12);
    EXPECT_GT(area, 0.1);
}

void expect_rigid_invariance(const SurfaceMesh& mesh) {
    const SphereDescriptor d = descriptor_of(mesh);
    // Residuals of 1e-10, factors near 1.
    const SphereDescriptor moved = descriptor_of(transformed(mesh, [](const Point& p) {
        const double c = std::cos(0.7), s = std::sin(0.7);
        const Point q{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
        return Point{37 * q[0] + 4, 37 * (c * q[1] - s * q[2]) - 1, 37 * (s * q[1] + c * q[2]) + 9};
    }));
    EXPECT_LE(distance(d, moved), 1e-8);
    Random random(4);
    EXPECT_LE(distance(d, descriptor_of(testing::relabelled(
                              mesh, random.permutation(mesh.connectivity.vertex_count), random))),
              1e-8);
    const SurfaceMesh mirrored = transformed(mesh, [](const Point& p) { return Point{-p[0], p[1], p[2]}; });
    EXPECT_LE(distance(d, descriptor_of(turned_over(mirrored))), 1e-8);
}

TEST(SphereDescriptor, MotionsScaleAndNumbersChangeNothing) {
    expect_rigid_invariance(pebble(600, 0.3));
    expect_rigid_invariance(shell(600));
}

TEST(SphereDescriptor, OrientationOfTheFaces) {
    // A closed surface has an outside; on a disk the sign of mean curvature is that of the faces.
    const SurfaceMesh closed = pebble(600), disk = shell(600);
    EXPECT_LE(distance(descriptor_of(closed), descriptor_of(turned_over(closed))), 1e-8);
    const SphereDescriptor d = descriptor_of(disk), other = descriptor_of(turned_over(disk));
    EXPECT_NEAR(value(d, "mean_curvature_0_0"), -value(other, "mean_curvature_0_0"), 1e-9);
    EXPECT_GT(std::abs(value(d, "mean_curvature_0_0")), 0.1);
    EXPECT_NEAR(value(d, "factor_3_1"), value(other, "factor_3_1"), 1e-8);
}

TEST(SphereDescriptor, ConvergesInSecondOrder) {
    for (const bool closed : {true, false}) {
        std::vector<SphereDescriptor> d;
        for (const Index faces : {1280, 5120, 20480})
            d.push_back(descriptor_of(closed ? pebble(faces) : shell(faces)));
        const double coarse = distance(d[0], d[1]), fine = distance(d[1], d[2]);
        EXPECT_LT(fine, 0.02) << closed;
        EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.5) << closed;
    }
}

TEST(SphereDescriptor, RetriangulationChangesLittle) {
    // Different shapes are 1 to 3 apart.
    const SurfaceMesh mesh = pebble(5000, 0.3);
    const SphereDescriptor d = descriptor_of(mesh);
    EXPECT_LT(distance(d, descriptor_of(subdivide_midpoint(mesh))), 0.02);
    EXPECT_LT(distance(d, descriptor_of(resample(mesh, 1500).mesh)), 0.05);
    EXPECT_GT(distance(d, descriptor_of(testing::generated("ellipsoid", 1500))), 0.3);
}

TEST(SphereDescriptor, IntrinsicSurfacesHaveNoMeanCurvature) {
    const SurfaceMesh mesh = pebble(600);
    SurfaceMesh intrinsic = mesh;
    intrinsic.points.clear();
    const SphereDescriptor d = descriptor_of(mesh), other = descriptor_of(intrinsic);
    EXPECT_FALSE(other.embedded);
    EXPECT_NE(other.message.find("mean curvature"), std::string::npos);
    EXPECT_EQ(other.values.size(), 2U + 11U * 3);
    for (const std::string& name : other.names) EXPECT_NEAR(value(other, name), value(d, name), 1e-9) << name;
}

TEST(SphereDescriptor, DegreesAndRefusals) {
    const SurfaceMesh mesh = testing::generated("sphere", 80);
    const FlowResult flow = solve_flow(mesh, {});
    EXPECT_EQ(make_sphere_descriptor(mesh, flow, {3}).names.size(), 2U * 6 + 3 + 2);
    EXPECT_THROW(make_sphere_descriptor(mesh, flow, {-1}), std::invalid_argument);
    EXPECT_THROW(make_sphere_descriptor(mesh, flow, {101}), std::invalid_argument);
    EXPECT_THROW(make_sphere_descriptor(mesh, FlowResult{}), std::invalid_argument);
}

TEST(SphereDescriptor, FindsTheFamilyInTheSamples) {
    // Leave one out: the nearest neighbour of every bunny, camel and centaur is one of its own.
    const std::vector<std::pair<std::string, std::string>> files = {
        {"bunny", "families/bunny_resolutions/bunny_102v.obj"},
        {"bunny", "families/bunny_resolutions/bunny_502v.obj"},
        {"bunny", "families/bunny_resolutions/bunny_5002v.obj"},
        {"camel", "families/camel_gallop/camel-gallop-03.off"},
        {"camel", "families/camel_gallop/camel-gallop-06.off"},
        {"centaur", "families/tosca_centaur/centaur0.off"},
        {"centaur", "families/tosca_centaur/centaur2.off"},
        {"centaur", "families/tosca_centaur/centaur4.off"},
        {"fourlegged 398", "families/shrec07_fourlegged/398.off"},
        {"fourlegged 399", "families/shrec07_fourlegged/399.off"},
        {"fourlegged 400", "families/shrec07_fourlegged/400.off"},
        {"spot", "closed_g0/spot.obj"},
        {"triceratops", "closed_g0/triceratops.off"},
        {"fandisk", "closed_g0/fandisk.obj"}};
    std::vector<SphereDescriptor> all;
    for (const auto& [family, file] : files) {
        RICCI_DATA_FILE_OR_SKIP(path, "meshes/" + file);
        all.push_back(descriptor_of(testing::load_component(path)));
    }
    for (std::size_t i = 0; i < 8; ++i) {
        std::size_t nearest = i == 0 ? 1 : 0;
        for (std::size_t j = 0; j < all.size(); ++j)
            if (j != i && distance(all[i], all[j]) < distance(all[i], all[nearest])) nearest = j;
        EXPECT_EQ(files[nearest].first, files[i].first)
            << files[i].second << " finds " << files[nearest].second;
    }
}

}  // namespace
}  // namespace ricci
