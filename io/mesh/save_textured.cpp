#include "io/mesh/save_textured.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/formats/mesh_text.h"
#include "io/mesh/mesh_file.h"
#include "io/picture/checker_image.h"

namespace ricci {
namespace {

constexpr int kMaximalSquares = 1024;

void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("a textured mesh: ") + what);
}

template <std::size_t N>
bool all_finite(const std::vector<std::array<double, N>>& rows) {
    return std::all_of(rows.begin(), rows.end(), [](const auto& row) {
        return std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); });
    });
}

void require_valid(const TexturedMesh& mesh) {
    const auto below = [](Index i, std::size_t count) {
        return i >= 0 && static_cast<std::size_t>(i) < count;
    };
    require(all_finite(mesh.points) && all_finite(mesh.uv), "a coordinate is not finite");
    require(!mesh.face_start.empty() && mesh.face_start.front() == 0 &&
                static_cast<std::size_t>(mesh.face_start.back()) == mesh.corners.size(),
            "the faces do not hold all corners");
    for (std::size_t f = 0; f + 1 < mesh.face_start.size(); ++f)
        require(mesh.face_start[f + 1] >= mesh.face_start[f] + 3, "a face has fewer than three corners");
    for (const TexturedCorner& corner : mesh.corners)
        require(below(corner.point, mesh.points.size()) &&
                    (corner.uv == kNoTexture || below(corner.uv, mesh.uv.size())),
                "a corner names a point or coordinates that do not exist");
}

std::string obj_text(const TexturedMesh& mesh, const std::string& material_file) {
    MeshText out;
    if (!material_file.empty()) out << "mtllib " << material_file << "\n";
    for (const Point& p : mesh.points) out << "v " << p[0] << " " << p[1] << " " << p[2] << "\n";
    for (const auto& uv : mesh.uv) out << "vt " << uv[0] << " " << uv[1] << "\n";
    if (!material_file.empty()) out << "usemtl checkerboard\n";
    for (std::size_t f = 0; f + 1 < mesh.face_start.size(); ++f) {
        out << "f";
        for (Index i = mesh.face_start[f]; i < mesh.face_start[f + 1]; ++i) {
            const TexturedCorner& corner = mesh.corners[static_cast<std::size_t>(i)];
            out << " " << corner.point + 1;
            if (corner.uv != kNoTexture) out << "/" << corner.uv + 1;
        }
        out << "\n";
    }
    return out.text();
}

}  // namespace

void save_textured(const std::string& path, const TexturedMesh& mesh, int checker_squares) {
    std::filesystem::path file(path);
    if (file.extension() != ".obj" && file.extension() != ".OBJ")
        throw FileError(path + ": textured surfaces are written as .obj");
    require_valid(mesh);
    require(checker_squares >= 0 && checker_squares <= kMaximalSquares,
            "the checkerboard has between 0 and 1024 squares along a side");
    if (checker_squares == 0) return write_file_bytes(path, obj_text(mesh, ""));
    const std::string material = file.replace_extension(".mtl").string();
    const std::string image = file.replace_extension(".png").string();
    const std::string image_name = file.filename().string();
    write_file_bytes(image, checker_png(checker_squares));
    write_file_bytes(
        material, "newmtl checkerboard\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd " + image_name + "\n");
    write_file_bytes(path, obj_text(mesh, std::filesystem::path(material).filename().string()));
}

}  // namespace ricci
