// What all lanes of all threads share on one surface.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/flow/flow_surface.h"
#include "engine/flow/newton.h"
#include "engine/linear/lane_factor.h"
#include "kernels/lanes.h"

namespace ricci {

/// The start triangulation of a flow surface in rows, with the Hessian at u = 0 factorised.
///
/// Rows: first the unknowns in elimination order, then the vertices whose u is fixed at 0; unused vertices
/// have none. The images of a vertex under the mirror of a double share its row.
struct LaneSurface {
    std::vector<Index> vertex_of_row;  // rows: vertex of the input
    Index unknowns = 0;                // rows with an unknown u
    Index pinned_row = -1;             // held during a back-solve where the solution is scale-free
    bool scale_free = false;
    double side = 1.0;             // as in FlowSurface
    std::vector<double> residual;  // rows: (target - K) / side at u = 0, without a cone; 0 where u is fixed
    /// Targets, plus curvatures at u = 0 where u is fixed, minus 2 pi chi: what Gauss-Bonnet wants the cone
    /// and the change of angles to make up for.
    double gauss_bonnet_excess = 0.0;

    Connectivity triangulation;       // tails are rows
    std::vector<double> chord;        // 3F, at u = 0
    std::vector<double> angle;        // 3F, radians at u = 0, of the corner at the tail
    std::vector<Index> corner_begin;  // rows+1
    std::vector<Index> corner;        // 3F: halfedges by the row of their tail

    LaneFaces faces;
    LaneEdges edges;
    std::unique_ptr<const LaneFactor> factor;

    [[nodiscard]] Index rows() const { return static_cast<Index>(vertex_of_row.size()); }
    [[nodiscard]] std::vector<Index> rows_of_vertices(Index vertex_count) const;  // V: row or -1
    [[nodiscard]] std::int64_t bytes() const;
};

/// Nothing where the surface does not suit lanes: too small to leave anything around a patch, a face that is
/// no triangle at u = 0, or a Hessian there that has no Cholesky factor.
std::unique_ptr<const LaneSurface> make_lane_surface(const FlowSurface& surface,
                                                     const CurvatureTarget& target,
                                                     std::span<const Index> ordering);

}  // namespace ricci
