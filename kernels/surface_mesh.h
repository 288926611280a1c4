// The input surface of every computation: connectivity with Euclidean edge lengths, embedded or intrinsic.
#pragma once

#include <array>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

using Point = std::array<double, 3>;

/// A validated piecewise flat surface (one component unless said otherwise).
struct SurfaceMesh {
    Connectivity connectivity;
    std::vector<Point> points;        // V in the units of the input; empty for an intrinsic surface
    std::vector<double> edge_length;  // 3F, length of halfedge h; equal on twins
    std::vector<Index> input_vertex;  // V, number of the vertex in the input file

    [[nodiscard]] bool intrinsic() const { return points.empty(); }
};

/// Vertex triples of the faces. // F
std::vector<Triangle> triangles_of(const Connectivity& connectivity);

/// Surface from points and triangles: builds connectivity and measures edges (long double, rounded once).
/// input_vertex becomes the identity. Throws what build_connectivity throws.
SurfaceMesh make_surface_mesh(std::vector<Point> points, std::span<const Triangle> triangles);

/// Area of every face by Kahan's form of Heron's formula, in squared input units. // F
std::vector<double> face_areas(const SurfaceMesh& mesh);

}  // namespace ricci
