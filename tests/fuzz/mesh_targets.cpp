// Mesh files of every format, without repairs and with all of them.
#include <cmath>

#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/mesh_file.h"
#include "kernels/surface_mesh.h"
#include "tests/fuzz/allocation_meter.h"
#include "tests/fuzz/fuzz_targets.h"

namespace ricci::fuzz {
namespace {

void check_defects(const std::vector<Defect>& defects) {
    for (const Defect& defect : defects) {
        require(!defect.code.empty() && !defect.element.empty() && !defect.message.empty(),
                "a defect without code, element or message");
        require(defect.index >= -1, "a defect of element " + std::to_string(defect.index));
        require(defect.message.size() < 4096,
                "a message of " + std::to_string(defect.message.size()) + " bytes");
    }
}

void check_surface(const SurfaceMesh& mesh) {
    const Connectivity& c = mesh.connectivity;
    require(*check_connectivity(c) == '\0', std::string("broken connectivity: ") + check_connectivity(c));
    require(c.face_count() > 0, "a surface without faces");
    require(mesh.edge_length.size() == c.tail.size(), "not one length per halfedge");
    for (std::size_t h = 0; h < c.tail.size(); ++h) {
        const double length = mesh.edge_length[h];
        require(std::isfinite(length) && length > 0,
                "halfedge " + std::to_string(h) + " has length " + std::to_string(length));
        if (c.twin[h] != kNoTwin)
            require(mesh.edge_length[static_cast<std::size_t>(c.twin[h])] == length,
                    "twins differ in length");
    }
    require(mesh.input_vertex.size() == static_cast<std::size_t>(c.vertex_count),
            "not one number per vertex");
    require(mesh.intrinsic() || mesh.points.size() == mesh.input_vertex.size(), "not one point per vertex");
    const Topology topology = topology_of(c);
    require(topology.components == 1 && topology.genus >= 0 && topology.boundaries >= 0,
            "impossible topology");
    require(face_areas(mesh).size() == static_cast<std::size_t>(c.face_count()), "not one area per face");
}

void check_loaded(const LoadedMesh& mesh) {
    require(mesh.components.empty() != mesh.report.errors.empty(), "neither a surface nor an error, or both");
    check_defects(mesh.report.errors);
    check_defects(mesh.report.notes);
    for (const SurfaceMesh& component : mesh.components) check_surface(component);
}

/// What the bytes unpack to at most: deflate makes of one byte no more than 1032.
std::size_t unpacked_size(const std::string& path, std::size_t size) {
    return path.ends_with(".gz") ? size + std::min(unpack_limit(size), 1032 * size) : size;
}

void load(const std::string& path, Bytes bytes) {
    for (const RepairOptions& repair : {RepairOptions{}, RepairOptions{true, true, true}}) {
        std::string text = text_of(bytes);
        LoadedMesh mesh;
        {
            const AllocationMeter meter(memory_allowed(unpacked_size(path, bytes.size())));
            try {
                mesh = load_mesh_bytes(path, std::move(text), repair);
            } catch (const FileError& error) {
                require(std::string_view(error.what()).starts_with(path), "a FileError that names no file");
                continue;
            }
        }
        check_loaded(mesh);
    }
}

}  // namespace

void read_obj(Bytes bytes) {
    load("mesh.obj", bytes);
}
void read_off(Bytes bytes) {
    load("mesh.off", bytes);
}
void read_ply(Bytes bytes) {
    load("mesh.ply", bytes);
}
void read_stl(Bytes bytes) {
    load("mesh.stl", bytes);
}
void read_len(Bytes bytes) {
    load("mesh.len", bytes);
}
void read_gzip(Bytes bytes) {
    load("mesh.off.gz", bytes);
    load("mesh.stl.gz", bytes);
}

}  // namespace ricci::fuzz
