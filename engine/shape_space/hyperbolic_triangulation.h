// A smooth hyperbolic surface, closed or with geodesic boundary, as glued triangles.
#pragma once

#include <vector>

#include "engine/flow/flow.h"
#include "engine/layout/final_metric.h"

namespace ricci {

/// Angle sums are 2 pi at inner vertices and pi at those of the boundary, which is geodesic. Loops and
/// multi-edges are legal.
struct HyperbolicTriangulation {
    Connectivity connectivity;
    std::vector<double> half_chord;  // 3F, sinh(l/2), equal on twins
    std::vector<Index>
        source_vertex;  // V, vertex of the input; -1: none (an edge crosses the boundary there)
    // Where the faces lie in the final triangulation, each in its frame (final_metric.h). // F
    std::vector<Index> final_face;
    std::vector<Isometry<double>> frame;  // from the frame of the face to that of the final face
};

/// The final triangulation of a closed surface. `half_chord`: 3F.
HyperbolicTriangulation closed_triangulation(const Connectivity& final_triangulation,
                                             std::vector<double> half_chord);

/// The half of the double that the input's faces make: the final faces cut along the mirror, which is the
/// boundary. `metric`: of the refinement, hyperbolic.
HyperbolicTriangulation half_triangulation(const CommonRefinement& refinement,
                                           const FinalMetric<double>& metric);

}  // namespace ricci
