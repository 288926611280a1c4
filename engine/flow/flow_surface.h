// What the flow runs on: a surface, or the double of a surface with boundary folded onto its vertices.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "kernels/delaunay.h"
#include "kernels/intrinsic_triangulation.h"

namespace ricci {

/// What happens at a boundary. geodesic and curvature: the flow runs on the double, where the convergence
/// theorem holds, with mirror images sharing one unknown; target 0 on the boundary makes it geodesic. free: u
/// = 0 there, edges stop flipping at the boundary, and its curvature follows.
enum class Boundary : std::uint8_t { geodesic, free, curvature };
std::string_view name_of(Boundary boundary);

/// A triangulation with its vertices mapped to the V vertices of the input ("orbits").
///
/// For a doubled surface every interior vertex and its mirror image are one orbit with one conformal factor;
/// edges that flip across the mirror join an orbit to itself. Curvature of an orbit is `side` times the sum
/// over its vertices, which is the curvature on the half.
struct FlowSurface {
    IntrinsicTriangulation<long double> triangulation;  // the start: isometric Delaunay where asked for
    std::vector<Index> orbit;            // per vertex of the triangulation: vertex of the input
    std::vector<double> full_angle;      // per vertex of the triangulation: 2 pi, or pi on a boundary
    std::vector<std::uint8_t> boundary;  // V: on the boundary of the input
    std::vector<std::uint8_t> used;      // V: has a face
    Topology topology;                   // of the input
    double side = 1.0;                   // 1, or 1/2 for a double
    bool doubled = false;
    bool delaunay = true;  // the start is isometric Delaunay
    std::int64_t isometric_flips = 0;

    [[nodiscard]] Index vertex_count() const { return static_cast<Index>(used.size()); }
};

/// Prepares a surface: doubles it where asked (and where it has a boundary), then flips it to isometric
/// Delaunay in extended precision where asked.
FlowSurface make_flow_surface(const SurfaceMesh& mesh, bool doubled, bool delaunay);

/// `surface.triangulation` again, from the mesh the surface was made of, in Real (WideReal).
template <class Real>
IntrinsicTriangulation<Real> start_triangulation(const SurfaceMesh& mesh, const FlowSurface& surface);

/// The double of a triangulation along its boundary. Faces F … 2F-1 are the mirror images, halfedge 3f+k
/// mirrored to 3(F+f)+(2-k). Interior vertices get images V, V+1, … in order; `orbit` is filled.
Connectivity double_of(const Connectivity& connectivity, std::vector<Index>& orbit);

}  // namespace ricci
