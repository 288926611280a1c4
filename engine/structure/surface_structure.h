// From a surface to its geometric structure: the metric, the map onto the input mesh, the group, one domain
// laid out.
#pragma once

#include <optional>

#include "engine/flow/flow.h"
#include "engine/layout/surface_layout.h"

namespace ricci {

struct StructureOptions {
    FlowOptions flow;
    Index base = -1;       // base vertex of the generators; -1: a vertex in the middle of the surface
    Index seed_face = -1;  // input face to lay out first; -1: the middle of the domain
    double goal = 1e-10;   // on relator and closing error, where more digits can help
    int max_digits = 800;  // 16: double only
};

/// Seconds spent.
struct StructureSeconds {
    double flow = 0, refinement = 0, topology = 0, group = 0, layout = 0;
};

/// The parts beyond `flow` are there when the flow converged. Euclidean metrics are scaled to area 1 (the
/// surface's own, not its double's); `log_scale` is what was added to the flow's conformal factor for that.
/// Refers to the mesh it was made of.
struct SurfaceStructure {
    FlowResult flow;
    int kappa = 0;
    double log_scale = 0.0;
    std::optional<CommonRefinement> refinement;
    std::optional<FinalMetric<double>> metric;  // of the final faces, from the most digits that were taken
    std::optional<HomotopyBasis> basis;
    CanonicalBasis canonical;
    CutGraph cut;
    SurfaceGroup group;
    SurfaceLayout layout;
    StructureSeconds seconds;
};

/// Vertices that a flat layout must not wrap around: interior ones whose target curvature is not 0.
std::vector<Index> cone_vertices(const SurfaceMesh& mesh, const FlowResult& flow);

/// Lengths of the input's edges in the final metric, near enough to choose short loops by (an edge that flips
/// crossed is measured as if it were in the final triangulation). // 3F
std::vector<double> final_edge_lengths(const SurfaceMesh& mesh, std::span<const double> u, int kappa);

/// `mesh` must outlive the result. Throws std::invalid_argument for options that do not fit the surface,
/// Cancelled between its stages.
SurfaceStructure make_surface_structure(const SurfaceMesh& mesh, const StructureOptions& options);
SurfaceStructure make_surface_structure(SurfaceMesh&&, const StructureOptions&) = delete;

/// The structure of a metric that was found before: `flow` as solve_flow left it, or as it was stored
/// (geometry, status, factor, target, `doubled`, the final triangulation's `twin`, of Euclidean metrics the
/// area; of circle packings `packing` and the edge lengths). options.flow says whether flips are isometric
/// first (`delaunay`); the rest of it is not looked at.
SurfaceStructure make_surface_structure(const SurfaceMesh& mesh, FlowResult flow,
                                        const StructureOptions& options);
SurfaceStructure make_surface_structure(SurfaceMesh&&, FlowResult, const StructureOptions&) = delete;

/// The common refinement of a surface and the metric of a flow that converged, its factor raised by
/// `log_scale`.
CommonRefinement refinement_of_flow(const SurfaceMesh& mesh, const FlowResult& flow, bool delaunay,
                                    double log_scale);

}  // namespace ricci
