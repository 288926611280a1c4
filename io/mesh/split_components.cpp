#include "io/mesh/split_components.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

struct Part {
    std::vector<Index> tail, twin;
    SurfaceMesh mesh;
};

}  // namespace

std::vector<SurfaceMesh> split_components(SurfaceMesh mesh) {
    const Connectivity& c = mesh.connectivity;
    if (mesh.input_vertex.empty()) {
        mesh.input_vertex.resize(at(c.vertex_count));
        std::iota(mesh.input_vertex.begin(), mesh.input_vertex.end(), Index{0});
    }
    const std::vector<Index> component = face_components(c);
    const Index count = component.empty() ? 0 : *std::max_element(component.begin(), component.end()) + 1;
    std::vector<SurfaceMesh> meshes;
    if (count <= 1) {
        meshes.push_back(std::move(mesh));
        return meshes;
    }
    std::vector<Index> owner(at(c.vertex_count), -1);  // component of a vertex
    for (Index h = 0; h < c.halfedge_count(); ++h) owner[at(c.tail[at(h)])] = component[at(face_of(h))];
    std::vector<Part> parts(at(count));
    std::vector<Index> vertex(at(c.vertex_count), -1);  // number within its component
    for (std::size_t v = 0; v < owner.size(); ++v) {
        if (owner[v] < 0) continue;
        SurfaceMesh& part = parts[at(owner[v])].mesh;
        vertex[v] = static_cast<Index>(part.input_vertex.size());
        part.input_vertex.push_back(mesh.input_vertex[v]);
        if (!mesh.intrinsic()) part.points.push_back(mesh.points[v]);
    }
    std::vector<Index> face(component.size());  // number within its component
    std::vector<Index> faces(at(count), 0);
    for (std::size_t f = 0; f < face.size(); ++f) face[f] = faces[at(component[f])]++;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        Part& part = parts[at(component[at(face_of(h))])];
        const Index t = c.twin[at(h)];
        part.tail.push_back(vertex[at(c.tail[at(h)])]);
        part.twin.push_back(t == kNoTwin ? kNoTwin : 3 * face[at(face_of(t))] + t % 3);
        part.mesh.edge_length.push_back(mesh.edge_length[at(h)]);
    }
    for (Part& part : parts) {
        part.mesh.connectivity = connectivity_from_gluing(std::move(part.tail), std::move(part.twin),
                                                          static_cast<Index>(part.mesh.input_vertex.size()));
        meshes.push_back(std::move(part.mesh));
    }
    return meshes;
}

}  // namespace ricci
