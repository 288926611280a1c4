// Small mesh files made by the tests.
#pragma once

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace ricci::testing {

/// A folder of its own that disappears with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("ricci_mesh_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }

    [[nodiscard]] std::string write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }

  private:
    std::filesystem::path path_;
};

/// Loads `bytes` as if they came from a file of that name.
inline LoadedMesh load_bytes(const std::string& name, const std::string& bytes,
                             const RepairOptions& repair = {}) {
    return load_mesh_bytes(name, bytes, repair);
}

/// The codes of some defects, each once, in order of first occurrence, separated by blanks.
inline std::string codes_of(const std::vector<Defect>& defects) {
    std::vector<std::string> codes;
    for (const Defect& defect : defects) {
        if (std::find(codes.begin(), codes.end(), defect.code) == codes.end()) codes.push_back(defect.code);
    }
    std::string text;
    for (const std::string& code : codes) text += (text.empty() ? "" : " ") + code;
    return text;
}
inline std::string error_codes(const LoadedMesh& mesh) {
    return codes_of(mesh.report.errors);
}
inline std::string note_codes(const LoadedMesh& mesh) {
    return codes_of(mesh.report.notes);
}

/// The bytes as one gzip member.
inline std::string gzip(const std::string& bytes) {
    z_stream stream{};
    deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    std::string packed(deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

/// Appends a value in the given byte order.
template <class T>
void append_value(std::string& bytes, T value, bool big_endian = false) {
    char raw[sizeof(T)];
    const auto* from = reinterpret_cast<const char*>(&value);
    std::copy(from, from + sizeof(T), raw);
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
}

/// A tetrahedron (V=4, E=6, F=4) in every format.
inline std::string tetrahedron_obj() {
    return "# tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
}
inline std::string tetrahedron_off() {
    return "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
}
inline std::string tetrahedron_ply_header(const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment made by a test\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
           "float z\n"
           "property uchar red\nelement face 4\nproperty list uchar float texcoord\nproperty list uchar int "
           "vertex_indices\nproperty short flags\nend_header\n";
}
inline std::string tetrahedron_ply_ascii() {
    return tetrahedron_ply_header("ascii") +
           "0 0 0 1\n1 0 0 2\n0 1 0 3\n0 0 1 4\n2 0.5 0.5 3 0 2 1 -7\n0 3 0 1 3 -7\n1 2 3 1 2 3 -7\n0 3 2 0 "
           "3 -7\n";
}
inline std::string tetrahedron_ply_binary(bool big_endian) {
    std::string bytes = tetrahedron_ply_header(big_endian ? "binary_big_endian" : "binary_little_endian");
    for (int v = 0; v < 4; ++v) {
        for (int k = 1; k < 4; ++k) append_value<float>(bytes, v == k ? 1.0F : 0.0F, big_endian);
        append_value<std::uint8_t>(bytes, 200);
    }
    const std::int32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    for (const auto& face : faces) {
        append_value<std::uint8_t>(bytes, 2);
        for (int k = 0; k < 2; ++k) append_value<float>(bytes, 0.5F, big_endian);
        append_value<std::uint8_t>(bytes, 3);
        for (const std::int32_t v : face) append_value<std::int32_t>(bytes, v, big_endian);
        append_value<std::int16_t>(bytes, -7, big_endian);
    }
    return bytes;
}
inline const std::vector<std::vector<int>>& tetrahedron_faces() {
    static const std::vector<std::vector<int>> faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return faces;
}
inline std::string tetrahedron_stl_ascii() {
    std::string text = "solid tetrahedron facet\n";
    for (const auto& face : tetrahedron_faces()) {
        text += "  facet normal 0 0 nan\n    outer loop\n";
        for (const int v : face) {
            for (int k = 0; k < 4; ++k) text += k == 0 ? "      vertex" : v == k ? " 1" : " -0.0";
            text += "\n";
        }
        text += "    endloop\n  endfacet\n";
    }
    return text + "endsolid tetrahedron\n";
}
inline std::string tetrahedron_stl_binary() {
    std::string bytes = "solid binary, in spite of the word before";
    bytes.resize(80, ' ');
    append_value<std::uint32_t>(bytes, 4);
    for (const auto& face : tetrahedron_faces()) {
        for (int k = 0; k < 3; ++k) append_value<float>(bytes, 0.0F);
        for (const int v : face) {
            for (int k = 1; k < 4; ++k) append_value<float>(bytes, v == k ? 1.0F : 0.0F);
        }
        append_value<std::uint16_t>(bytes, 0);
    }
    return bytes;
}
/// A torus with one vertex, two faces and three loops.
inline std::string torus_len() {
    return "# one vertex\n1 2\n0 0 0 1 1 1.25 3 4 5\n0 0 0 1 1 1.25 0 1 2\n";
}

}  // namespace ricci::testing
