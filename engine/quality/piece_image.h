// Points of the pieces of a common refinement in the plane of the final metric.
#pragma once

#include "engine/layout/final_metric.h"

namespace ricci {

/// The corner of a piece in the frame of its final face, as a vector (x, t) of isometry.h.
std::array<double, 3> piece_point(const FinalMetric<double>& metric, const CommonRefinement& refinement,
                                  Index corner);

/// The isometry that takes the origin to `p` straight along the line between them. `p` must not be the
/// sphere's far pole.
Isometry<double> motion_to(int kappa, const std::array<double, 3>& p);

/// `q` as seen from `p`: where it comes to lie when `p` is moved to the origin by the inverse of motion_to.
/// Computed from the difference of the two, so that close points keep their digits.
std::array<double, 3> seen_from(int kappa, const Isometry<double>& to_origin, const std::array<double, 3>& p,
                                const std::array<double, 3>& q);

/// Distance in the plane.
double point_distance(int kappa, const std::array<double, 3>& p, const std::array<double, 3>& q);

}  // namespace ricci
