// A marking of a surface of negative Euler characteristic, chosen by its hyperbolic geometry alone.
#pragma once

#include <string>
#include <vector>

#include "engine/shape_space/based_curve.h"

namespace ricci {

/// A one-holed torus. a and b meet once, (direction of a, direction of b) a positive frame; [a,b] goes once
/// around it.
struct MarkedHandle {
    Index vertex = 0;
    Isometry<Exact> a, b;  // in the frame of the vertex
};

/// A choice, and by how much it was better than the next one, relative to itself (for twists: how far inside
/// the range, in units of the full turn): small where noise or another triangulation may turn it.
struct MarkingChoice {
    std::string name;
    double gap = 0.0;
};

/// A pair of pants of the chain: inner * added = outer, all in one frame. `inner` and `added` run with the
/// pants on their left, `outer` with them on its right.
struct ChainLink {
    Index vertex = 0;
    Isometry<Exact> to_previous;  // from its frame to that of the link before, or of Marking::first
    Isometry<Exact> inner, added, outer;
    Index handle = -1, boundary = -1;  // what `added` bounds: the handle, or the boundary component
    MarkedHandle torus;                // of a handle: in the same frame, [a,b] or its inverse being `added`
};

/// What is left when the handles are cut off is a sphere with g + r holes. Hole by hole they are gathered in
/// a chain of curves x1, x2, ...: x1 goes around the first hole, x(k+1) around x(k) and one more.
///
/// Rules, in this order (all lengths hyperbolic):
/// 1. a1 is the shortest simple closed geodesic that does not separate, b1 the shortest simple one that
///    meets it once; a(i), b(i) likewise, disjoint from the handles before. Then b is turned along a by as
///    many full turns as bring its twist (dual_curves.h) into [-l/4, 3l/4), l the length of a: shapes with a
///    mirror symmetry, where the twist is 0 or l/2, lie well inside.
/// 2. The chain begins with the hole of the first handle, or with the shortest boundary where there is none.
///    Next comes the hole that is nearest to x(k) along a common perpendicular: handles first, then
///    boundaries; x(k+1) goes around both along that perpendicular.
/// Handles and boundaries are named anew in the order of the chain.
struct Marking {
    std::vector<MarkedHandle> handles;  // in the order of the chain, in frames of their own
    std::vector<Index> boundaries;      // components in the order of the chain
    BasedCurve first;                   // x1, the rest of the chain on its left
    MarkedHandle first_torus;           // in the frame of `first`, where genus > 0
    std::vector<ChainLink> links;       // g + r - 2
    MarkedHandle last_torus;  // of a closed surface, whose last hole is a handle: in the frame of the last
                              // link, or of `first` where there is none
    std::vector<MarkingChoice> choices;
    double smallest_gap = 0.0;
};

/// "near-ties in the marking: a1 (0.0002), ..." for gaps below 0.01, or "".
std::string near_ties(const std::vector<MarkingChoice>& choices);

struct MarkingOptions {
    double near_tie = 0.1;            // gaps are looked for up to here; larger ones count as this
    std::int64_t budget = 400000000;  // edges of the universal cover to cross in all
};

/// Throws std::runtime_error where the budget ends.
Marking make_marking(const ExactSurface& surface, const MarkingOptions& options = {});
Marking make_marking(const CoarseSurface& surface, const MarkingOptions& options = {});

/// First halfedge of every boundary component, by lowest number. // r
std::vector<Index> boundary_halfedges(const CoarseSurface& surface);

/// The boundary component through `halfedge` as a closed geodesic at its tail, the surface on its left.
BasedCurve boundary_curve(const ExactSurface& surface, Index halfedge);

}  // namespace ricci
