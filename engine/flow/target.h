// Target curvatures and whether they can be reached.
#pragma once

#include <string>

#include "engine/flow/flow.h"

namespace ricci {

/// The target of `options` on a surface: curvature per vertex, unknowns. Throws std::invalid_argument.
CurvatureTarget make_target(const FlowSurface& surface, const FlowOptions& options, Geometry geometry,
                            Boundary boundary);

/// The conditions that hold for every triangulation: curvature below 2 pi (pi on the boundary), total 2 pi
/// chi (Euclidean) or above it (hyperbolic). Empty when kept, else a sentence.
std::string inadmissibility(const FlowSurface& surface, const CurvatureTarget& target, Geometry geometry,
                            Boundary boundary);

/// The constant u that scales the input to the area which Gauss-Bonnet gives the target metric (hyperbolic,
/// spherical): where the flow starts. 0 in the plane, and where no such area exists. `curvature`: V, the
/// target's.
double initial_log_scale(const SurfaceMesh& mesh, std::span<const double> curvature, Geometry geometry);

/// Theorem 4 of the thesis (section 3.5; Chow, Luo 2003) for a vertex set I of a circle packing on a fixed
/// triangulation: admissible needs sum_I K > -sum_{(e,v) in Lk(I)} (pi - phi(e)) + 2 pi chi(F_I), where
/// chi(F_I) = |I| - edges inside - faces inside with that sign, boundary vertices counting one half.
struct AdmissibilityViolation {
    std::vector<Index> vertices;  // I, ascending
    double curvature_sum = 0.0, bound = 0.0;
};

/// Looks for a violating set among single vertices and the sublevel sets of `u` (a flow towards an
/// inadmissible target lets the circles of such a set shrink for ever). `eta`: 3F; phi = acos(eta) for eta in
/// [0, 1], 0 above.
std::optional<AdmissibilityViolation> find_violation(const Connectivity& connectivity,
                                                     std::span<const double> eta,
                                                     const CurvatureTarget& target,
                                                     std::span<const double> u);

/// The sentence that reports a violation.
std::string describe(const AdmissibilityViolation& violation);

}  // namespace ricci
