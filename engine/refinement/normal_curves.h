// How one triangulation runs across another on the same vertices, kept up to date while edges flip.
//
// The edges of the original triangulation are geodesics of a metric in which every flip is geodesic too (the
// flat one for isometric flips, the one of ideal hyperbolic triangles for Ptolemy flips). So within a
// triangle each of them cuts off a corner, or leaves one corner and crosses the opposite side, and how often
// they cross the three sides tells which (normal curves; Gillespie, Sharp, Crane 2021, Integer coordinates
// for intrinsic geometry processing).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// An edge of the original triangulation with a direction: 2 * edge, plus 1 against the edge's lowest
/// halfedge.
using DirectedEdge = Index;
constexpr DirectedEdge reversed(DirectedEdge edge) {
    return edge ^ 1;
}
/// The directed edge of each halfedge. // 3F
std::vector<DirectedEdge> directed_edges(const Connectivity& connectivity);

/// Where a curve leaves a face: across a halfedge of that face, the `position`-th curve along it (from 0 at
/// the tail).
struct Crossing {
    Index halfedge = -1;
    Index position = 0;
};

/// Every original edge's way through the current triangulation, from its tail to its head.
struct CurvePaths {
    std::vector<Index> shared;       // E': the current halfedge that it coincides with, or -1
    std::vector<Index> first;        // E'+1: range in crossing
    std::vector<Crossing> crossing;  // halfedges of the faces that are left, in order
    [[nodiscard]] std::span<const Crossing> of(Index edge) const {
        const auto begin = static_cast<std::size_t>(first[static_cast<std::size_t>(edge)]);
        const auto end = static_cast<std::size_t>(first[static_cast<std::size_t>(edge) + 1]);
        return {crossing.data() + begin, end - begin};
    }
};

class NormalCurves {
  public:
    /// The original triangulation on itself. Boundary edges must not flip.
    explicit NormalCurves(const Connectivity& original);

    /// Flips the edge of h (see flip_edge). Precondition: flippable, and the flip is geodesic in the common
    /// metric.
    void flip(Index h);

    [[nodiscard]] const Connectivity& connectivity() const { return current_; }
    /// Number of curves across the edge of h.
    [[nodiscard]] Index count(Index h) const;
    /// The curve at `position` along h, directed as it leaves the face of h.
    [[nodiscard]] DirectedEdge curve(Index h, Index position) const;
    /// The original edge that runs along h, in the direction of h; -1: none.
    [[nodiscard]] DirectedEdge shared(Index h) const;

    /// Where a curve that enters a face across its halfedge h at `position` goes: the halfedge where it
    /// leaves, or (halfedge -1) the corner opposite h.
    [[nodiscard]] Crossing follow(Index h, Index position) const;

    /// Throws std::logic_error where the curves do not add up (a flip was not geodesic).
    [[nodiscard]] CurvePaths trace() const;

  private:
    [[nodiscard]] std::array<Index, 3> corner_arcs(Index face) const;
    [[nodiscard]] std::array<Index, 2> corner_range(Index h) const;

    Connectivity current_;
    std::vector<std::uint8_t> along_;               // 3F: the halfedge runs along its edge's direction
    std::vector<std::vector<DirectedEdge>> curve_;  // E: curves in order along the edge, each directed from
                                                    // its left to its right
    std::vector<DirectedEdge> shared_;              // E: in the direction of the edge, or -1
    Index original_edges_ = 0;
    std::vector<Index> original_tail_;  // E: vertex at the tail of each original edge
};

}  // namespace ricci
