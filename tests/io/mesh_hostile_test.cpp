// Files made to take time or memory: what they may take is bounded by their size.
#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/repair/repair_triangles.h"

namespace ricci {
namespace {

std::string packed(const std::string& text) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY), Z_OK);
    std::string out(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

/// A flat grid of n by n quads, most of whose bytes repeat.
std::string grid(int n) {
    std::string text = "OFF\n" + std::to_string((n + 1) * (n + 1)) + " " + std::to_string(n * n) + " 0\n";
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) text += std::to_string(i) + " " + std::to_string(j) + " 0\n";
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int v = i * (n + 1) + j;
            for (const int corner : {4, v, v + n + 1, v + n + 2, v + 1}) text += std::to_string(corner) + " ";
            text += "\n";
        }
    return text;
}

struct UnpackLimit {
    explicit UnpackLimit(std::uint64_t bytes) { set_max_unpacked(bytes); }
    ~UnpackLimit() { set_max_unpacked(0); }
    UnpackLimit(const UnpackLimit&) = delete;
    UnpackLimit& operator=(const UnpackLimit&) = delete;
};

TEST(GzipLimit, IsTheLargerOf64MebibytesAnd200TimesTheFile) {
    EXPECT_EQ(unpack_limit(0), std::size_t{64} << 20U);
    EXPECT_EQ(unpack_limit(1'000'000), 200'000'000U);
    EXPECT_EQ(unpack_limit(std::size_t{1} << 40U), std::size_t{1} << 34U);
    const UnpackLimit raised(std::uint64_t{1} << 40U);
    EXPECT_EQ(unpack_limit(0), std::size_t{1} << 34U);
}

TEST(GzipLimit, RefusesABombAndNamesTheFlag) {
    const std::string bomb = packed(std::string(std::size_t{100} << 20U, '\n'));
    ASSERT_LT(bomb.size() * 200, std::size_t{64} << 20U);
    try {
        load_mesh_bytes("bomb.off.gz", bomb);
        FAIL() << "unpacked";
    } catch (const FileError& error) {
        EXPECT_EQ(std::string(error.what()),
                  "bomb.off.gz: unpacks to more than 67108864 bytes, the limit for a file of this size; "
                  "--max-unpacked raises it (at most 16G)");
    }
    const UnpackLimit raised(std::uint64_t{200} << 20U);
    const LoadedMesh loaded = load_mesh_bytes("bomb.off.gz", bomb);  // unpacked: 100 MiB of empty lines
    ASSERT_EQ(loaded.report.errors.size(), 1U);
    EXPECT_EQ(loaded.report.errors[0].code, "truncated");
}

TEST(GzipLimit, LeavesCompressibleMeshesAlone) {
    const std::string text = grid(200), gz = packed(text);
    EXPECT_TRUE(load_mesh_bytes("grid.off.gz", gz).report.errors.empty());
    // By the ratio alone: as if there were no floor.
    EXPECT_LT(text.size(), 200 * gz.size());
}

TEST(GzipLimit, IsAsFastForManyMembersAsForOne) {
    std::string members;
    const std::string empty = packed("");
    for (int i = 0; i < 200'000; ++i) members += empty;  // used to take a mebibyte's clearing each
    members += packed(grid(2));
    EXPECT_TRUE(load_mesh_bytes("many.off.gz", members).report.errors.empty());
}

TEST(Lengths, BeyondDoubleAreDefects) {
    const LoadedMesh mesh = load_mesh_bytes("far.obj", "v -1.7e308 0 0\nv 1.7e308 0 0\nv 0 1 0\nf 1 2 3\n");
    ASSERT_EQ(mesh.report.errors.size(), 1U);
    EXPECT_EQ(mesh.report.errors[0].code, "not_finite");
    EXPECT_EQ(mesh.report.errors[0].element, "edge");
    EXPECT_EQ(mesh.report.errors[0].message,
              "edge (0, 1) of face 0 is longer than the range of double precision; scale the mesh down");
}

TEST(FlatRounds, FallWithTheNumberOfFaces) {
    EXPECT_EQ(flat_rounds(0), 1000U);
    EXPECT_EQ(flat_rounds(10'000), 1000U);
    EXPECT_EQ(flat_rounds(100'000), 100U);
    EXPECT_EQ(flat_rounds(700'000'000), 20U);
}

TEST(PlyHeader, OfAHundredThousandPropertiesIsRead) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n";
    for (int i = 0; i < 100'000; ++i)
        text += "property float p" + std::to_string(i) + "\n";  // used to be quadratic
    const LoadedMesh mesh = load_mesh_bytes("wide.ply", text + "element face 0\nend_header\n");
    ASSERT_EQ(mesh.report.errors.size(), 1U);
    EXPECT_EQ(mesh.report.errors[0].code, "no_faces");
    const LoadedMesh twice = load_mesh_bytes("twice.ply", text + "property int p7\nend_header\n");
    ASSERT_EQ(twice.report.errors.size(), 1U);
    EXPECT_EQ(twice.report.errors[0].message, "line 100007: property 'p7' is declared twice");
}

}  // namespace
}  // namespace ricci
