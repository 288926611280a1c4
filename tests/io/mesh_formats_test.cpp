// Every format, its variants, and what is wrong with files that cannot be read.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <clocale>
#include <cmath>

#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the helpers of this folder

struct Sample {
    const char* name;
    std::string bytes;
};

std::vector<Sample> tetrahedra() {
    return {{"t.obj", tetrahedron_obj()},
            {"t.off", tetrahedron_off()},
            {"a.ply", tetrahedron_ply_ascii()},
            {"l.ply", tetrahedron_ply_binary(false)},
            {"b.ply", tetrahedron_ply_binary(true)},
            {"a.stl", tetrahedron_stl_ascii()},
            {"b.stl", tetrahedron_stl_binary()}};
}

void expect_tetrahedron(const LoadedMesh& mesh, const std::string& name) {
    ASSERT_EQ(error_codes(mesh), "") << name << ": " << mesh.report.errors.front().message;
    ASSERT_EQ(mesh.components.size(), 1U) << name;
    EXPECT_EQ(mesh.report.vertices, 4) << name;
    EXPECT_EQ(mesh.report.edges, 6) << name;
    EXPECT_EQ(mesh.report.faces, 4) << name;
    EXPECT_EQ(mesh.report.genus, 0) << name;
    EXPECT_EQ(mesh.report.boundaries, 0) << name;
    EXPECT_EQ(mesh.report.euler_characteristic, 2) << name;
    EXPECT_EQ(mesh.report.manifold, true) << name;
    EXPECT_EQ(mesh.report.oriented, true) << name;
    EXPECT_NEAR(*mesh.report.min_angle_deg, 45, 1e-12) << name;
    EXPECT_EQ(mesh.report.obtuse_fraction, 0) << name;
    EXPECT_STREQ(check_connectivity(mesh.components[0].connectivity), "") << name;
}

/// Where the error is: "code line" or "code element index".
std::string first_error(const LoadedMesh& mesh) {
    if (mesh.report.errors.empty()) return "";
    const Defect& defect = mesh.report.errors.front();
    return defect.code + " " + defect.element + " " + std::to_string(defect.index);
}

std::string error_of(const std::string& name, const std::string& bytes) {
    const LoadedMesh mesh = load_bytes(name, bytes);
    EXPECT_EQ(mesh.components.empty(), !mesh.report.errors.empty());
    return first_error(mesh);
}

TEST(MeshFormats, TetrahedronInEveryFormat) {
    for (const Sample& sample : tetrahedra())
        expect_tetrahedron(load_bytes(sample.name, sample.bytes), sample.name);
}

TEST(MeshFormats, TetrahedronPackedWithGzip) {
    for (const Sample& sample : tetrahedra()) {
        const LoadedMesh mesh = load_bytes(std::string(sample.name) + ".gz", gzip(sample.bytes));
        expect_tetrahedron(mesh, sample.name);
        EXPECT_EQ(mesh.stem, std::string(sample.name).substr(0, 1));
    }
}

TEST(MeshFormats, EveryLineEnding) {
    for (const char* ending : {"\r\n", "\r"}) {
        for (const Sample& sample : tetrahedra()) {
            if (sample.bytes.find('\0') != std::string::npos || sample.name[0] == 'b' ||
                sample.name[0] == 'l')
                continue;
            std::string text;
            for (const char c : sample.bytes) c == '\n' ? text += ending : text += c;
            expect_tetrahedron(load_bytes(sample.name, text), sample.name);
        }
    }
}

TEST(MeshFormats, FilesAreReadAsTheyAre) {
    const TemporaryFolder folder;
    for (const Sample& sample : tetrahedra()) {
        const LoadedMesh mesh = load_mesh(folder.write(sample.name, sample.bytes));
        expect_tetrahedron(mesh, sample.name);
        EXPECT_EQ(mesh.report.file, folder.path(sample.name));
        EXPECT_EQ(mesh.content_hash, XXH3_64bits(sample.bytes.data(), sample.bytes.size()));
    }
}

TEST(MeshFormats, HashAndStemAreOfTheStoredFile) {
    const std::string packed = gzip(tetrahedron_off());
    const LoadedMesh mesh = load_bytes("My.Mesh.OFF.GZ", packed);
    EXPECT_EQ(mesh.content_hash, XXH3_64bits(packed.data(), packed.size()));
    EXPECT_EQ(mesh.stem, "My.Mesh");
    EXPECT_EQ(error_codes(mesh), "");
}

TEST(MeshFormats, NumbersDoNotDependOnTheLocale) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE"}) std::setlocale(LC_ALL, name);
    const LoadedMesh mesh = load_bytes("t.obj", "v 0.5 0 0\nv 1.5e0 0 0\nv 0 +1.25 0\nf 1 2 3\n");
    std::setlocale(LC_ALL, before.c_str());
    ASSERT_EQ(mesh.components.size(), 1U);
    EXPECT_EQ(mesh.components[0].points, (std::vector<Point>{{0.5, 0, 0}, {1.5, 0, 0}, {0, 1.25, 0}}));
}

TEST(MeshFormats, ObjVariants) {
    const std::string points = "v 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.1 0.2 0.3\nv 0 1 0\n";
    for (const char* faces :
         {"f 1 2 3 4\n", "f 1/1 2/2 3/3 4/4\n", "f 1//7 2//7 3// 4/\n", "f -4 -3 -2 -1\n", "f 1 2 \\\n 3 4\n",
          "f 1/2/3 2/2/3 3/2/3 4/2/3", "g a\ns off\nf 1 2 3 # c\nf\t1 3 4"}) {
        const LoadedMesh mesh = load_bytes("q.obj", points + faces);
        EXPECT_EQ(error_codes(mesh), "") << faces;
        EXPECT_EQ(mesh.report.faces, 2) << faces;
        EXPECT_EQ(mesh.report.edges, 5) << faces;
    }
    EXPECT_EQ(note_codes(load_bytes("q.obj", points + "f 1 2 3 4\nl 1 2\np 3\n")),
              "ignored_elements triangulated");
}

TEST(MeshFormats, ObjErrors) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_EQ(error_of("t.obj", points + "f 1 2 9\n"), "index_out_of_range face 0");
    EXPECT_EQ(error_of("t.obj", points + "f 1 2 3\nf 0 1 2\n"), "index_out_of_range face 1");
    EXPECT_EQ(error_of("t.obj", points + "f 1 2 -4\n"), "index_out_of_range face 0");
    EXPECT_EQ(error_of("t.obj", points + "f 4294967297 2 3\n"), "index_out_of_range face 0");
    EXPECT_EQ(error_of("t.obj", points + "f 99999999999999999999 2 3\n"), "syntax line 4");
    EXPECT_EQ(error_of("t.obj", points + "f 1 2\n"), "too_few_corners face 0");
    EXPECT_EQ(error_of("t.obj", points + "f 1/2/3/4 2 3\n"), "syntax line 4");
    EXPECT_EQ(error_of("t.obj", points + "f 1.0 2 3\n"), "syntax line 4");
    EXPECT_EQ(error_of("t.obj", points + "hello\n"), "syntax line 4");
    EXPECT_EQ(error_of("t.obj", points), "no_faces file -1");
    EXPECT_EQ(error_of("t.obj", points + "curv 0 1 2\n"), "unsupported_format line 4");
    EXPECT_EQ(error_of("t.obj", points + "f 1 2 \\"), "truncated line 4");
    EXPECT_EQ(error_of("t.obj", "v 0 0\n"), "syntax line 1");
    EXPECT_EQ(error_of("t.obj", "v 0,5 0 0\n"), "syntax line 1");
    EXPECT_EQ(error_of("t.obj", ""), "truncated file -1");
}

TEST(MeshFormats, NumbersBeyondDoubleAreNotFinite) {
    const auto error = [](const std::string& number) {
        return error_of("t.obj", "v 1 1 1\nv " + number + " 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n");
    };
    for (const char* number : {"nan", "NaN", "-nan", "inf", "-Infinity", "1e400", "-1e400",
                               "1e99999999999999999999", "1.#QNAN", "-1.#IND", "1.#INF"}) {
        EXPECT_EQ(error(number), "not_finite vertex 1") << number;
    }
    const std::string huge(400, '9');
    EXPECT_EQ(error(huge), "not_finite vertex 1");
    for (const std::string number :
         {"1e-400", "-1e-400", "1e-99999999999999999999", "0e999", "1e-310", "+.5"}) {
        EXPECT_EQ(error(number), "") << number;
    }
    EXPECT_EQ(error("0." + std::string(400, '0') + "1"), "");
    for (const char* number : {"0x10", "1e", "1d0", "--1", "+-1", "1_0", "."}) {
        EXPECT_EQ(error(number), "syntax line 2") << number;
    }
}

TEST(MeshFormats, OffVariants) {
    const char* const points = "0 0 0\n1 0 0\n0 1 0\n";
    const std::string headers[] = {"OFF\n3 1 0\n", "OFF 3 1 0\n", "  OFF3 1 0 # glued\n",
                                   "3 1 0\n",      "OFF\n3 1\n",  "# c\n\nOFF # c\n# c\n3 1 3\n"};
    for (const std::string& header : headers) {
        EXPECT_EQ(error_of("t.off", header + points + "3 0 1 2\n"), "") << header;
    }
    for (const char* colour : {"", " 5", " 255 0 0", " 1.0 0 0 0.5", " 0 0 0#glued"}) {
        EXPECT_EQ(error_of("t.off", "OFF\n3 1 0\n" + std::string(points) + "3 0 1 2" + colour), "") << colour;
    }
    EXPECT_EQ(error_of("t.off", "COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 1 0 0\n0 1 0 1 0 0\n3 0 1 2\n"), "");
    EXPECT_EQ(error_of("t.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"), "");
    EXPECT_EQ(error_of("t.off", "STOFF\n3 1 0\n0 0 0 .1 .2\n1 0 0 0 0\n0 1 0 1 1\n3 0 1 2\n"), "");
}

TEST(MeshFormats, OffErrors) {
    const std::string head = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(error_of("t.off", head), "truncated line 5");
    EXPECT_EQ(error_of("t.off", head + "3 0 1 3\n"), "index_out_of_range face 0");
    EXPECT_EQ(error_of("t.off", head + "3 0 1 -1\n"), "index_out_of_range face 0");
    EXPECT_EQ(error_of("t.off", head + "2 0 1\n"), "too_few_corners face 0");
    EXPECT_EQ(error_of("t.off", head + "3 0 1\n"), "syntax line 6");
    EXPECT_EQ(error_of("t.off", head + "3 0 1 2 9 9\n"), "syntax line 6");
    EXPECT_EQ(error_of("t.off", head + "-3 0 1 2\n"), "syntax line 6");
    EXPECT_EQ(error_of("t.off", head + "3 0 1 2\n3 0 1 2\n"), "syntax line 7");
    EXPECT_EQ(error_of("t.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), "no_faces file -1");
    EXPECT_EQ(error_of("t.off", "OFF\n2 1 0\n0 0 0,\n1 0 0,\n3 0 1 1\n"), "syntax line 3");
    EXPECT_EQ(error_of("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0 5\n0 1 0\n3 0 1 2\n"), "syntax line 4");
    EXPECT_EQ(error_of("t.off", "OFF\n4000000000 4000000000 0\n0 0 0\n"), "truncated line 3");
    EXPECT_EQ(error_of("t.off", "OFF BINARY\n\1\2\3"), "unsupported_format line 1");
    EXPECT_EQ(error_of("t.off", "4OFF\n3 1 0\n"), "unsupported_format line 1");
    EXPECT_EQ(error_of("t.off", "XOFF\n3 1 0\n"), "syntax line 1");
}

TEST(MeshFormats, PlyErrors) {
    const std::string face = "element face 1\nproperty list uchar int vertex_index\n";
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n";
    const std::string z = "property float z\n";
    const std::string points = "end_header\n0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(error_of("t.ply", head + z + face + points + "3 0 1 2\n"), "");
    EXPECT_EQ(error_of("t.ply", head + z + face + points + "3 0 1 2 255 0 0\n"), "syntax line 13");
    EXPECT_EQ(error_of("t.ply", head + z + face + points + "3 0 1 2\n3 0 1 2\n"), "syntax line 14");
    EXPECT_EQ(error_of("t.ply", head + z + face + points + "3 0 1 3\n"), "index_out_of_range face 0");
    EXPECT_EQ(error_of("t.ply", head + z + face + points + "-3 0 1 2\n"), "syntax line 13");
    EXPECT_EQ(error_of("t.ply", head + z + face + points), "truncated line 12");
    EXPECT_EQ(error_of("t.ply", head + face + points + "3 0 1 2\n"), "syntax line 3");
    EXPECT_EQ(error_of("t.ply", head + z + points), "no_faces file -1");
    EXPECT_EQ(error_of("t.ply", head + z + "element face 0\n" + points), "no_faces file -1");
    EXPECT_EQ(
        error_of("t.ply", head + z + "element tristrips 1\nproperty list int int vertex_indices\n" + points),
        "unsupported_format line 7");
    EXPECT_EQ(error_of("t.ply", head + z + "element face 1\nproperty int vertex_indices\n" + points + "3\n"),
              "syntax line 7");
    EXPECT_EQ(error_of("t.ply", head + "property half z\n"), "syntax line 6");
    EXPECT_EQ(error_of("t.ply", head + "property float x\n"), "syntax line 6");
    EXPECT_EQ(error_of("t.ply", head), "truncated line 5");
    EXPECT_EQ(error_of("t.ply", "ply\nformat ascii 2.0\n"), "syntax line 2");
    EXPECT_EQ(error_of("t.ply", "OFF\n"), "syntax line 1");
    // A header may promise any number of elements without properties, or of bytes that are not there.
    EXPECT_EQ(
        error_of("t.ply", head + z + face + "element nothing 4000000000000000000\n" + points + "3 0 1 2\n"),
        "");
    const std::string binary = tetrahedron_ply_binary(false);
    EXPECT_EQ(error_of("t.ply", binary + "x"), "syntax file -1");
    std::string huge = binary;
    huge.replace(huge.find("face 4"), 6, "face 4000000000");
    EXPECT_EQ(error_of("t.ply", huge), "truncated file -1");
}

TEST(MeshFormats, PlyCornerColoursOfVcglibAreSkipped) {
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 ";
    EXPECT_EQ(note_codes(load_bytes("t.ply", head + "9 1 1 1 1 1 1 1 1 1\n")), "undeclared_list");
    EXPECT_EQ(note_codes(load_bytes("t.ply", head + "9 1 1\n")), "");
    EXPECT_EQ(error_of("t.ply", head + "9 1 1 1\n"), "syntax line 16");
}

TEST(MeshFormats, StlMergesEqualCorners) {
    const LoadedMesh mesh = load_bytes("a.stl", tetrahedron_stl_ascii());
    EXPECT_EQ(note_codes(mesh), "merged_corners");
    EXPECT_NE(mesh.report.notes[0].message.find("12 STL corners"), std::string::npos);
    // Numbered by first occurrence: the first face is (0, 1, 2).
    EXPECT_EQ(triangles_of(mesh.components[0].connectivity)[0], (Triangle{0, 1, 2}));
    EXPECT_EQ(mesh.components[0].points[1], (Point{0, 1, 0}));
}

TEST(MeshFormats, StlErrors) {
    const std::string text = tetrahedron_stl_ascii();
    std::string four = text;
    four.insert(four.find("    endloop"), "vertex 5 5 5\n");
    EXPECT_EQ(error_of("t.stl", four), "syntax line 7");
    std::string comma = text;
    comma.replace(comma.find("-0.0"), 4, "-0,0");
    EXPECT_EQ(error_of("t.stl", comma), "syntax line 4");
    EXPECT_EQ(error_of("t.stl", "solid nothing\nendsolid nothing\n"), "no_faces file -1");
    std::string binary = tetrahedron_stl_binary();
    EXPECT_EQ(error_of("t.stl", binary.substr(0, binary.size() - 1)), "truncated file -1");
    EXPECT_EQ(error_of("t.stl", binary + std::string(7, '\0')), "syntax file -1");
    EXPECT_EQ(error_of("t.stl", "short"), "truncated file -1");
    binary[84 + 12 + 3] = '\x7f';  // the first coordinate becomes nan
    binary[84 + 12 + 2] = '\xc0';
    EXPECT_EQ(error_of("t.stl", binary), "not_finite face 0");
}

TEST(MeshFormats, IntrinsicTorusOfOneVertex) {
    const LoadedMesh mesh = load_bytes("t.len", torus_len());
    ASSERT_EQ(error_codes(mesh), "");
    EXPECT_EQ(mesh.report.vertices, 1);
    EXPECT_EQ(mesh.report.edges, 3);
    EXPECT_EQ(mesh.report.genus, 1);
    EXPECT_TRUE(mesh.components[0].intrinsic());
    // The angle at the base of the isosceles triangle with sides 1, 1, 1.25.
    EXPECT_NEAR(*mesh.report.min_angle_deg, std::acos(0.625) * 180 / 3.14159265358979323846, 1e-12);
    EXPECT_EQ(mesh.report.obtuse_fraction, 0);
}

TEST(MeshFormats, IntrinsicErrors) {
    const auto error = [](const std::string& text) { return error_of("t.len", text); };
    EXPECT_EQ(error("1 2\n0 0 0 1 1 1 3 4 5\n"), "truncated line 2");
    EXPECT_EQ(error("1 2\n0 0 0 1 1 1 3 4 5\n0 0 0 1 1 1 0 1 2\n0 0"), "syntax line 4");
    EXPECT_EQ(error("1 2\n0 0 0 1 1 1 3 4 5\n0 0 0 1 1 1 0 1 2 3\n"), "syntax line 3");
    EXPECT_EQ(error("1 2\n0 0 0 1 1 1 3 4 5\n0 0 1 1 1 1 0 1 2\n"), "index_out_of_range face 1");
    EXPECT_EQ(error("1 2\n0 0 0 1 1 1 3 4 6\n0 0 0 1 1 1 0 1 2\n"), "index_out_of_range face 0");
    EXPECT_EQ(error("1 2\n0 0 0 1 1 1 3 4 5\n0 0 0 1 1 1 1 0 2\n"), "twin_mismatch face 0");
    EXPECT_EQ(error("1 2\n0 0 0 1 1 1 3 4 5\n0 0 0 1 1 1.5 0 1 2\n"), "length_mismatch face 0");
    EXPECT_EQ(error("3 1\n0 1 2 1 1 2 -1 -1 -1\n"), "triangle_inequality face 0");
    EXPECT_EQ(error("3 1\n0 1 2 1 1 2.5 -1 -1 -1\n"), "triangle_inequality face 0");
    EXPECT_EQ(error("3 1\n0 1 2 1 1 1.9999999999999998 -1 -1 -1\n"), "");
    // 1 + 1.25 ulp rounds to the third side, 1 + 1 ulp, yet exceeds it.
    EXPECT_EQ(error("3 1\n0 1 2 1 2.7755575615628914e-16 1.0000000000000002 -1 -1 -1\n"), "");
    EXPECT_EQ(error("3 1\n0 1 2 1 1 0 -1 -1 -1\n"), "zero_length_edge face 0");
    EXPECT_EQ(error("3 1\n0 1 2 1 1 -1 -1 -1 -1\n"), "negative_length face 0");
    EXPECT_EQ(error("3 1\n0 1 2 1 1 nan -1 -1 -1\n"), "not_finite face 0");
    EXPECT_EQ(error("3 1\n0 1 2 1 1 1 0 -1 -1\n"), "twin_mismatch face 0");
    EXPECT_EQ(error("2 2\n0 1 0 1 1 1 3 -1 -1\n0 1 1 1 1 1 0 -1 -1\n"), "twin_mismatch face 0");
    EXPECT_EQ(error("5 2\n0 1 2 1 1 1 -1 -1 -1\n0 3 4 1 1 1 -1 -1 -1\n"), "non_manifold_vertex vertex 0");
    EXPECT_EQ(error("2000000000 1\n0 1 2 1 1 1 -1 -1 -1\n"), "syntax line 1");
    EXPECT_EQ(error("3 0\n"), "no_faces file -1");
}

TEST(MeshFormats, UnreadableFilesAreThrown) {
    const TemporaryFolder folder;
    EXPECT_THROW(load_mesh(folder.path("missing.off")), FileError);
    EXPECT_THROW(load_mesh(folder.path("")), FileError);
    const std::string packed = gzip(tetrahedron_off());
    for (std::size_t n = 0; n < packed.size(); ++n) {
        EXPECT_THROW(load_bytes("t.off.gz", packed.substr(0, n)), FileError) << n << " of " << packed.size();
    }
    std::string damaged = packed;
    damaged[packed.size() / 2] = static_cast<char>(damaged[packed.size() / 2] ^ 0x55);
    EXPECT_THROW(load_bytes("t.off.gz", damaged), FileError);
    EXPECT_THROW(load_bytes("t.off.gz", packed + "more"), FileError);
    EXPECT_THROW(load_bytes("t.off.gz", tetrahedron_off()), FileError);
}

TEST(MeshFormats, GzipMembersAreJoined) {
    const std::string text = tetrahedron_off();
    const LoadedMesh mesh = load_bytes("t.off.gz", gzip(text.substr(0, 20)) + gzip(text.substr(20)));
    expect_tetrahedron(mesh, "two members");
}

TEST(MeshFormats, UnsupportedFormatsSayWhatToDo) {
    for (const char* name : {"t.vtk", "t.mesh", "t.glb", "t.xyz", "t", "t.vtk.gz"}) {
        const bool packed = std::string(name).ends_with(".gz");
        const LoadedMesh mesh = load_bytes(name, packed ? gzip("data") : "data");
        EXPECT_EQ(error_codes(mesh), "unsupported_format") << name;
        EXPECT_NE(mesh.report.errors[0].message.find("OBJ, OFF, PLY, STL"), std::string::npos) << name;
    }
    EXPECT_EQ(error_of("t.off", gzip(tetrahedron_off())), "unsupported_format file -1");
}

TEST(MeshFormats, ByteOrderMarkIsSkipped) {
    expect_tetrahedron(load_bytes("t.off", "\xEF\xBB\xBF" + tetrahedron_off()), "with byte order mark");
}

TEST(MeshFormats, RepairWordsAreParsed) {
    const RepairOptions all = parse_repair("orient,weld,drop-degenerate");
    EXPECT_TRUE(all.orient && all.weld && all.drop_degenerate);
    const RepairOptions weld = parse_repair("weld");
    EXPECT_TRUE(!weld.orient && weld.weld && !weld.drop_degenerate);
    const RepairOptions none = parse_repair("");
    EXPECT_FALSE(none.orient || none.weld || none.drop_degenerate);
    EXPECT_THROW(parse_repair("fix"), std::invalid_argument);
    EXPECT_THROW(parse_repair("weld,"), std::invalid_argument);
    EXPECT_THROW(parse_repair("weld,,orient"), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
