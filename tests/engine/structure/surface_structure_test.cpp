#include "engine/structure/surface_structure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::structure_of;

double residual_of(const SurfaceStructure& s) {
    double worst = 0;
    for (std::size_t v = 0; v < s.flow.curvature.size(); ++v)
        worst = std::max(worst, std::abs(s.flow.curvature[v] - s.flow.target_curvature[v]));
    return worst;
}

/// What must hold of a flat surface with cones: letters are rigid motions that turn about cones by their
/// angles, and the relator closes.
void expect_flat_with_cones(const SurfaceMesh& mesh, const std::vector<Cone>& cones) {
    StructureOptions options;
    options.flow.geometry = Geometry::euclidean;
    options.flow.cones = cones;
    options.flow.tolerance = 1e-12;
    const SurfaceStructure s = structure_of(mesh, options);
    ASSERT_EQ(s.kappa, 0);
    ASSERT_EQ(s.basis->cones().size(), cones.size());
    // Curvatures that are left, and lengths of 1 carried over some hundred faces.
    EXPECT_LE(s.group.relator_error, 1e-9);
    EXPECT_LE(s.layout.closing_error, 1e-9);
    EXPECT_EQ(s.layout.flipped, 0);
    for (const SidePairing& pairing : s.layout.pairings) {
        EXPECT_NEAR(squared(pairing.element.a), 1.0, 1e-12);
        EXPECT_LE(pairing.spread, 1e-9);
    }
    for (std::size_t k = 0; k < cones.size(); ++k) {
        const Isometry<double>& letter = s.group.letters[at(s.basis->loops() + s.basis->boundaries()) + k];
        const Index vertex = s.basis->cones()[k];
        double curvature = 0;
        for (const Cone& cone : cones)
            if (cone.vertex == vertex) curvature = cone.curvature;
        // A frame carried around curvature K comes back turned by K; a is half of that, up to sign.
        EXPECT_NEAR(std::abs(letter.a.re), std::abs(std::cos(curvature / 2)), 1e-9);
    }
    double area = 0;
    for (Index p = 0; p < s.refinement->piece_count(); ++p) {
        const double piece = testing::image_area(*s.refinement, s.layout, p);
        EXPECT_GT(piece, 0.0);
        area += piece;
    }
    EXPECT_NEAR(area, 1.0, 1e-9);
    std::vector<Index> vertices;
    for (const Cone& cone : cones) vertices.push_back(cone.vertex);
    testing::expect_flat_angles(*s.refinement, s.layout, 1e-7, vertices);
}

TEST(SurfaceStructure, OfAnEightWithOneCone) {
    for (const double jitter : {0.0, 0.3}) {
        const SurfaceMesh mesh = testing::generated("eight", 1000, jitter);
        expect_flat_with_cones(mesh, {{100, -4 * std::numbers::pi}});
        expect_flat_with_cones(mesh, {{3, -2 * std::numbers::pi}, {200, -2 * std::numbers::pi}});
        expect_flat_with_cones(
            mesh, {{3, -5 * std::numbers::pi}, {200, 0.4 * std::numbers::pi}, {60, 0.6 * std::numbers::pi}});
    }
}

TEST(SurfaceStructure, OfASphereThatIsAPolyhedron) {
    // A flat tetrahedron whose corners have the angle pi, and a cube.
    const SurfaceMesh sphere = testing::generated("sphere", 320, 0.3),
                      ellipsoid = testing::generated("ellipsoid", 1280);
    for (const SurfaceMesh& mesh : {sphere, ellipsoid}) {
        std::vector<Cone> four, eight;
        for (Index v = 0; v < 4; ++v) four.push_back({v, std::numbers::pi});
        for (Index v = 0; v < 8; ++v) eight.push_back({10 + 7 * v, std::numbers::pi / 2});
        expect_flat_with_cones(mesh, four);
        expect_flat_with_cones(mesh, eight);
    }
}

TEST(SurfaceStructure, OfATorusWithAPairOfCones) {
    expect_flat_with_cones(testing::generated("torus", 1000, 0.3), {{10, 1.0}, {300, -1.0}});
}

TEST(SurfaceStructure, StopsWhereTheFlowDoes) {
    StructureOptions options;
    options.flow.max_iterations = 1;
    const SurfaceMesh mesh = testing::generated("eight", 1000, 0.3);
    const SurfaceStructure s = make_surface_structure(mesh, options);
    EXPECT_NE(s.flow.outcome.status, Status::converged);
    EXPECT_FALSE(s.refinement.has_value());
    EXPECT_FALSE(s.basis.has_value());
    EXPECT_TRUE(s.group.letters.empty());
}

TEST(SurfaceStructure, TellsConesFromTheTarget) {
    const SurfaceMesh mesh = testing::generated("torus", 200);
    FlowResult flow;
    flow.target_curvature.assign(at(mesh.connectivity.vertex_count), 0.0);
    flow.target_curvature[7] = 0.5;
    flow.target_curvature[2] = -0.5;
    EXPECT_EQ(cone_vertices(mesh, flow), (std::vector<Index>{2, 7}));
    const SurfaceMesh disk = testing::generated("disk", 100);
    flow.target_curvature.assign(at(disk.connectivity.vertex_count), 0.1);
    for (const Index v : cone_vertices(disk, flow)) EXPECT_FALSE(boundary_vertices(disk.connectivity)[at(v)]);
}

TEST(SurfaceStructure, FlatSurfacesHaveAreaOne) {
    for (const char* name : {"torus", "annulus"}) {
        const SurfaceMesh mesh = testing::generated(name, 600, 0.2);
        const SurfaceStructure s = structure_of(mesh);
        EXPECT_EQ(s.log_scale, -0.5 * std::log(s.flow.area));
        // chords of the refinement are those of the flow, scaled.
        const PieceAreas shares = piece_areas(*s.refinement);
        double area = 0;
        for (Index p = 0; p < s.refinement->piece_count(); ++p) {
            const Index f = s.refinement->final_face[at(p)];
            std::array<double, 3> l{};
            for (Index k = 0; k < 3; ++k) {
                const Index h = 3 * f + k;
                const Connectivity& c = s.refinement->final_triangulation.connectivity;
                l[at(k)] =
                    std::exp(static_cast<double>(s.refinement->final_triangulation.log_chord[at(h)]) +
                             (s.refinement->u[at(c.tail[at(h)])] + s.refinement->u[at(c.head(h))]) / 2);
            }
            const double half = (l[0] + l[1] + l[2]) / 2;
            area +=
                shares.final_share[at(p)] * std::sqrt(half * (half - l[0]) * (half - l[1]) * (half - l[2]));
        }
        EXPECT_NEAR(area, 1.0, 1e-12);
    }
}

TEST(SurfaceStructure, ClosesByTheDigitsItTakes) {
    // With double alone the relator of a large group cannot close; with more it does, on the same metric.
    const SurfaceMesh mesh = testing::generated("genus-g", 2500, 0.2, 8);
    StructureOptions plain, precise;
    plain.max_digits = 16;
    const SurfaceStructure coarse = structure_of(mesh, plain), fine = structure_of(mesh, precise);
    EXPECT_EQ(coarse.group.digits, 16);
    EXPECT_GT(coarse.group.relator_error, 1e-10);
    EXPECT_GT(fine.group.digits, 16);
    EXPECT_LE(fine.group.relator_error, 1e-10);
    EXPECT_GE(fine.group.reach, 5.0);
    // Generators agree to what double makes of them: reach^2 roundings.
    for (std::size_t k = 0; k < fine.group.letters.size(); ++k) {
        const double trace = testing::trace_size(fine.group.letters[k]);
        EXPECT_NEAR(testing::trace_size(coarse.group.letters[k]), trace, 1e-6 * trace);
    }
    EXPECT_LE(residual_of(fine), 1e-10);
}

void expect_closed_group(const std::string& path, Index genus) {
    const SurfaceMesh mesh = testing::load_component(path);
    const SurfaceStructure s = structure_of(mesh);
    EXPECT_EQ(s.canonical.genus(), genus);
    EXPECT_EQ(s.group.generators.size(), at(2 * genus));
    EXPECT_LE(s.group.relator_error, 1e-8);
    EXPECT_GT(s.group.digits, 16);
    // As many digits as elements reach, and not many times more.
    EXPECT_GE(s.group.digits, s.group.reach);
    EXPECT_LE(s.group.metric_residual, std::pow(10.0, -s.group.reach));
    EXPECT_LE(s.layout.closing_error, 1e-10);
    EXPECT_EQ(s.layout.flipped, 0);
}

TEST(SurfaceStructure, OfGenus12ClosesInMoreDigits) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g5plus/engine_g12.obj");
    expect_closed_group(path, 12);
}

TEST(SurfaceStructure, OfGenus15ClosesInMoreDigits) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g5plus/gyroidpuzzle_g15.obj");
    expect_closed_group(path, 15);
}

}  // namespace
}  // namespace ricci
