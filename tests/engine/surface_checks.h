// Properties of surfaces that several tests ask for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci::testing {

/// Smallest corner angle by the law of cosines, in degrees.
inline double min_angle_degrees(const SurfaceMesh& mesh) {
    double largest_cosine = -1.0;
    for (std::size_t f = 0; f < mesh.edge_length.size() / 3; ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double a = mesh.edge_length[3 * f + k], b = mesh.edge_length[3 * f + (k + 2) % 3];
            const double c = mesh.edge_length[3 * f + (k + 1) % 3];
            largest_cosine = std::max(largest_cosine, (a * a + b * b - c * c) / (2.0 * a * b));
        }
    }
    return std::acos(largest_cosine) * 180.0 / std::numbers::pi;
}

/// Volume enclosed, positive where the faces turn counterclockwise seen from outside.
inline double signed_volume(const SurfaceMesh& mesh) {
    double volume = 0.0;
    for (const Triangle& t : triangles_of(mesh.connectivity)) {
        const Point& a = mesh.points[static_cast<std::size_t>(t[0])];
        const Point& b = mesh.points[static_cast<std::size_t>(t[1])];
        const Point& c = mesh.points[static_cast<std::size_t>(t[2])];
        volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return volume / 6.0;
}

/// Area of a face's shadow on the plane z = 0, positive where it turns counterclockwise seen from above.
inline double shadow_area(const SurfaceMesh& mesh, const Triangle& t) {
    const Point& a = mesh.points[static_cast<std::size_t>(t[0])];
    const Point& b = mesh.points[static_cast<std::size_t>(t[1])];
    const Point& c = mesh.points[static_cast<std::size_t>(t[2])];
    return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

inline double total_area(const SurfaceMesh& mesh) {
    double sum = 0.0;
    for (const double area : face_areas(mesh)) sum += area;
    return sum;
}

/// Lengths of the boundary loops, ascending.
inline std::vector<double> boundary_lengths(const SurfaceMesh& mesh) {
    const Connectivity& c = mesh.connectivity;
    std::vector<double> lengths;
    std::vector<bool> seen(c.twin.size(), false);
    for (std::size_t start = 0; start < c.twin.size(); ++start) {
        if (c.twin[start] != kNoTwin || seen[start]) continue;
        double length = 0.0;
        Index h = static_cast<Index>(start);
        do {
            seen[static_cast<std::size_t>(h)] = true;
            length += mesh.edge_length[static_cast<std::size_t>(h)];
            h = next_halfedge(h);  // turn about the head until the boundary appears again
            while (c.twin[static_cast<std::size_t>(h)] != kNoTwin) {
                h = next_halfedge(c.twin[static_cast<std::size_t>(h)]);
            }
        } while (h != static_cast<Index>(start));
        lengths.push_back(length);
    }
    std::sort(lengths.begin(), lengths.end());
    return lengths;
}

}  // namespace ricci::testing
