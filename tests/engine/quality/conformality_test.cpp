#include "engine/quality/conformality.h"

#include <gtest/gtest.h>

#include <numbers>

#include "engine/quality/piece_image.h"
#include "engine/surfaces/generate.h"
#include "io/mesh/mesh_file.h"
#include "tests/engine/quality/quality_surfaces.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::at;

ConformalityReport report_of(const SurfaceMesh& mesh, const FlowOptions& options = {}) {
    const testing::Solved s = testing::solved(mesh, options);
    EXPECT_EQ(s.flow.outcome.status, Status::converged);
    return measure_conformality(mesh, s.refinement, s.metric);
}

SurfaceMesh generated(const std::string& name, Index faces, double jitter = 0.0) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    options.seed = 5;
    return generate(name, options);
}

TEST(Conformality, FlatTorusMappedToItself) {
    // Displaced by 0.3 of a cell and sheared: far from Delaunay, so that faces fall into many pieces.
    const SurfaceMesh mesh = testing::flat_torus(8, 0.3, 3, {1.0, 0.9, 0.0, 0.7});
    for (const double u : {0.0, 1.7}) {
        const std::vector<double> factor(64, u);
        const CommonRefinement r = make_common_refinement(mesh, factor, false, true);
        ASSERT_GT(r.piece_count(), mesh.connectivity.face_count());
        const ConformalityReport q = measure_conformality(mesh, r, make_final_metric(0, r));
        // A corner counts as resolved where rounding moves its ratio by less than 1e-3.
        EXPECT_EQ(q.flipped, 0);
        EXPECT_EQ(q.pieces.curved.ratio.count, 0);
        EXPECT_EQ(q.pieces.regular.within_1, 1.0);
        EXPECT_NEAR(q.pieces.regular.ratio.mean, 1.0, 1e-6);
        // Whole corners of faces and areas have the digits of coordinates.
        EXPECT_EQ(q.faces.unresolved, 0);
        EXPECT_NEAR(q.faces.regular.ratio.min, 1.0, 1e-12);
        EXPECT_NEAR(q.faces.regular.ratio.max, 1.0, 1e-12);
        EXPECT_NEAR(q.distortion_by_area.mean, 1.0, 1e-10);
        EXPECT_LT(q.area_distortion, 1e-24);
        EXPECT_NEAR(q.total_image_area, std::exp(2 * u) * 64 * 0.7, std::exp(2 * u) * 1e-12);
    }
}

TEST(Conformality, LinearStretchIsSeen) {
    // diag(2, 1) and a rotation: singular values 2 and 1 whatever the piece.
    const double c = std::cos(0.3), s = std::sin(0.3);
    const testing::PlaneMap stretch{2 * c, 2 * s, -s, c};
    const SurfaceMesh mesh = testing::flat_torus(6, 0.2, 7);
    const std::vector<double> after = testing::mapped_lengths(6, 0.2, 7, stretch);
    std::vector<double> log_chord;
    for (const double length : after) log_chord.push_back(std::log(length));
    const CommonRefinement r = trivial_refinement(mesh, log_chord);
    const ConformalityReport q = measure_conformality(mesh, r, make_final_metric(0, r));
    for (const double k : q.distortion) EXPECT_NEAR(k, 2.0, 1e-12);
    for (const double a : q.log_area_ratio) EXPECT_NEAR(a, 0.0, 1e-12);
    EXPECT_NEAR(q.total_image_area, 2 * 36.0, 1e-11);
    // The angles are those of the stretched triangles.
    const auto angle = [](const std::vector<double>& l, std::size_t h) {
        const std::size_t f = h / 3 * 3, k = h % 3;
        const double x = l[h], y = l[f + (k + 2) % 3], z = l[f + (k + 1) % 3];
        return std::acos((x * x + y * y - z * z) / (2 * x * y));
    };
    for (std::size_t h = 0; h < after.size(); ++h)
        EXPECT_NEAR(q.faces.ratio[h], angle(after, h) / angle(mesh.edge_length, h), 1e-12);
    EXPECT_LT(q.faces.regular.within_5, 0.5);
}

// Equilateral triangles, p to a vertex, become regular ones with angle 2 pi / p: a symmetry of order three
// keeps each face, so its derivative at the middle is conformal and all faces are alike.
void expect_regular(const std::string& name, Index faces, double valence, double area) {
    SCOPED_TRACE(name);
    const ConformalityReport q = report_of(generated(name, faces));
    // Angle and area are as good as the curvature, 1e-10.
    EXPECT_EQ(q.pieces.regular.ratio.count, 0);
    EXPECT_NEAR(q.pieces.curved.ratio.min, 6.0 / valence, 1e-9);
    EXPECT_NEAR(q.pieces.curved.ratio.max, 6.0 / valence, 1e-9);
    EXPECT_EQ(q.pieces.curved.within_5, 0.0);
    EXPECT_NEAR(q.distortion_by_area.max, 1.0, 1e-9);
    EXPECT_LT(q.log_area.max - q.log_area.min, 1e-9);
    EXPECT_NEAR(q.total_image_area, area, 1e-8);
}

TEST(Conformality, RegularSurfaces) {
    expect_regular("klein-quartic", 56, 7.0, 8 * pi);
    expect_regular("bolza", 16, 8.0, 4 * pi);
}

// Image areas are summed over pieces, each measured on its own; Gauss and Bonnet know the sum.
TEST(Conformality, ImageAreasAddUp) {
    struct Case {
        std::string name;
        Index faces;
        double area;
    };
    for (const Case& x :
         {Case{"eight", 1500, 4 * pi}, Case{"pants", 800, 2 * pi}, Case{"sphere", 500, 4 * pi},
          Case{"disk", 600, 2 * pi}, Case{"ellipsoid", 1300, 4 * pi}}) {
        SCOPED_TRACE(x.name);
        const SurfaceMesh mesh = generated(x.name, x.faces, 0.4);
        const ConformalityReport q = report_of(mesh);
        // The sum of curvatures at the end: V times 1e-10 at most.
        EXPECT_NEAR(q.total_image_area, x.area, 1e-10 * mesh.connectivity.vertex_count);
        double sum = 0.0;
        for (const double a : q.image_area) sum += a;
        EXPECT_NEAR(sum, x.area, 1e-10 * mesh.connectivity.vertex_count);
        EXPECT_EQ(q.flipped, 0);
    }
}

TEST(Conformality, ScaleDoesNotMatter) {
    SurfaceMesh mesh = testing::bumpy_torus(12, 10, 0.1);
    const testing::Solved s = testing::solved(mesh);
    const ConformalityReport q = measure_conformality(mesh, s.refinement, s.metric);
    SurfaceMesh large = mesh;
    for (Point& p : large.points)
        for (double& x : p) x *= 1024.0;
    for (double& l : large.edge_length) l *= 1024.0;
    std::vector<double> u = s.flow.conformal_factor;
    for (double& value : u) value -= 6.0 * std::numbers::ln2;
    const CommonRefinement r = make_common_refinement(large, u, false, true);
    const ConformalityReport big = measure_conformality(large, r, make_final_metric(0, r));
    ASSERT_EQ(big.faces.ratio.size(), q.faces.ratio.size());
    for (std::size_t h = 0; h < q.faces.ratio.size(); ++h)
        EXPECT_NEAR(big.faces.ratio[h], q.faces.ratio[h], 1e-10);  // rounding of log 64, amplified by slivers
    EXPECT_NEAR(big.area_distortion, q.area_distortion, 1e-12);
    EXPECT_NEAR(big.distortion_by_area.mean, q.distortion_by_area.mean, 1e-10);
}

// On smooth surfaces the discrete map converges: what is left of the distortion falls with the edge length.
TEST(Conformality, ImprovesOnFinerTori) {
    double previous = 0.0, previous_share = 0.0;
    for (const Index faces : {500, 2000, 8000}) {
        const ConformalityReport q = report_of(generated("torus", faces));
        const double left = q.distortion_by_area.mean - 1.0;
        if (previous > 0.0) {
            // Twice as fine: half of it, or better.
            EXPECT_LT(left, 0.6 * previous);
            EXPECT_GE(q.faces.regular.within_1, previous_share);
        }
        previous = left;
        previous_share = q.faces.regular.within_1;
    }
}

// A scanned surface of 19,000 faces: 93.6 % of its corners keep their angle within 5 %, nothing is turned
// over.
TEST(Conformality, Kitten) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g1/kitten.obj");
    const ConformalityReport q = report_of(load_mesh(path).components.at(0));
    EXPECT_GT(q.faces.regular.within_5, 0.93);
    EXPECT_NEAR(q.faces.regular.ratio.quantile[3], 1.0, 0.005);
    EXPECT_EQ(q.flipped, 0);
    EXPECT_EQ(q.pieces.unresolved, 0);
    EXPECT_LT(q.distortion_by_area.mean, 1.05);
}

TEST(Conformality, CornersOfAFaceWithOneVertex) {
    // Every corner of both faces lies at the only vertex; the long side makes pieces.
    const SurfaceMesh mesh = testing::intrinsic_mesh(testing::one_vertex_torus(1.0, 1.1, 1.9));
    const std::vector<double> u{0.4};
    const CommonRefinement r = make_common_refinement(mesh, u, false, true);
    ASSERT_GT(r.piece_count(), 2);
    const ConformalityReport q = measure_conformality(mesh, r, make_final_metric(0, r));
    ASSERT_EQ(q.faces.ratio.size(), 6U);
    for (const double ratio : q.faces.ratio) EXPECT_NEAR(ratio, 1.0, 1e-12);
}

TEST(PieceImage, MotionsAndDistances) {
    testing::Random random(2);
    for (const int kappa : {-1, 0, 1})
        for (int i = 0; i < 100; ++i) {
            const auto point = [&] {
                const double x = random.uniform(-0.7, 0.7), y = random.uniform(-0.7, 0.7);
                return std::array<double, 3>{x, y, std::sqrt(1.0 - kappa * (x * x + y * y))};
            };
            const auto p = point(), q = point();
            const Isometry<double> m = motion_to(kappa, p);
            EXPECT_NEAR(squared(m.a) + kappa * squared(m.b), 1.0, 1e-15);
            const auto image = image_of_origin(kappa, m);
            for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(image[k], p[k], 1e-15);
            const double product = kappa * (p[0] * q[0] + p[1] * q[1]) + p[2] * q[2];
            const double expected = kappa == 0  ? std::hypot(p[0] - q[0], p[1] - q[1])
                                    : kappa < 0 ? std::acosh(product)
                                                : std::acos(product);
            // acosh and acos lose half the digits near 1; the points here are hardly ever that close.
            EXPECT_NEAR(point_distance(kappa, p, q), expected, 1e-12);
        }
}

}  // namespace
}  // namespace ricci
