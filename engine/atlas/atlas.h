// Atlases: overlapping charts in a model plane and the maps between them, which make up a geometric structure
// (thesis, sections 5.2, 6.2.3, 6.2.4 and 7.1).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/layout/final_metric.h"

namespace ricci {

/// affine: a flat metric with cones left out; transition maps are rigid motions of the plane. hyperbolic:
/// Poincare disk, SU(1,1). projective: the same metric in Klein's disk, SO(2,1). spherical: SO(3).
enum class AtlasKind : std::uint8_t { affine, hyperbolic, projective, spherical };
std::string_view name_of(AtlasKind kind);

struct AtlasOptions {
    AtlasKind kind = AtlasKind::affine;
    Index charts = 0;  // how many to aim at, 0: about a hundred faces each, at most 12 + 6 |chi|; more are
                       // made where vertices are left over
    Index rings = 2;   // faces added around a chart's own patch
    std::vector<Index> cones;  // interior vertices of the input where the metric is not smooth
};

/// A closed disk of pieces that does not meet itself, laid out from its seed: the pieces of whole input
/// faces, but for charts close to a cone, where a face may be too wide to be laid out. The chart's domain is
/// the interior of the disk (with what it has of the surface's boundary): there it is one to one. For a cone
/// on its rim the position is a limit, the cone itself belongs to no chart.
struct Chart {
    Index seed_face = -1;                 // input face of the piece whose middle is at the origin
    std::vector<Index> faces;             // input faces that are wholly in the chart, ascending
    std::vector<Index> vertices;          // input vertices of its pieces, ascending
    std::vector<std::uint8_t> inside;     // per vertex: its whole star is in the chart
    std::vector<double> point;            // per vertex Atlas::dimension coordinates in the model
    std::vector<Index> pieces;            // of the refinement, ascending
    std::vector<Isometry<double>> frame;  // per piece: from the frame of its final face to the chart
    double radius = 0.0;                  // largest distance of a vertex from the origin, in the metric
    double closing_error = 0.0;  // largest distance between the places of a vertex as seen from its pieces
};

/// Coordinates of chart `from` to those of chart `to` < `from` on one connected component of their overlap.
struct Transition {
    Index to = -1, from = -1;
    std::vector<Index> pieces;  // of the component (connected across sides), ascending
    Isometry<double> map;       // by the lowest of them; hyperbolic: z -> (a z + b) / (conj(b) z + conj(a))
    std::array<double, 9> matrix{};  // row by row; affine: on (x, y, 1); hyperbolic and projective: SO(2,1)
                                     // on (x, y, t) of the hyperboloid, so on (x, y, 1) of Klein's disk up to
                                     // a factor; spherical: SO(3)
};

struct Atlas {
    AtlasKind kind = AtlasKind::affine;
    int kappa = 0;
    Index dimension = 2;  // numbers per point: spherical 3, a unit vector; else 2
    std::vector<Chart> charts;
    std::vector<Transition> transitions;  // by `to`, then `from`, then lowest piece
    std::vector<Index> uncovered;  // vertices of the refinement, but for cones, inside no chart, ascending:
                                   // their stars meet themselves (the triangulation is too coarse); empty in
                                   // a whole atlas
};

/// Charts are patches around seeds as far from each other as can be, grown face by face, nearest first, as
/// long as they stay disks, and by `rings` rings beyond; then further charts around vertices not yet inside
/// one, of faces or, where that fails, of pieces. A chart whose image would overlap itself (around a cone),
/// or reach farther than 5 in the hyperbolic plane, is cut back. Deterministic. `refinement` and `metric`
/// belong to the mesh with connectivity `input`. Throws std::invalid_argument where the kind does not fit the
/// metric's curvature, a cone is not an interior vertex (or the surface is spherical), or `charts` or `rings`
/// is negative.
Atlas make_atlas(const Connectivity& input, const CommonRefinement& refinement,
                 const FinalMetric<double>& metric, const AtlasOptions& options);

/// Coordinates of a vector (x, t) in the model of `kind`; the third is 0 where the dimension is 2.
std::array<double, 3> model_point(AtlasKind kind, const std::array<double, 3>& position);

/// A transition map applied to a point of its chart `from`, by the matrix (hyperbolic: the Moebius map).
std::array<double, 3> apply_transition(AtlasKind kind, const Transition& transition,
                                       const std::array<double, 3>& point);

}  // namespace ricci
