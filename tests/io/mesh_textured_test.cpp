// Textured OBJ files: read back by the project's reader, and as text.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "io/mesh/save_textured.h"
#include "io/picture/checker_image.h"
#include "io/picture/checkerboard.h"
#include "io/store/durable.h"
#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the helpers of this folder

// The surface of a cube: four sides with two triangles each, a quadrilateral at the bottom and one at the
// top. Each face has texture coordinates of its own.
TexturedMesh sample_cube() {
    TexturedMesh mesh;
    for (Index i = 0; i < 8; ++i)
        mesh.points.push_back({(i & 1) / 3.0, ((i >> 1) & 1) / 7.0, (i >> 2) / 11.0});
    const std::vector<std::vector<Index>> faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                                   {1, 3, 7},    {1, 7, 5},    {3, 2, 6}, {3, 6, 7},
                                                   {2, 0, 4},    {2, 4, 6}};
    for (const auto& face : faces) {
        for (std::size_t k = 0; k < face.size(); ++k) {
            const auto t = static_cast<Index>(mesh.uv.size());
            mesh.uv.push_back({std::sin(1.0 + t), -std::cos(3.0 * t) / 7});
            mesh.corners.push_back({face[k], t});
        }
        mesh.face_start.push_back(static_cast<Index>(mesh.corners.size()));
    }
    return mesh;
}

TEST(MeshTextured, ReaderGivesTheSamePointsAndTriangles) {
    const TemporaryFolder folder;
    const TexturedMesh mesh = sample_cube();
    // Triangles only: the polygons' diagonals are the reader's choice.
    TexturedMesh triangles = mesh;
    triangles.corners.clear();
    triangles.face_start = {0};
    std::vector<Triangle> expected;
    for (std::size_t f = 0; f + 1 < mesh.face_start.size(); ++f) {
        const auto first = static_cast<std::size_t>(mesh.face_start[f]);
        const auto end = static_cast<std::size_t>(mesh.face_start[f + 1]);
        for (std::size_t k = first + 1; k + 1 < end; ++k) {
            for (const std::size_t i : {first, k, k + 1}) triangles.corners.push_back(mesh.corners[i]);
            triangles.face_start.push_back(static_cast<Index>(triangles.corners.size()));
            expected.push_back({mesh.corners[first].point, mesh.corners[k].point, mesh.corners[k + 1].point});
        }
    }
    for (const int squares : {0, 8}) {
        save_textured(folder.path("m.obj"), triangles, squares);
        const LoadedMesh loaded = load_mesh(folder.path("m.obj"));
        ASSERT_EQ(error_codes(loaded), "") << squares;
        EXPECT_EQ(loaded.components.at(0).points, triangles.points);
        EXPECT_EQ(triangles_of(loaded.components[0].connectivity), expected);
        EXPECT_EQ(loaded.components[0].connectivity.vertex_count, 8);  // cuts of the texture cut nothing
    }
}

TEST(MeshTextured, PolygonsStayPolygons) {
    const TemporaryFolder folder;
    const TexturedMesh mesh = sample_cube();
    save_textured(folder.path("m.obj"), mesh);
    const LoadedMesh loaded = load_mesh(folder.path("m.obj"));
    ASSERT_EQ(error_codes(loaded), "");
    EXPECT_EQ(loaded.components.at(0).points, mesh.points);
    EXPECT_EQ(loaded.components[0].connectivity.face_count(), 12);
    EXPECT_EQ(loaded.report.genus, 0);
}

TEST(MeshTextured, EveryNumberComesBack) {
    const TemporaryFolder folder;
    TexturedMesh mesh = sample_cube();
    mesh.points[3] = {1e-310, -1e17 / 3.0, 5e-324};  // subnormal ones among them
    mesh.uv[2] = {1e300 / 7, -0.0};
    save_textured(folder.path("m.obj"), mesh, 4);
    std::istringstream lines(read_text(folder.path("m.obj")));
    TexturedMesh back;
    std::string line, materials;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string word, token;
        std::vector<std::string> tokens;
        words >> word;
        while (words >> token) tokens.push_back(token);
        const auto number = [&](std::size_t i) { return std::strtod(tokens.at(i).c_str(), nullptr); };
        if (word == "v") back.points.push_back({number(0), number(1), number(2)});
        if (word == "vt") back.uv.push_back({number(0), number(1)});
        if (word == "mtllib" || word == "usemtl") materials += line + ";";
        if (word != "f") continue;
        for (const std::string& corner : tokens)
            back.corners.push_back(
                {std::stoi(corner) - 1, std::stoi(corner.substr(corner.find('/') + 1)) - 1});
        back.face_start.push_back(static_cast<Index>(back.corners.size()));
    }
    EXPECT_EQ(back.points, mesh.points);
    EXPECT_EQ(back.uv, mesh.uv);
    EXPECT_EQ(back.corners, mesh.corners);
    EXPECT_EQ(back.face_start, mesh.face_start);
    EXPECT_EQ(materials, "mtllib m.mtl;usemtl checkerboard;");
    EXPECT_NE(read_text(folder.path("m.mtl")).find("newmtl checkerboard\n"), std::string::npos);
    EXPECT_NE(read_text(folder.path("m.mtl")).find("map_Kd m.png\n"), std::string::npos);
    EXPECT_EQ(read_text(folder.path("m.png")), checker_png(4));
}

// Big-endian number at a place.
std::size_t number_at(const std::string& bytes, std::size_t at) {
    std::size_t number = 0;
    for (std::size_t i = 0; i < 4; ++i) number = 256 * number + static_cast<unsigned char>(bytes.at(at + i));
    return number;
}

TEST(MeshTextured, ImageAgreesWithTheCheckerboard) {
    for (const int squares : {1, 2, 7, 8}) {
        const std::string png = checker_png(squares);
        ASSERT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1A\n");
        std::string header, data;
        for (std::size_t at = 8; at < png.size();) {
            const std::size_t length = number_at(png, at);
            const std::string type = png.substr(at + 4, 4);
            const auto sum =
                crc32(0, reinterpret_cast<const Bytef*>(png.data() + at + 4), static_cast<uInt>(length + 4));
            EXPECT_EQ(number_at(png, at + 8 + length), sum) << type;
            if (type == "IHDR") header = png.substr(at + 8, length);
            if (type == "IDAT") data = png.substr(at + 8, length);
            at += 12 + length;
        }
        const auto side = static_cast<std::size_t>(16 * squares);
        EXPECT_EQ(number_at(header, 0), side);
        EXPECT_EQ(number_at(header, 4), side);
        std::string rows(side * (side / 8 + 1), '?');
        uLongf size = rows.size();
        ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                             reinterpret_cast<const Bytef*>(data.data()), static_cast<uLong>(data.size())),
                  Z_OK);
        ASSERT_EQ(size, rows.size());
        std::size_t black = 0;
        for (std::size_t row = 0; row < side; ++row) {
            ASSERT_EQ(rows[row * (side / 8 + 1)], '\0');
            for (std::size_t x = 0; x < side; ++x) {
                const auto byte = static_cast<unsigned char>(rows[row * (side / 8 + 1) + 1 + x / 8]);
                const bool white = ((byte >> (7 - x % 8)) & 1) != 0;
                black += white ? 0U : 1U;
                // A small triangle about the middle of the pixel, as black_squares sees it.
                const double u = (static_cast<double>(x) + 0.5) / static_cast<double>(side);
                const double v = 1.0 - (static_cast<double>(row) + 0.5) / static_cast<double>(side);
                if (row % 5 != 0) continue;  // enough of them
                const TexturedTriangle dot{{{{0, 0}, {1, 0}, {0, 1}}},
                                           {{{u, v}, {u + 1e-4, v}, {u, v + 1e-4}}}};
                EXPECT_EQ(black_squares(std::span(&dot, 1), 1.0 / squares).size(), white ? 0U : 1U);
            }
        }
        EXPECT_EQ(black, squares % 2 == 0 ? side * side / 2
                                          : 128U * static_cast<std::size_t>(squares * squares + 1));
    }
}

TEST(MeshTextured, Refusals) {
    const TemporaryFolder folder;
    const TexturedMesh mesh = sample_cube();
    EXPECT_THROW(save_textured(folder.path("m.ply"), mesh), FileError);
    EXPECT_THROW(save_textured(folder.path("no/such/m.obj"), mesh), FileError);
    EXPECT_THROW(save_textured(folder.path("m.obj"), mesh, 1025), std::invalid_argument);
    EXPECT_THROW(save_textured(folder.path("m.obj"), mesh, -1), std::invalid_argument);
    const auto refuses = [&](const char* what, auto spoil) {
        TexturedMesh bad = mesh;
        spoil(bad);
        EXPECT_THROW(save_textured(folder.path("m.obj"), bad), std::invalid_argument) << what;
    };
    refuses("point", [](TexturedMesh& m) { m.corners[3].point = 8; });
    refuses("negative point", [](TexturedMesh& m) { m.corners[3].point = -1; });
    refuses("coordinates", [](TexturedMesh& m) { m.uv.pop_back(); });
    refuses("no face", [](TexturedMesh& m) { m.face_start.clear(); });
    refuses("left-over corners", [](TexturedMesh& m) { m.face_start.pop_back(); });
    refuses("two corners", [](TexturedMesh& m) { m.face_start[1] = 2; });
    refuses("descending", [](TexturedMesh& m) { std::swap(m.face_start[2], m.face_start[3]); });
    refuses("NaN", [](TexturedMesh& m) { m.uv[0][1] = std::numeric_limits<double>::quiet_NaN(); });
    refuses("infinite", [](TexturedMesh& m) { m.points[0][1] = std::numeric_limits<double>::infinity(); });
    EXPECT_FALSE(std::filesystem::exists(folder.path("m.obj")));
}

}  // namespace
}  // namespace ricci
