// The robust route to the sphere: discrete uniformisation of genus 0 through one vertex at infinity.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/flow/newton.h"
#include "engine/flow/precision.h"

namespace ricci {

struct SphereOptions {
    double tolerance = 1e-10;           // on max |K|, radians
    std::int32_t max_iterations = 500;  // Newton steps in the plane, per try
    bool parallel = true;
    /// Of the measurement on the sphere. The plane is flattened in long double.
    Precision precision = Precision::automatic;
    /// Masses of the Moebius normalisation. // V of the input, >= 0; empty: vertex areas of the surface as it
    /// starts
    std::vector<double> mass;
    /// Which vertex (of the input; on the boundary of a disk) is sent to infinity. Unset: one with a round
    /// star, then, where that fails, another far from it.
    std::optional<Index> infinity;
    std::function<std::optional<Status>()> interrupted;
    std::function<void(const IterationLog&)> progress;
};

struct SphereResult {
    SolveOutcome outcome;             // residual_max: on the sphere, at u as stored
    std::string message;              // why, where not converged; notes otherwise
    bool extended_precision = false;  // the residual was measured in long double
    std::vector<double> u;            // V, as of ScaledMetric in spherical geometry; 0 for unused vertices
    /// Where the vertices lie on the unit sphere, the one at infinity at the north pole; clusters smaller
    /// than 1e-16 fall together, so lengths are better taken from u. // per vertex of the surface's
    /// triangulation
    std::vector<Point> position;
    bool reached_sphere = false;  // u is set: the plane became flat, or cannot be flatter in double
    double imbalance = 0.0;       // length of the centre of mass, which is to be 0
    Index infinity = -1;          // the vertex that was sent to infinity
    Index infinity_valence = 0;   // of it in the result
};

/// Whether there is a route: a closed sphere, or the double of a disk.
bool sphere_route_exists(const FlowSurface& surface);

/// Finds the conformal factor that makes the chords lambda_ij e^{(u_i+u_j)/2}, after Ptolemy flips, those of
/// a convex polyhedron inscribed in the unit sphere (Rivin 1996; Springborn 2019): it exists for every
/// surface and is unique up to Moebius maps. u is the one for which the vertices, weighted by mass, have
/// their centre of mass at the origin; if one vertex has half of the mass there is none such, the imbalance
/// is not 0 and the message says so. Throws std::invalid_argument where there is no route, or where the named
/// vertex cannot go to infinity.
SphereResult solve_sphere(const FlowSurface& surface, const SphereOptions& options);

}  // namespace ricci
