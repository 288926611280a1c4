#include "kernels/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "kernels/point_distance.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Kahan, "Miscalculating area and angles of a needle-like triangle", section 2: sides sorted a >= b >= c.
double triangle_area(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    return 0.25 * std::sqrt(std::max(product, 0.0));
}

}  // namespace

std::vector<Triangle> triangles_of(const Connectivity& connectivity) {
    std::vector<Triangle> triangles(at(connectivity.face_count()));
    for (std::size_t f = 0; f < triangles.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) triangles[f][k] = connectivity.tail[3 * f + k];
    }
    return triangles;
}

SurfaceMesh make_surface_mesh(std::vector<Point> points, std::span<const Triangle> triangles) {
    SurfaceMesh mesh;
    mesh.connectivity = build_connectivity(triangles, static_cast<Index>(points.size()));
    const Connectivity& c = mesh.connectivity;
    mesh.points = std::move(points);
    mesh.edge_length.resize(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        // Differences change sign only, so twins get the same bits.
        mesh.edge_length[at(h)] = point_distance(mesh.points[at(c.tail[at(h)])], mesh.points[at(c.head(h))]);
    }
    mesh.input_vertex.resize(mesh.points.size());
    std::iota(mesh.input_vertex.begin(), mesh.input_vertex.end(), Index{0});
    return mesh;
}

std::vector<double> face_areas(const SurfaceMesh& mesh) {
    std::vector<double> areas(at(mesh.connectivity.face_count()));
    for (std::size_t f = 0; f < areas.size(); ++f) {
        areas[f] =
            triangle_area(mesh.edge_length[3 * f], mesh.edge_length[3 * f + 1], mesh.edge_length[3 * f + 2]);
    }
    return areas;
}

}  // namespace ricci
