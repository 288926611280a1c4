// One fundamental domain laid out in its plane: the plane itself, the hyperbolic plane, or the sphere.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/layout/surface_group.h"
#include "engine/topology/cut_graph.h"

namespace ricci {

/// Pairing of two sides of the domain.
struct SidePairing {
    Index side = -1;           // index into CutGraph::sides; its partner's pairing is the inverse
    Isometry<double> element;  // deck transformation that takes the domain's neighbour across this side from
                               // the domain: it maps the partner side onto this one
    double spread =
        0.0;  // largest entry by which the transformations from its edges differ, seen from each edge
};

/// Positions are vectors (x, y, t), kappa (x^2 + y^2) + t^2 = 1: see isometry.h for the models.
struct SurfaceLayout {
    int kappa = 0;
    // A vertex of the refinement has as many layout vertices as the cut leaves copies of it. // L each
    std::vector<Index> refinement_vertex;
    std::vector<std::array<double, 3>> position;
    std::vector<Index> corner_vertex;     // C, layout vertex of every corner of the refinement
    std::vector<Isometry<double>> frame;  // P, from the piece's final face to the layout
    std::vector<SidePairing> pairings;    // one per cut side
    Isometry<double> base_frame;  // from the frame at the base (SurfaceGroup) to the layout: a generator g
                                  // acts on the layout as base_frame g base_frame^-1
    Index root_piece = -1;
    double radius = 0.0;         // largest distance of a vertex from the origin
    double closing_error = 0.0;  // largest entry by which a frame carried to a piece across any of its sides,
                                 // uncut ones or (by the pairing) cut ones, differs from the piece's own
    int digits = 16;             // of the arithmetic
    // By count_orientations:
    std::int64_t flipped = 0;     // pieces whose image is turned over
    std::int64_t degenerate = 0;  // pieces of no area, in the input or in the image
    std::int64_t unresolved =
        0;  // pieces too small or too far out for the stored coordinates to show which way they turn
};

struct LayoutOptions {
    Index seed_face = -1;  // input face to lay out first; -1: the middle of the domain, at the origin
    double goal = 1e-10;   // on the closing error, where more digits can help (hyperbolic)
    int max_digits = 800;
    PolishedScales* scales = nullptr;  // as in GroupOptions
};

/// Lays out breadth first over the pieces, never across a cut side, relative frame by relative frame (thesis,
/// sections 4.3.2, 6.2.2.2 and 8.4 a to e). `cut`: of the input; empty sides: a sphere.
SurfaceLayout make_surface_layout(int kappa, const CommonRefinement& refinement, const Connectivity& input,
                                  const HomotopyBasis& basis, const CutGraph& cut,
                                  const LayoutOptions& options = {});

/// Looks which way every piece turns: in its own final face, and by the stored positions.
void count_orientations(const CommonRefinement& refinement, SurfaceLayout& layout);

/// Coordinates of a position. Conformal: Poincare disk, plane, stereographic (from the far pole).
std::array<double, 2> conformal_point(int kappa, const std::array<double, 3>& position);
/// Klein disk, plane, central projection of the half sphere.
std::array<double, 2> projective_point(const std::array<double, 3>& position);
/// Upper half plane (kappa = -1).
std::array<double, 2> half_plane_point(const std::array<double, 3>& position);

/// Copies of the domain: deck transformations in the layout's coordinates, breadth first across the sides,
/// the identity first, none twice. At most `count`; those whose image of the origin lies farther than
/// `max_distance` are left out.
std::vector<Isometry<double>> tessellate(const SurfaceLayout& layout, std::size_t count, double max_distance);

}  // namespace ricci
