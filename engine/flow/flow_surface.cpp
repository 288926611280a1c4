#include "engine/flow/flow_surface.h"

#include <numbers>

#include "kernels/extended.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The lengths of the mirror image: halfedge 3f+k is mirrored to 3(F+f)+(2-k).
template <class Real>
void mirror_lengths(std::vector<Real>& logs) {
    const std::size_t halfedges = logs.size();
    logs.resize(2 * halfedges);
    for (std::size_t h = 0; h < halfedges; ++h) logs[halfedges + 3 * (h / 3) + (2 - h % 3)] = logs[h];
}

}  // namespace

std::string_view name_of(Boundary boundary) {
    switch (boundary) {
        case Boundary::free:
            return "free";
        case Boundary::curvature:
            return "curvature";
        case Boundary::geodesic:
            break;
    }
    return "geodesic";
}

Connectivity double_of(const Connectivity& c, std::vector<Index>& orbit) {
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(c), used = used_vertices(c);
    std::vector<Index> image(at(c.vertex_count));
    orbit.resize(at(c.vertex_count));
    Connectivity result;
    result.vertex_count = c.vertex_count;
    for (Index v = 0; v < c.vertex_count; ++v) {
        orbit[at(v)] = v;
        image[at(v)] = v;
        if (used[at(v)] && !on_boundary[at(v)]) {
            image[at(v)] = result.vertex_count++;
            orbit.push_back(v);
        }
    }
    const Index halfedges = c.halfedge_count();
    const auto mirror = [&](Index h) { return halfedges + 3 * face_of(h) + (2 - h % 3); };
    result.tail = c.tail;
    result.twin = c.twin;
    result.edge = c.edge;
    result.edge_count = c.edge_count;
    result.tail.resize(2 * at(halfedges));
    result.twin.resize(2 * at(halfedges));
    result.edge.resize(2 * at(halfedges));
    std::vector<Index> edge_image(at(c.edge_count), -1);
    for (Index h = 0; h < halfedges; ++h) {
        const Index m = mirror(h), t = c.twin[at(h)], e = c.edge[at(h)];
        result.tail[at(m)] = image[at(c.head(h))];
        if (t == kNoTwin) {
            result.twin[at(h)] = m;
            result.twin[at(m)] = h;
            result.edge[at(m)] = e;
        } else {
            result.twin[at(m)] = mirror(t);
            if (edge_image[at(e)] < 0) edge_image[at(e)] = result.edge_count++;
            result.edge[at(m)] = edge_image[at(e)];
        }
    }
    return result;
}

FlowSurface make_flow_surface(const SurfaceMesh& mesh, bool doubled, bool delaunay) {
    FlowSurface surface;
    surface.triangulation = intrinsic_triangulation<long double>(mesh);
    surface.topology = topology_of(mesh.connectivity);
    surface.boundary = boundary_vertices(mesh.connectivity);
    surface.used = used_vertices(mesh.connectivity);
    const auto vertices = at(mesh.connectivity.vertex_count);
    surface.doubled = doubled && surface.topology.boundaries > 0;
    if (surface.doubled) {
        surface.side = 0.5;
        surface.triangulation.connectivity = double_of(mesh.connectivity, surface.orbit);
        mirror_lengths(surface.triangulation.log_chord);
        surface.full_angle.assign(surface.orbit.size(), 2.0 * std::numbers::pi);
    } else {
        surface.orbit.resize(vertices);
        surface.full_angle.resize(vertices);
        for (std::size_t v = 0; v < vertices; ++v) {
            surface.orbit[v] = static_cast<Index>(v);
            surface.full_angle[v] = (surface.boundary[v] ? 1.0 : 2.0) * std::numbers::pi;
        }
    }
    surface.delaunay = delaunay;
    if (delaunay) {
        DelaunayWorkspace workspace;
        surface.isometric_flips =
            make_delaunay(surface.triangulation, {}, FlipRule::isometric, workspace).flips;
    }
    return surface;
}

template <class Real>
IntrinsicTriangulation<Real> start_triangulation(const SurfaceMesh& mesh, const FlowSurface& surface) {
    IntrinsicTriangulation<Real> start = intrinsic_triangulation<Real>(mesh);
    if (surface.doubled) {
        std::vector<Index> orbit;
        start.connectivity = double_of(mesh.connectivity, orbit);
        mirror_lengths(start.log_chord);
    }
    DelaunayWorkspace workspace;
    if (surface.delaunay) make_delaunay<Real>(start, {}, FlipRule::isometric, workspace);
    return start;
}

template IntrinsicTriangulation<WideReal> start_triangulation<WideReal>(const SurfaceMesh&,
                                                                        const FlowSurface&);

}  // namespace ricci
