// Triangulation, and what --repair changes.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the helpers of this folder

constexpr RepairOptions kOrient{true, false, false};
constexpr RepairOptions kWeld{false, true, false};
constexpr RepairOptions kDrop{false, false, true};
constexpr RepairOptions kWeldAndDrop{false, true, true};

std::vector<Triangle> triangles_in(const LoadedMesh& mesh) {
    EXPECT_EQ(error_codes(mesh), "");
    return mesh.components.empty() ? std::vector<Triangle>() : triangles_of(mesh.components[0].connectivity);
}

double total_area(const LoadedMesh& mesh) {
    double sum = 0;
    for (const SurfaceMesh& part : mesh.components) {
        const std::vector<double> areas = face_areas(part);
        sum += std::accumulate(areas.begin(), areas.end(), 0.0);
    }
    return sum;
}

TEST(MeshTriangulation, QuadTakesTheDiagonalWithTheLargerAngles) {
    // A kite: the short diagonal is 1-3.
    const std::string kite = "v -3 0 0\nv 0 -1 0\nv 3 0 0\nv 0 1 0\n";
    EXPECT_EQ(triangles_in(load_bytes("q.obj", kite + "f 1 2 3 4\n")),
              (std::vector<Triangle>{{1, 2, 3}, {1, 3, 0}}));
    // A square: a tie, which the lowest vertex decides, wherever the file starts.
    const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (const char* face : {"f 1 2 3 4\n", "f 2 3 4 1\n", "f 4 1 2 3\n"}) {
        EXPECT_EQ(triangles_in(load_bytes("q.obj", square + face)),
                  (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    }
}

TEST(MeshTriangulation, ReflexQuadIsCutInside) {
    const LoadedMesh mesh = load_bytes("q.obj", "v 0 0 0\nv 2 -1 0\nv 0.5 0 0\nv 2 1 0\nf 1 2 3 4\n");
    EXPECT_EQ(triangles_in(mesh), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_NEAR(total_area(mesh), 0.5, 1e-15);
}

TEST(MeshTriangulation, CollinearCornerGivesNoFlatFace) {
    // The diagonal 0-2 is the shorter one but would make a face of zero area.
    const LoadedMesh mesh = load_bytes("q.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 1 10 0\nf 1 2 3 4\n");
    EXPECT_EQ(triangles_in(mesh).size(), 2U);
    EXPECT_NEAR(total_area(mesh), 10, 1e-12);
}

TEST(MeshTriangulation, PillowOfTwoQuadsGetsDifferentDiagonals) {
    const LoadedMesh mesh = load_bytes("q.obj", "v 0 0 0\nv 1 0 1\nv 1 1 0\nv 0 1 1\nf 1 2 3 4\nf 4 3 2 1\n");
    EXPECT_EQ(error_codes(mesh), "");
    EXPECT_EQ(mesh.report.boundaries, 0);
    EXPECT_EQ(mesh.report.euler_characteristic, 2);
}

TEST(MeshTriangulation, PillowOfTwoPentagonsGetsDifferentDiagonals) {
    const LoadedMesh mesh =
        load_bytes("q.obj", "v 0 0 0\nv 2 0 0\nv 3 2 0\nv 1 3 0\nv -1 2 0\nf 1 2 3 4 5\nf 5 4 3 2 1\n");
    EXPECT_EQ(error_codes(mesh), "");
    EXPECT_EQ(mesh.report.boundaries, 0);
    EXPECT_EQ(mesh.report.euler_characteristic, 2);
}

TEST(MeshTriangulation, PolygonsKeepTheirArea) {
    // A comb with reflex and collinear corners, in a slanted plane.
    const std::vector<std::array<double, 2>> outline = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {2, 3},
                                                        {2, 1}, {1, 1}, {1, 3}, {0, 3}, {0, 2}, {0, 1}};
    std::string text;
    for (const auto& [x, y] : outline) {
        text.append("v ").append(std::to_string(x)).append(" ").append(std::to_string(y));
        text.append(" ").append(std::to_string(2 * x - y)).append("\n");
    }
    text += "f";
    for (std::size_t k = 1; k <= outline.size(); ++k) text.append(" ").append(std::to_string(k));
    const LoadedMesh mesh = load_bytes("p.obj", text);
    ASSERT_EQ(error_codes(mesh), "");
    EXPECT_EQ(note_codes(mesh), "triangulated");
    EXPECT_EQ(mesh.report.faces, 10);
    EXPECT_EQ(mesh.report.boundaries, 1);
    EXPECT_NEAR(total_area(mesh), 7 * std::sqrt(6.0), 1e-12);  // the plane stretches areas by |(-2, 1, 1)|
}

TEST(MeshTriangulation, LargePolygonsFinishOrAreRefused) {
    const auto disk = [](int corners) {
        std::string text;
        std::string face = "f";
        for (int k = 0; k < corners; ++k) {
            const double angle = 2 * 3.14159265358979323846 * k / corners;
            text.append("v ").append(std::to_string(1000 * std::cos(angle))).append(" ");
            text.append(std::to_string(1000 * std::sin(angle))).append(" 0\n");
            face.append(" ").append(std::to_string(k + 1));
        }
        return load_bytes("d.obj", text + face);
    };
    EXPECT_EQ(disk(500).report.faces, 498);
    EXPECT_EQ(error_codes(disk(10001)), "polygon_too_large");
}

TEST(MeshRepair, OrientFlipsTheMinority) {
    const std::string text = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 3 2 1\n3 2 0 3\n";
    const LoadedMesh mesh = load_bytes("t.off", text, kOrient);
    EXPECT_EQ(triangles_in(mesh), (std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}, {3, 1, 2}, {2, 0, 3}}));
    EXPECT_EQ(note_codes(mesh), "oriented");
    EXPECT_EQ(mesh.report.notes[0].message, "1 faces flipped: 2");
    EXPECT_EQ(mesh.report.oriented, true);
}

TEST(MeshRepair, OrientTieKeepsTheFirstFace) {
    const LoadedMesh mesh =
        load_bytes("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n", kOrient);
    EXPECT_EQ(triangles_in(mesh), (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
}

TEST(MeshRepair, NothingHappensUnasked) {
    const std::string soup = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 1 -0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 4 5 6\n";
    const LoadedMesh apart = load_bytes("t.obj", soup);
    EXPECT_EQ(apart.components.size(), 2U);
    EXPECT_EQ(note_codes(apart), "components coincident_vertices");
    const LoadedMesh welded = load_bytes("t.obj", soup, kWeld);
    ASSERT_EQ(welded.components.size(), 1U);
    EXPECT_EQ(note_codes(welded), "welded");
    EXPECT_EQ(welded.report.vertices, 4);
    EXPECT_EQ(welded.report.boundaries, 1);
    EXPECT_EQ(welded.components[0].points.size(), 6U);  // numbers of the input are kept
    EXPECT_EQ(triangles_in(welded), (std::vector<Triangle>{{0, 1, 2}, {2, 1, 5}}));
}

TEST(MeshRepair, WeldPrefersUsedVertices) {
    const LoadedMesh mesh = load_bytes("t.obj", "v 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n", kWeld);
    EXPECT_EQ(triangles_in(mesh), (std::vector<Triangle>{{1, 2, 3}}));
}

TEST(MeshRepair, WeldedNeedleIsDropped) {
    const std::string text = "v 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nf 1 2 3\nf 2 4 3\nf 5 1 3\n";
    EXPECT_EQ(error_codes(load_bytes("t.obj", text)), "zero_length_edge zero_area_face");
    EXPECT_EQ(error_codes(load_bytes("t.obj", text, kWeld)), "repeated_vertex_in_face");
    // Without welding, dropping would leave a crack: it is refused.
    EXPECT_EQ(error_codes(load_bytes("t.obj", text, kDrop)), "zero_length_edge zero_area_face");
    const LoadedMesh mesh = load_bytes("t.obj", text, kWeldAndDrop);
    EXPECT_EQ(triangles_in(mesh), (std::vector<Triangle>{{0, 3, 2}, {4, 0, 2}}));
    EXPECT_EQ(note_codes(mesh), "welded dropped_face");
    EXPECT_EQ(mesh.report.boundaries, 1);
}

TEST(MeshRepair, PolygonWithARepeatedCornerKeepsTheRest) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 2 3\n";
    EXPECT_EQ(error_codes(load_bytes("t.obj", text)), "repeated_vertex_in_face");
    EXPECT_EQ(triangles_in(load_bytes("t.obj", text, kDrop)), (std::vector<Triangle>{{0, 1, 2}}));
    const std::string spur = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 1 3\nf 1 3 4\n";
    EXPECT_EQ(error_codes(load_bytes("t.obj", spur, kDrop)), "repeated_vertex_in_face");
}

TEST(MeshRepair, InnerCapIsFlippedAway) {
    // Square 0 1 2 3 with vertex 4 in the middle of the diagonal 0-2: face (0, 4, 2) is flat.
    const std::string text =
        "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 1 0\nf 1 2 3\nf 1 3 5\nf 1 5 4\nf 5 3 4\n";
    EXPECT_EQ(error_codes(load_bytes("t.obj", text)), "zero_area_face");
    const LoadedMesh mesh = load_bytes("t.obj", text, kDrop);
    ASSERT_EQ(error_codes(mesh), "");
    EXPECT_EQ(note_codes(mesh), "flipped_edge");
    EXPECT_EQ(mesh.report.faces, 4);
    EXPECT_EQ(mesh.report.vertices, 5);
    EXPECT_EQ(mesh.report.boundaries, 1);
    EXPECT_EQ(mesh.report.euler_characteristic, 1);
    EXPECT_NEAR(total_area(mesh), 4, 1e-15);
    EXPECT_NEAR(*mesh.report.min_angle_deg, 45, 1e-12);
}

TEST(MeshRepair, ChainOfCapsIsFlippedAway) {
    // Three vertices 4, 5, 6 on the diagonal, with a fan of flat faces over it.
    const std::string text =
        "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 2 2 0\nv 3 3 0\n"
        "f 1 2 3\nf 1 3 7\nf 1 7 6\nf 1 6 5\nf 1 5 4\nf 5 6 4\nf 6 7 4\nf 7 3 4\n";
    const LoadedMesh mesh = load_bytes("t.obj", text, kDrop);
    ASSERT_EQ(error_codes(mesh), "");
    EXPECT_EQ(mesh.report.faces, 8);
    EXPECT_EQ(mesh.report.euler_characteristic, 1);
    EXPECT_NEAR(total_area(mesh), 16, 1e-12);
}

TEST(MeshRepair, BoundaryCapIsDropped) {
    // Vertex 3 lies on the boundary edge 0-1 of the flat face (0, 1, 3).
    const std::string text = "v 0 0 0\nv 2 0 0\nv 1 1 0\nv 1 0 0\nf 1 2 4\nf 1 4 3\nf 4 2 3\n";
    const LoadedMesh mesh = load_bytes("t.obj", text, kDrop);
    EXPECT_EQ(triangles_in(mesh), (std::vector<Triangle>{{0, 3, 2}, {3, 1, 2}}));
    EXPECT_EQ(note_codes(mesh), "dropped_face");
    EXPECT_NEAR(total_area(mesh), 1, 1e-15);
}

TEST(MeshRepair, CapThatCannotBeFlippedIsToldHonestly) {
    // A tetrahedron whose face (0, 1, 2) is flat: flipping 0-1 would double the edge 2-3.
    const std::string text = "v 0 0 0\nv 2 0 0\nv 1 0 0\nv 1 1 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    const LoadedMesh mesh = load_bytes("t.obj", text, kDrop);
    EXPECT_EQ(error_codes(mesh), "zero_area_face");
    EXPECT_NE(mesh.report.errors[0].message.find("cannot be repaired"), std::string::npos);
    const LoadedMesh asked = load_bytes("t.obj", text);
    EXPECT_NE(asked.report.errors[0].message.find("--repair drop-degenerate"), std::string::npos);
}

TEST(MeshRepair, DroppingEverythingIsAnError) {
    EXPECT_EQ(error_codes(load_bytes("t.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", kDrop)), "no_faces");
    EXPECT_EQ(error_codes(load_bytes("t.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 2\n", kDrop)), "no_faces");
}

TEST(MeshRepair, IntrinsicSurfacesAreLeftAlone) {
    const LoadedMesh mesh = load_bytes("t.len", torus_len(), {true, true, true});
    EXPECT_EQ(error_codes(mesh), "");
    EXPECT_EQ(note_codes(mesh), "repair_not_applicable");
}

}  // namespace
}  // namespace ricci
