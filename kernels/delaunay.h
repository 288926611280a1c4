// Intrinsic Delaunay triangulations by flips.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/conformal_factor.h"
#include "kernels/edge_flip.h"

namespace ricci {

enum class FlipRule : std::uint8_t { isometric, ptolemy };

struct FlipCount {
    std::int64_t flips = 0;
    bool finished = true;  // false: the safety bound on flips was hit (a bug or NaN lengths)
};

/// Scratch space that lives as long as its owner, so that repeated calls do not allocate.
struct DelaunayWorkspace {
    std::vector<double> corner_test;     // 3F
    std::vector<Index> stack;            // halfedges to be looked at
    std::vector<std::uint8_t> on_stack;  // E
    std::vector<Index> touched_faces;    // both faces of every edge flipped by the last call, in order
    std::vector<Index> flipped;  // the halfedge h of each of those flips, so that they can be made again
};

/// Flips until every edge is Delaunay in the metric u: edge ij with opposite vertices k, l is Delaunay iff
///   (a^2+b^2-c^2)/(ab) + (d^2+e^2-c^2)/(de) >= 0 on chords, c the edge's.
/// Ties (cocircular to rounding: within 64 eps (a/b + b/a + d/e + e/d); of WideReal to the rounding of 1 +
/// cos and 1 - cos, which tells needles apart) are left alone. Edges on the boundary and inside one face
/// never flip. `u`: V, or empty for u = 0. Isometric flips need u = 0. Deterministic: seeds in order of
/// halfedge.
template <class Real>
FlipCount make_delaunay(IntrinsicTriangulation<Real>& triangulation, ConformalFactor u, FlipRule rule,
                        DelaunayWorkspace& workspace);

/// Number of edges that fail the test above (with its tolerance): zero after make_delaunay.
template <class Real>
std::int64_t count_non_delaunay(const IntrinsicTriangulation<Real>& triangulation, ConformalFactor u);

}  // namespace ricci
