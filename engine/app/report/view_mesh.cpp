#include "engine/app/report/view_mesh.h"

#include <limits>

#include "engine/remesh/nearest_vertex.h"
#include "engine/remesh/openmesh.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Without vertices that no face uses, which would be framed but not seen.
void take_used(const SurfaceMesh& mesh, ViewMesh& view) {
    const std::vector<std::uint8_t> used = used_vertices(mesh.connectivity);
    std::vector<Index> number(used.size(), -1);
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        number[v] = static_cast<Index>(view.points.size());
        view.points.push_back(mesh.points[v]);
        view.vertex.push_back(static_cast<Index>(v));
    }
    view.triangles = triangles_of(mesh.connectivity);
    for (Triangle& t : view.triangles)
        for (Index& v : t) v = number[at(v)];
}

}  // namespace

ViewMesh make_view_mesh(const SurfaceMesh& mesh, Index budget) {
    ViewMesh view;
    view.faces = mesh.connectivity.face_count();
    view.decimated = view.faces > budget;
    if (!view.decimated) {
        take_used(mesh, view);
        view.shown = view.points.size();
        return view;
    }
    take_used(decimate(mesh, budget), view);
    view.decimated = static_cast<Index>(view.triangles.size()) < view.faces;
    view.vertex = nearest_vertices(mesh, view.points);
    view.shown = view.points.size();
    return view;
}

void add_vertices(ViewMesh& view, const SurfaceMesh& mesh, const std::vector<Index>& vertices) {
    if (!view.decimated) return;
    for (const Index v : vertices) {
        view.points.push_back(mesh.points[at(v)]);
        view.vertex.push_back(v);
    }
}

std::vector<double> seen_values(const ViewMesh& view, const std::vector<double>& values) {
    std::vector<double> seen;
    seen.reserve(view.vertex.size());
    for (const Index v : view.vertex)
        seen.push_back(values.empty() ? std::numeric_limits<double>::quiet_NaN() : values[at(v)]);
    return seen;
}

}  // namespace ricci::app
