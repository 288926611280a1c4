// Files cut off at every byte, and files with every byte changed: never a crash, never half a mesh taken for
// a whole.
#include <gtest/gtest.h>

#include <array>

#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the helpers of this folder

struct Sample {
    const char* name;
    std::string bytes;
    bool counted;  // the format tells how many faces there are, or where they end
};

std::vector<Sample> samples() {
    return {{"t.obj", tetrahedron_obj(), false},           {"t.off", tetrahedron_off(), true},
            {"a.ply", tetrahedron_ply_ascii(), true},      {"l.ply", tetrahedron_ply_binary(false), true},
            {"b.ply", tetrahedron_ply_binary(true), true}, {"a.stl", tetrahedron_stl_ascii(), true},
            {"b.stl", tetrahedron_stl_binary(), true},     {"t.len", torus_len(), true}};
}

TEST(MeshTruncation, NoHalfFileIsAccepted) {
    for (const Sample& sample : samples()) {
        const LoadedMesh whole = load_bytes(sample.name, sample.bytes);
        ASSERT_EQ(error_codes(whole), "") << sample.name;
        for (std::size_t n = 0; n < sample.bytes.size(); ++n) {
            const LoadedMesh cut = load_bytes(sample.name, sample.bytes.substr(0, n));
            ASSERT_EQ(cut.components.empty(), !cut.report.errors.empty());
            if (!cut.report.errors.empty() || !sample.counted) continue;
            // Digits of the last number, or the name behind endsolid, may be missing, which nothing can tell.
            EXPECT_EQ(cut.report.faces, whole.report.faces) << sample.name << " cut to " << n;
            EXPECT_GE(n + 14, sample.bytes.size()) << sample.name;
        }
    }
}

TEST(MeshTruncation, ChangedBytesNeverCrash) {
    constexpr std::array<char, 7> kValues = {'\0', '\xff', '9', '-', ' ', '\n', '#'};
    for (const Sample& sample : samples()) {
        int rejected = 0;
        for (std::size_t n = 0; n < sample.bytes.size(); ++n) {
            for (const std::size_t pick : {n, n / 7 + 3}) {
                std::string bytes = sample.bytes;
                bytes[n] = kValues[pick % kValues.size()];
                const LoadedMesh mesh = load_bytes(sample.name, bytes, {true, true, true});
                ASSERT_EQ(mesh.components.empty(), !mesh.report.errors.empty());
                rejected += mesh.components.empty() ? 1 : 0;
                for (const SurfaceMesh& part : mesh.components) {
                    ASSERT_STREQ(check_connectivity(part.connectivity), "") << sample.name << " byte " << n;
                }
            }
        }
        EXPECT_GT(rejected, 5) << sample.name;  // of binary STL, only counts and repeated corners can tell
    }
}

}  // namespace
}  // namespace ricci
