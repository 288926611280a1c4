// The data-parallel heart: every face's corner angles and their derivatives, faces independent of one
// another.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/conformal_factor.h"
#include "kernels/connectivity.h"
#include "kernels/geometry.h"

namespace ricci {

/// Chords as logarithms at u = 0 (vertex scaling). Views; F faces.
template <class Real>
struct ScaledChords {
    std::span<const Index> tail;      // 3F
    std::span<const Real> log_chord;  // 3F
    ConformalFactor u;                // V; chord of i->j is exp(log_chord + (u_i+u_j)/2)
};

/// A circle-packing metric as data (Zhang et al. 2014, The unified discrete surface Ricci flow):
/// chord^2 = q (2 eta e^{ui+uj} + eps_i e^{2ui} + eps_j e^{2uj}) / ((1 + kappa eps_i e^{2ui})(1 + kappa eps_j
/// e^{2uj})), q = 1 in the plane, 4 on the sphere and in the hyperbolic plane.
struct PackedCircles {
    std::span<const Index> tail;  // 3F
    std::span<const double> eta;  // 3F, equal on twins
    std::span<const double> eps;  // V, -1, 0 or 1
    std::span<const double> u;    // V, log gamma | log tanh(gamma/2) | log tan(gamma/2)
};

/// What a pass writes; empty spans are skipped.
template <class Real>
struct FaceFields {
    std::span<Real> angle;       // 3F, radians, at corner k of face f in slot 3f+k
    std::span<double> off;       // 3F, d theta_i/d u_j of this face for halfedge i->j (cot/2 in the plane)
    std::span<double> diagonal;  // 3F, d theta_k/d u_k
    std::span<Real> area;        // F; Euclidean: exact area, may over- or underflow where chords do
};

/// Evaluates all faces. Returns how many faces are no triangle of the geometry (broken triangle inequality;
/// on the sphere also a chord of 2 or more): their angles are the continuous extension 0, 0, pi (on the
/// sphere, with a perimeter beyond 2 pi: pi, pi, pi) and their derivatives are not finite. Runs blocks of
/// faces in parallel where `parallel`; the same bits either way.
template <class Real>
std::int64_t evaluate_faces(Geometry geometry, const ScaledChords<Real>& chords,
                            const FaceFields<TriangleReal<Real>>& out, bool parallel);
std::int64_t evaluate_faces(Geometry geometry, const PackedCircles& circles, const FaceFields<double>& out,
                            bool parallel);

/// Edge lengths (not chords) of a circle-packing metric. // 3F
void packed_edge_lengths(Geometry geometry, const PackedCircles& circles, std::span<double> length);

/// Total angle at each vertex: angle sums of its corners, in order of face (scatter in fixed order, so the
/// same bits for any thread count). // V, overwritten
template <class Real>
void sum_corners(std::span<const Index> tail, std::span<const Real> angle, std::span<Real> total);

}  // namespace ricci
