// A smooth hyperbolic surface by few triangles: what closed geodesics are sought in.
#pragma once

#include <vector>

#include "engine/shape_space/hyperbolic_triangulation.h"

namespace ricci {

/// The Delaunay triangulation of some vertices of a smooth surface. Every vertex has a frame; a path along
/// edges is the product of `step`s, of moderate size each, so that nothing far from where it is looked at
/// enters (thesis, section 8.4 b).
struct CoarseSurface {
    Connectivity connectivity;
    std::vector<double> half_chord;      // 3F, sinh(l/2)
    std::vector<double> direction;       // 3F, radians from the x axis of the tail's frame; increases by the
                                         // corner's angle to the next halfedge counterclockwise
    std::vector<Isometry<double>> step;  // 3F, from the frame of the tail to that of the head
    std::vector<Index> fine_vertex;      // V, of the triangulation it was made of; -1: put in on an edge
    std::vector<Index> reference;        // V, halfedge of that triangulation along the x axis, or -1
    // V, where the vertex lies in the final triangulation: a final face, and the isometry from the frame of
    // the vertex to that of the face; -1 for vertices put in on an edge.
    std::vector<Index> final_face;
    std::vector<Isometry<double>> in_final_face;
    std::vector<Index> outgoing;  // V, a halfedge from each vertex; on the boundary that of the boundary
    std::vector<double> radius;   // V: every point of a face lies within the radius of one of its vertices
    std::vector<Index> boundary_vertex;  // a vertex of the input on each boundary component, in the order of
                                         // lowest boundary halfedges
    Index genus = 0, boundaries = 0;
    double angle_error = 0.0;  // largest miss of an angle sum, radians: rounding, and what the flow left

    /// From the frame where a step ends to that where it starts.
    [[nodiscard]] Isometry<double> along(Index step_code) const {
        return step_code >= 0 ? step[static_cast<std::size_t>(step_code)]
                              : inverse(step[static_cast<std::size_t>(~step_code)]);
    }
    /// The next halfedge counterclockwise about the tail, or kNoTwin.
    [[nodiscard]] Index turned(Index h) const {
        return connectivity.twin[static_cast<std::size_t>(prev_halfedge(h))];
    }
};

/// A step along an edge: the halfedge in its direction, or ~h against it (only the boundary's need that).
using CoarseStep = Index;
using CoarsePath = std::vector<CoarseStep>;

/// Calls visit(step, w) for every edge from v to a vertex w; for the edge of the boundary that arrives at v
/// too.
template <class Visit>
void for_neighbours(const CoarseSurface& s, Index v, Visit&& visit) {
    const Index first = s.outgoing[static_cast<std::size_t>(v)];
    for (Index h = first;;) {
        visit(h, s.connectivity.head(h));
        const Index in = prev_halfedge(h);
        h = s.connectivity.twin[static_cast<std::size_t>(in)];
        if (h == kNoTwin) visit(~in, s.connectivity.tail[static_cast<std::size_t>(in)]);
        if (h == kNoTwin || h == first) return;
    }
}

struct CoarseOptions {
    double spacing = 0.9;  // every vertex that goes has one that stays within this distance, along edges
    double largest_radius = 1.1;  // where a vertex is wanting, edges are split
};

/// Removes vertices by flips in the given smooth metric, one after another, keeping the triangulation
/// Delaunay: exact up to rounding, since a vertex of angle 2 pi is no more than a mark. What stays is chosen
/// greedily in the order of numbers; a vertex that no flips can free stays too. Where the vertices are too
/// few, as near boundaries of coarse meshes, others are put in.
CoarseSurface make_coarse_surface(const HyperbolicTriangulation& fine, const CoarseOptions& options = {});

}  // namespace ricci
