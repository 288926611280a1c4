#include <filesystem>
#include <string>

#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/formats/mesh_text.h"
#include "io/mesh/mesh_file.h"

namespace ricci {
namespace {

Index vertex_count(const SurfaceMesh& mesh) {
    return mesh.connectivity.vertex_count;
}

void write_points(MeshText& out, const SurfaceMesh& mesh, const char* prefix) {
    for (const Point& p : mesh.points) out << prefix << p[0] << " " << p[1] << " " << p[2] << "\n";
}

void write_triangles(MeshText& out, const SurfaceMesh& mesh, const char* prefix, Index base) {
    for (const Triangle& t : triangles_of(mesh.connectivity)) {
        out << prefix << t[0] + base << " " << t[1] + base << " " << t[2] + base << "\n";
    }
}

void write_off(MeshText& out, const SurfaceMesh& mesh) {
    out << "OFF\n" << vertex_count(mesh) << " " << mesh.connectivity.face_count() << " 0\n";
    write_points(out, mesh, "");
    write_triangles(out, mesh, "3 ", 0);
}

void write_obj(MeshText& out, const SurfaceMesh& mesh) {
    write_points(out, mesh, "v ");
    write_triangles(out, mesh, "f ", 1);
}

void write_ply(MeshText& out, const SurfaceMesh& mesh) {
    out << "ply\nformat ascii 1.0\nelement vertex " << vertex_count(mesh)
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
        << mesh.connectivity.face_count() << "\nproperty list uchar int vertex_indices\nend_header\n";
    write_points(out, mesh, "");
    write_triangles(out, mesh, "3 ", 0);
}

void write_len(MeshText& out, const SurfaceMesh& mesh) {
    const Connectivity& c = mesh.connectivity;
    out << c.vertex_count << " " << c.face_count() << "\n";
    for (std::size_t f = 0; f < c.tail.size() / 3; ++f) {
        for (std::size_t k = 0; k < 3; ++k) out << c.tail[3 * f + k] << " ";
        for (std::size_t k = 0; k < 3; ++k) out << mesh.edge_length[3 * f + k] << " ";
        for (std::size_t k = 0; k < 3; ++k) out << c.twin[3 * f + k] << (k < 2 ? " " : "\n");
    }
}

}  // namespace

void save_mesh(const std::string& path, const SurfaceMesh& mesh) {
    std::string suffix = std::filesystem::path(path).extension().string();
    for (char& c : suffix) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c + ('a' - 'A')) : c;
    MeshText out;
    if (suffix == ".len") {
        write_len(out, mesh);
    } else if (suffix != ".off" && suffix != ".obj" && suffix != ".ply") {
        throw FileError(path + ": meshes are written as .off, .obj, .ply or .len");
    } else if (mesh.intrinsic()) {
        throw FileError(path + ": an intrinsic surface has no points; it can only be written as .len");
    } else if (suffix == ".off") {
        write_off(out, mesh);
    } else if (suffix == ".obj") {
        write_obj(out, mesh);
    } else {
        write_ply(out, mesh);
    }
    write_file_bytes(path, out.text());
}

}  // namespace ricci
