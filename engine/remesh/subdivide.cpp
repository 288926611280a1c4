// Midpoint subdivision, embedded or intrinsic, and Loop's.
//
//                v2                 halfedge 3f+k of the old face becomes two: its first half is halfedge 0
//                of the
//               /  \                new face 4f+k at corner k, its second half halfedge 2 of the new face at
//               the
//             m2 -- m1              next corner. Halfedge 1 of face 4f+k is inner; the middle face 4f+3 has
//             the
//            /  \  /  \             corners m0, m1, m2.
//          v0 -- m0 -- v1
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/remesh/resample.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Halfedge `h` of a face with four new ones: its first and second half.
Index first_half(Index h) {
    return 3 * (4 * face_of(h) + h % 3);
}
Index second_half(Index h) {
    return 3 * (4 * face_of(h) + next_halfedge(h) % 3) + 2;
}

Connectivity subdivide_connectivity(const Connectivity& old) {
    const Index faces = old.face_count();
    std::vector<Index> tail(12 * at(faces)), twin(12 * at(faces), kNoTwin);
    for (Index h = 0; h < old.halfedge_count(); ++h) {
        const Index before = prev_halfedge(h), opposite = old.twin[at(h)];
        const Index corner = first_half(h);                     // v_k, m_k, m_(k-1)
        const Index middle = 3 * (4 * face_of(h) + 3) + h % 3;  // from m_k to m_(k+1)
        const Index midpoint = old.vertex_count + old.edge[at(h)];
        tail[at(corner)] = old.tail[at(h)];
        tail[at(corner + 1)] = tail[at(middle)] = midpoint;
        tail[at(corner + 2)] = old.vertex_count + old.edge[at(before)];
        const Index inner = first_half(next_halfedge(h)) + 1;  // from m_(k+1) to m_k
        twin[at(middle)] = inner;
        twin[at(inner)] = middle;
        if (opposite == kNoTwin) continue;
        twin[at(corner)] = second_half(opposite);
        twin[at(second_half(h))] = first_half(opposite);
    }
    return connectivity_from_gluing(std::move(tail), std::move(twin), old.vertex_count + old.edge_count);
}

}  // namespace

void check_subdivision_size(const SurfaceMesh& mesh) {
    if (mesh.connectivity.halfedge_count() > std::numeric_limits<Index>::max() / 4) {
        throw std::invalid_argument("subdivide: four times " +
                                    std::to_string(mesh.connectivity.face_count()) +
                                    " faces exceed 32-bit indices");
    }
}

SurfaceMesh subdivide_midpoint(const SurfaceMesh& mesh) {
    const Connectivity& old = mesh.connectivity;
    check_subdivision_size(mesh);
    if (!mesh.intrinsic()) {
        std::vector<Point> points = mesh.points;
        points.resize(at(old.vertex_count) + at(old.edge_count));
        for (const Index h : edge_halfedges(old)) {
            const Point& a = mesh.points[at(old.tail[at(h)])];
            const Point& b = mesh.points[at(old.head(h))];
            Point& middle = points[at(old.vertex_count) + at(old.edge[at(h)])];
            for (std::size_t k = 0; k < 3; ++k) middle[k] = 0.5 * a[k] + 0.5 * b[k];
        }
        return make_surface_mesh(std::move(points), triangles_of(subdivide_connectivity(old)));
    }
    SurfaceMesh fine;
    fine.connectivity = subdivide_connectivity(old);
    fine.edge_length.resize(4 * mesh.edge_length.size());
    for (Index h = 0; h < old.halfedge_count(); ++h) {
        const double half = 0.5 * mesh.edge_length[at(h)];
        fine.edge_length[at(first_half(h))] = fine.edge_length[at(second_half(h))] = half;
        // The line from m_k to m_(k+1) is half as long as the side it does not touch, that from v_(k+2) =
        // v_(k-1).
        const Index middle = 3 * (4 * face_of(h) + 3) + h % 3;
        const double opposite = 0.5 * mesh.edge_length[at(prev_halfedge(h))];
        fine.edge_length[at(middle)] = fine.edge_length[at(first_half(next_halfedge(h)) + 1)] = opposite;
    }
    fine.input_vertex.resize(at(fine.connectivity.vertex_count));
    std::iota(fine.input_vertex.begin(), fine.input_vertex.end(), Index{0});
    return fine;
}

SurfaceMesh subdivide_loop(const SurfaceMesh& mesh) {
    if (mesh.intrinsic()) throw std::invalid_argument("subdivide: Loop's rule moves vertices in space");
    check_subdivision_size(mesh);
    const Connectivity& c = mesh.connectivity;
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(c);
    std::vector<Point> ring(at(c.vertex_count),
                            Point{});  // sum over neighbours; on the boundary: along it only
    std::vector<double> valence(at(c.vertex_count), 0.0);
    const auto add_neighbour = [&](Index v, Index neighbour) {
        for (std::size_t k = 0; k < 3; ++k) ring[at(v)][k] += mesh.points[at(neighbour)][k];
        valence[at(v)] += 1.0;
    };
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index tail = c.tail[at(h)], head = c.head(h);
        const bool outer = c.twin[at(h)] == kNoTwin;
        if (outer || on_boundary[at(tail)] == 0) add_neighbour(tail, head);
        if (outer) add_neighbour(head, tail);
    }
    std::vector<Point> points = mesh.points;
    points.resize(at(c.vertex_count) + at(c.edge_count));
    for (std::size_t v = 0; v < at(c.vertex_count); ++v) {
        if (valence[v] == 0.0) continue;  // unused
        const double slope = 3.0 / 8.0 + std::cos(2.0 * std::numbers::pi / valence[v]) / 4.0;
        const double weight = on_boundary[v] != 0 ? 1.0 / 4.0 : 5.0 / 8.0 - slope * slope;
        for (std::size_t k = 0; k < 3; ++k) {
            points[v][k] = (1.0 - weight) * points[v][k] + weight * ring[v][k] / valence[v];
        }
    }
    for (const Index h : edge_halfedges(c)) {
        const Index twin = c.twin[at(h)];
        const Point &a = mesh.points[at(c.tail[at(h)])], &b = mesh.points[at(c.head(h))];
        Point& middle = points[at(c.vertex_count) + at(c.edge[at(h)])];
        for (std::size_t k = 0; k < 3; ++k) {
            const double ends = a[k] + b[k];
            if (twin == kNoTwin) {
                middle[k] = 0.5 * ends;
                continue;
            }
            const double wings = mesh.points[at(c.tail[at(prev_halfedge(h))])][k] +
                                 mesh.points[at(c.tail[at(prev_halfedge(twin))])][k];
            middle[k] = 0.375 * ends + 0.125 * wings;
        }
    }
    return make_surface_mesh(std::move(points), triangles_of(subdivide_connectivity(c)));
}

}  // namespace ricci
