// The crossings on the edges of the Delaunay triangulation of the input, both families merged, and what lies
// between them: the ground plan of the common refinement.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/refinement/crossing_points.h"
#include "kernels/surface_mesh.h"

namespace ricci {

/// A triangulation (`middle`) with the input's edges across it (straight), and itself across the final one
/// (ideal).
struct Crossings {
    const Connectivity* input = nullptr;
    const Connectivity* middle = nullptr;
    const Connectivity* last = nullptr;
    CurvePaths input_paths, middle_paths;  // input across middle, middle across last
    std::vector<CrossingPoint> input_points, middle_points;
    std::vector<DirectedEdge> input_along;  // 3F, per middle halfedge: input edge that runs along it, or -1
    std::vector<Index> last_along;          // 3F, per middle halfedge: final halfedge along it, or -1
};

/// A crossing on a middle edge.
struct EdgeNode {
    bool final_edge = false;   // an edge of the final triangulation, else of the input's
    Index crossing = 0;        // index into middle_paths (final_edge) or input_paths
    long double fraction = 0;  // along the middle edge's lowest halfedge
};

/// A stretch of a middle edge between successive nodes, as seen from its left (0) and right (1) side: the
/// final face it lies in, and its ends as combinations of that face's corners.
struct EdgeStretch {
    std::array<Index, 2> final_face{-1, -1};
    std::array<std::array<long double, 3>, 2> begin{}, end{};
};

/// Per edge e of the middle triangulation: nodes first[e] ... first[e+1]-1 in order along its lowest
/// halfedge, and one stretch more than nodes, from first[e] + e.
struct EdgeNodes {
    std::vector<Index> halfedge;  // E: the lowest halfedge of each edge
    std::vector<Index> first;     // E+1
    std::vector<EdgeNode> node;
    std::vector<EdgeStretch> stretch;
    std::vector<Index> node_of_input, node_of_final;  // node of each crossing of input_paths, middle_paths

    [[nodiscard]] Index count(Index edge) const {
        return first[static_cast<std::size_t>(edge) + 1] - first[static_cast<std::size_t>(edge)];
    }
};

/// `u`: V, conformal factor: the corner of a final face at vertex v counts exp(-u_v).
EdgeNodes merge_edge_nodes(const Crossings& crossings, std::span<const double> u);

/// Positions in space of the nodes. // per node; `point`: V
std::vector<Point> node_points(const Crossings& crossings, const EdgeNodes& nodes,
                               std::span<const Point> point);

}  // namespace ricci
