// Whether an atlas is one: that its maps agree, and its charts are disks that cover.
#pragma once

#include <cstdint>

#include "engine/atlas/atlas.h"

namespace ricci {

/// Read from what an atlas stores. Distances are between coordinates in the charts, the others between
/// matrix entries.
struct AtlasChecks {
    double vertex_disagreement = 0.0;  // |phi_ab(x_b) - x_a| over the vertices of all overlaps
    double edge_disagreement =
        0.0;                     // of the isometries that the pieces of an overlap give, from the one stored
    double cocycle_error = 0.0;  // phi_ab phi_bc - phi_ac over all triple overlaps
    std::int64_t triples = 0;    // of transitions that meet in a piece
    // What a matrix changes of the form it is to keep, over the square of its largest entry: x^2 + y^2 - t^2
    // or x^2 + y^2 + t^2. Affine: of x^2 + y^2 by the linear part, and of the last row, absolute.
    double form_error = 0.0;
    double circle_error = 0.0;   // hyperbolic, projective: of images of the unit circle, distance from it
    double closing_error = 0.0;  // the largest of the charts'
    Index not_disks = 0;         // charts with V - E + F other than 1, or not connected across sides
    Index uncovered_vertices = 0, uncovered_sides = 0;  // of the refinement, inside no chart,
                                                        // cones apart
    Index overlaps = 0;                                 // transitions
};

/// `cones`: as in the options.
AtlasChecks check_atlas(const CommonRefinement& refinement, const Atlas& atlas,
                        const std::vector<Index>& cones);

}  // namespace ricci
