// Edge flips on implicit halfedges, and the two rules for the length of the new edge.
#pragma once

#include "kernels/intrinsic_triangulation.h"

namespace ricci {

/// Whether the edge of h lies between two different faces (else no quadrilateral surrounds it).
bool flippable(const Connectivity& connectivity, Index h);

/// Flips the edge of h. With t = twin(h):
///
///          k                      k
///        /   \                  / | \         h becomes i->l, next(h) becomes l->k (the new edge),
///      /   f   \              /   |   \       t becomes j->k, next(t) becomes k->l;
///     i ---h--> j    ===>    i  f | g  j      prev(h) and prev(t) stay where they are.
///      \   g   /              \   |   /       The edge keeps its number. Only faces f and g, and the
///        \   /                  \ | /         twins of the two halfedges that moved, are rewritten.
///          l                      l
/// `log_chord` (3F) moves along; `new_log` becomes the length of the new edge. Precondition: flippable.
template <class Real>
void flip_edge(Connectivity& connectivity, std::span<Real> log_chord, Index h, Real new_log);

/// The same without lengths.
void flip_edge(Connectivity& connectivity, Index h);

/// Ptolemy: lambda_kl = (lambda_ik lambda_jl + lambda_il lambda_jk) / lambda_ij, in logarithms. Holds for
/// chords of all three geometries and needs no triangle inequality (Gu, Luo, Sun, Wu 2018; Springborn 2019).
template <class Real>
Real ptolemy_log(std::span<const Real> log_chord, const Connectivity& connectivity, Index h);

/// Isometric: unfolds both Euclidean triangles into the plane and measures the other diagonal. The
/// quadrilateral must be convex, which it is where the edge is not Delaunay.
template <class Real>
Real unfolded_log(std::span<const Real> log_chord, const Connectivity& connectivity, Index h);

}  // namespace ricci
