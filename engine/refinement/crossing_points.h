// Where the edges of one triangulation cross those of another.
#pragma once

#include <span>
#include <vector>

#include "engine/refinement/normal_curves.h"

namespace ricci {

/// One crossing on a curve. Everything is long double: slivers need every bit, and there are few crossings.
struct CrossingPoint {
    long double on_curve = 0;  // (0, 1): fraction of the way from the curve's tail to its head
    long double on_edge = 0;   // straight curves: fraction of the way along Crossing::halfedge
    long double tail = 0,
                head = 0;  // ideal curves: the point as a vector, weights of the ends of Crossing::halfedge
};

/// Curves that are straight in the flat metric with edge lengths exp(log_length) of the current
/// triangulation: the faces that a curve passes are unfolded into the plane. One point per crossing of
/// `paths`. Both fractions are in flat lengths.
std::vector<CrossingPoint> straight_crossings(const Connectivity& current,
                                              std::span<const long double> log_length,
                                              const CurvePaths& paths);

/// Curves that are geodesics of the hyperbolic metric made of ideal triangles, lambda lengths exp(log_chord).
///
/// Ideal vertices are light-like vectors v_i with <v_i, v_j> = -lambda_ij^2 / 2; the flat triangle with sides
/// lambda lies in the plane through three of them, and its barycentric coordinates are the coefficients.
/// Where the geodesics ij and kl cross,
///     (lambda_jk lambda_jl) v_i + (lambda_ik lambda_il) v_j = (lambda_ij / lambda_kl)
///         ((lambda_il lambda_jl) v_k + (lambda_ik lambda_jk) v_l),
/// and the lambda lengths from i and j to every vertex on the way follow from Ptolemy's relation alone: sums
/// of positive numbers, no cancellation.
///
/// `u`: V, conformal factor. `on_curve`: fraction along the flat edge ij of length lambda_ij at u = 0.
/// `tail`, `head`: weights of the vectors exp(u) v of the ends of the crossed halfedge, such that the point
/// is (1 - on_curve) v_i + on_curve v_j.
std::vector<CrossingPoint> ideal_crossings(const Connectivity& current,
                                           std::span<const long double> log_chord, std::span<const double> u,
                                           const CurvePaths& paths);

}  // namespace ricci
