// The faces of the final triangulation as triangles of their plane, and the moves from one to the next.
#pragma once

#include <array>
#include <vector>

#include "engine/layout/isometry.h"
#include "engine/refinement/common_refinement.h"

namespace ricci {

/// Every face f has a frame: origin at corner 0, x axis along halfedge 3f. Frames are passed on from face to
/// face, never as intersections of circles far from the origin (thesis, section 8.4 b).
template <class Real>
struct FinalMetric {
    int kappa = 0;
    std::vector<Real> half_chord;   // 3F, sin_k(l/2) of the halfedge's length l
    std::vector<Real> half_cosine;  // 3F, cos_k(l/2)
    std::vector<std::array<Isometry<Real>, 2>>
        turned;  // F, from the face's frame to those of halfedges 3f+1, 3f+2

    /// From the frame of the face of h to that of its neighbour across h.
    [[nodiscard]] Isometry<Real> crossing(const Connectivity& connectivity, Index h) const;
    /// From the face's frame to that of halfedge h.
    [[nodiscard]] Isometry<Real> to_halfedge(Index h) const;
    /// Corners of the face in its frame, as vectors (x, t).
    [[nodiscard]] std::array<std::array<Real, 3>, 3> corners(Index face) const;
};

/// Frames from half chords. // half_chord: 3F
template <class Real>
FinalMetric<Real> make_final_metric(int kappa, std::vector<Real> half_chord);

/// From the refinement's lengths and conformal factor.
FinalMetric<double> make_final_metric(int kappa, const CommonRefinement& refinement);

/// Angle sums that miss 2 pi by 1e-14 make holonomies about far vertices that miss the identity by 1e-14 e^R.
/// So the hyperbolic metric is solved anew in `Real`: lengths of the final triangulation as they are, one
/// scale per vertex, Newton steps with the Hessian factorised once in double, curvature from products of e^(i
/// theta) (square roots only). Closed surfaces.
template <class Real>
struct PolishedMetric {
    FinalMetric<Real> metric;
    std::vector<Real> scale;  // per vertex of the final triangulation: e^(u/2)
    double residual = 0.0;    // max |K| at the end, radians; 0 where it is below what a double holds
    int steps = 0;
};
/// `scale`: where to start; empty: at the refinement's conformal factor.
template <class Real>
PolishedMetric<Real> polish_hyperbolic(const CommonRefinement& refinement, std::vector<Real> scale = {});

}  // namespace ricci
