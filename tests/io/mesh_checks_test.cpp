// Triangles that are no surface: each defect by name, with the numbers of the input.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "io/mesh/checks/collinear.h"
#include "io/mesh/checks/quality.h"
#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the helpers of this folder

const std::string kPoints = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nv -1 0 0\n";

/// Finds the first defect of a code.
Defect find_defect(const LoadedMesh& mesh, const std::string& code) {
    for (const Defect& defect : mesh.report.errors) {
        if (defect.code == code) return defect;
    }
    ADD_FAILURE() << "no " << code << " among " << error_codes(mesh);
    return {};
}

TEST(MeshChecks, NonManifoldEdgeNamesVerticesAndFaces) {
    const LoadedMesh mesh = load_bytes("t.obj", kPoints + "f 1 2 3\nf 2 1 4\nf 1 2 5\n");
    EXPECT_EQ(error_codes(mesh), "non_manifold_edge");
    const Defect defect = find_defect(mesh, "non_manifold_edge");
    EXPECT_EQ(defect.element, "edge");
    EXPECT_EQ(defect.index, 0);
    EXPECT_NE(defect.message.find("edge (0, 1) has 3 faces (0, 1, 2)"), std::string::npos) << defect.message;
    EXPECT_EQ(mesh.report.manifold, false);
    EXPECT_EQ(mesh.report.vertices, 5);
    EXPECT_EQ(mesh.report.edges, 7);
    EXPECT_EQ(mesh.report.faces, 3);
    EXPECT_FALSE(mesh.report.genus.has_value());
}

TEST(MeshChecks, PinchVerticesInsideAndOnTheBoundary) {
    const LoadedMesh open = load_bytes("t.obj", kPoints + "f 1 2 3\nf 1 4 5\n");
    EXPECT_EQ(error_codes(open), "non_manifold_vertex");
    EXPECT_EQ(find_defect(open, "non_manifold_vertex").index, 0);
    // Two tetrahedra that share vertex 0.
    const LoadedMesh closed =
        load_bytes("t.off",
                   "OFF\n7 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n-1 0 0\n0 -1 0\n0 0 -1\n"
                   "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 0 4 5\n3 0 6 4\n3 4 6 5\n3 5 6 0\n");
    EXPECT_EQ(error_codes(closed), "non_manifold_vertex");
    EXPECT_EQ(find_defect(closed, "non_manifold_vertex").index, 0);
}

TEST(MeshChecks, InconsistentOrientationNamesTheMinority) {
    const LoadedMesh mesh =
        load_bytes("t.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 3 2 1\n3 2 0 3\n");
    EXPECT_EQ(error_codes(mesh), "unoriented");
    const Defect defect = find_defect(mesh, "unoriented");
    EXPECT_EQ(defect.index, 2);
    EXPECT_NE(defect.message.find("--repair orient"), std::string::npos);
    EXPECT_EQ(mesh.report.oriented, false);
    EXPECT_EQ(mesh.report.manifold, true);
    EXPECT_EQ(mesh.report.genus, 0);
}

TEST(MeshChecks, MoebiusBandIsNonOrientableAndNotRepairable) {
    std::string text;  // seven triangles around the smallest Moebius strip of seven vertices
    for (int i = 0; i < 7; ++i) {
        text += "v " + std::to_string(std::cos(i)) + " " + std::to_string(std::sin(i)) + " " +
                std::to_string(0.1 * i * i) + "\n";
    }
    for (int i = 0; i < 7; ++i) {
        const auto vertex = [i](int k) { return std::to_string((i + k) % 7 + 1); };
        text += "f " + vertex(0) + " " + vertex(1) + " " + vertex(2) + "\n";
    }
    for (const bool orient : {false, true}) {
        const LoadedMesh mesh = load_bytes("m.obj", text, {orient, false, false});
        EXPECT_EQ(error_codes(mesh), "non_orientable");
        EXPECT_EQ(mesh.report.boundaries, 1);
        EXPECT_EQ(mesh.report.euler_characteristic, 0);
        EXPECT_FALSE(mesh.report.genus.has_value());
        EXPECT_NE(find_defect(mesh, "non_orientable").message.find("no --repair flag helps"),
                  std::string::npos);
    }
}

TEST(MeshChecks, DuplicateFaceInEitherOrientation) {
    const LoadedMesh mesh = load_bytes("t.obj", kPoints + "f 1 2 3\nf 2 4 3\nf 3 1 2\n");
    EXPECT_EQ(error_codes(mesh), "duplicate_face non_manifold_edge unoriented");
    EXPECT_EQ(find_defect(mesh, "duplicate_face").index, 2);
    EXPECT_EQ(error_codes(load_bytes("t.obj", kPoints + "f 1 2 3\nf 1 3 2\n")), "duplicate_face");
}

TEST(MeshChecks, RepeatedVertexIsReportedBesideTheRest) {
    const LoadedMesh mesh = load_bytes("t.obj", kPoints + "f 1 1 2\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
    EXPECT_EQ(error_codes(mesh), "repeated_vertex_in_face non_manifold_edge");
    const Defect defect = find_defect(mesh, "repeated_vertex_in_face");
    EXPECT_EQ(defect.index, 0);
    EXPECT_NE(defect.message.find("--repair drop-degenerate"), std::string::npos);
}

TEST(MeshChecks, ZeroAreaAndNonManifoldAreBothReported) {
    const LoadedMesh mesh = load_bytes("t.obj", kPoints + "f 1 2 3\nf 2 1 4\nf 1 2 6\n");
    EXPECT_EQ(error_codes(mesh), "non_manifold_edge zero_area_face");
    EXPECT_EQ(find_defect(mesh, "zero_area_face").index, 2);
    EXPECT_EQ(mesh.report.min_angle_deg, 0);
}

TEST(MeshChecks, ZeroLengthEdgeNamesWelding) {
    const LoadedMesh mesh = load_bytes("t.obj", "v 0 0 0\nv -0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 2 4 3\n");
    EXPECT_EQ(error_codes(mesh), "zero_length_edge zero_area_face");
    EXPECT_NE(find_defect(mesh, "zero_length_edge").message.find("weld,drop-degenerate"), std::string::npos);
}

TEST(MeshChecks, ThinFacesLoad) {
    // One ulp off the line, and far too thin for the angle to be told from zero in double precision.
    const LoadedMesh thin = load_bytes("t.obj", "v 0 0 0\nv 1 1 1\nv 3 3 3.0000000000000004\nf 1 2 3\n");
    EXPECT_EQ(error_codes(thin), "");
    EXPECT_GT(*thin.report.min_angle_deg, 0);
    const LoadedMesh tiny = load_bytes("t.obj", "v 0 0 0\nv 1 0 0\nv 0.5 1e-320 0\nf 1 2 3\n");
    EXPECT_EQ(error_codes(tiny), "");
    EXPECT_EQ(note_codes(tiny), "sliver_face");
    EXPECT_EQ(error_codes(load_bytes("t.obj", "v 0 0 0\nv 1e-300 0 0\nv 0 1e-300 0\nf 1 2 3\n")), "");
    EXPECT_EQ(error_codes(load_bytes("t.obj", "v 0 0 0\nv 1e300 0 0\nv 0 1e300 0\nf 1 2 3\n")), "");
    EXPECT_EQ(error_codes(load_bytes("t.obj", "v 0 0 0\nv 1e300 1e300 0\nv 2e300 2e300 0\nf 1 2 3\n")),
              "zero_area_face");
}

TEST(MeshChecks, CollinearityIsExact) {
    std::mt19937_64 random(1);
    const auto number = [&random] {
        // Integers of 20 bits times a power of two: sums and small multiples stay exact.
        const auto mantissa = static_cast<double>(static_cast<std::int64_t>(random() % 2097152) - 1048576);
        return std::ldexp(mantissa, static_cast<int>(random() % 3));
    };
    for (int i = 0; i < 2000; ++i) {
        const Point a = {number(), number(), number()};
        const Point d = {number(), number(), number()};
        const double s = static_cast<double>(random() % 64);
        const Point b = {a[0] + d[0], a[1] + d[1], a[2] + d[2]};
        Point c = {a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2]};
        EXPECT_TRUE(collinear(a, b, c));
        EXPECT_TRUE(collinear(c, a, b));
        if (d[1] == 0 && d[2] == 0) continue;
        c[0] = std::nextafter(c[0], 1e300);
        EXPECT_FALSE(collinear(a, b, c)) << i;
    }
    EXPECT_TRUE(collinear({5e-324, 0, 0}, {1e-323, 0, 0}, {0, 0, 0}));
    EXPECT_FALSE(collinear({5e-324, 0, 0}, {0, 5e-324, 0}, {0, 0, 0}));
    EXPECT_TRUE(collinear({1e308, 1e308, 1e308}, {-1e308, -1e308, -1e308}, {0, 0, 0}));
}

TEST(MeshChecks, AnglesSumToPi) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int i = 0; i < 100; ++i) {
        const auto point = [&] { return Point{number(random), number(random), number(random)}; };
        const auto angles = corner_angles(point(), point(), point());
        EXPECT_NEAR(static_cast<double>(angles[0] + angles[1] + angles[2]), 3.14159265358979323846, 1e-14);
    }
}

TEST(MeshChecks, RightAnglesAreNotObtuse) {
    const LoadedMesh mesh =
        load_bytes("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0.2 -0.2 0\nf 1 2 3\nf 2 1 4\n");
    EXPECT_EQ(mesh.report.obtuse_fraction, 0.5);
}

TEST(MeshChecks, LongListsAreCutWithASummary) {
    std::string text = "OFF\n3 50 0\n0 0 0\n1 0 0\n0 1 0\n";
    for (int f = 0; f < 50; ++f) text += "3 0 1 9\n";
    const LoadedMesh mesh = load_bytes("t.off", text);
    EXPECT_EQ(error_codes(mesh), "index_out_of_range");
    ASSERT_EQ(mesh.report.errors.size(), 21U);
    EXPECT_EQ(mesh.report.errors[19].index, 19);
    EXPECT_EQ(mesh.report.errors[20].index, -1);
    EXPECT_EQ(mesh.report.errors[20].message, "and 30 more index_out_of_range (50 in all)");
}

TEST(MeshChecks, UnusedVerticesKeepTheirNumbers) {
    const LoadedMesh mesh = load_bytes("t.obj", kPoints + "f 2 3 5\n");
    EXPECT_EQ(error_codes(mesh), "");
    EXPECT_EQ(note_codes(mesh), "unused_vertices");
    EXPECT_EQ(mesh.report.notes[0].message, "3 vertices are used by no face: 0, 3, 5");
    EXPECT_EQ(mesh.report.vertices, 3);
    EXPECT_EQ(mesh.components[0].points.size(), 6U);
    EXPECT_EQ(triangles_of(mesh.components[0].connectivity)[0], (Triangle{1, 2, 4}));
}

TEST(MeshChecks, ComponentsAreCompactedInOrderOfLowestVertex) {
    // Vertex 0 is unused; faces alternate between the components.
    const LoadedMesh mesh = load_bytes("t.off",
                                       "OFF\n8 3 0\n9 9 9\n0 0 0\n1 0 0\n5 0 0\n0 1 0\n6 0 0\n5 1 0\n1 1 0\n"
                                       "3 3 5 6\n3 1 2 4\n3 4 2 7\n");
    ASSERT_EQ(error_codes(mesh), "");
    ASSERT_EQ(mesh.components.size(), 2U);
    EXPECT_EQ(mesh.report.components, 2);
    EXPECT_EQ(mesh.components[0].input_vertex, (std::vector<Index>{1, 2, 4, 7}));
    EXPECT_EQ(mesh.components[1].input_vertex, (std::vector<Index>{3, 5, 6}));
    EXPECT_EQ(triangles_of(mesh.components[0].connectivity), (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
    EXPECT_EQ(triangles_of(mesh.components[1].connectivity), (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(mesh.components[0].points[3], (Point{1, 1, 0}));
    EXPECT_EQ(mesh.components[1].edge_length[0], 1.0);
    for (const SurfaceMesh& part : mesh.components) EXPECT_STREQ(check_connectivity(part.connectivity), "");
}

}  // namespace
}  // namespace ricci
