// Two families of segments across one triangle, cut into polygons by combinatorics alone.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// A segment between two places on the boundary of a triangle. Places are numbered counterclockwise: corner
/// 0, the nodes on side 0, corner 1, and so on. Segments of one family do not cross one another; those of
/// different families cross where their ends alternate.
struct ArrangedSegment {
    Index from = 0, to = 0;
    Index tag = -1;  // the caller's: what the segment is, in the direction from -> to
};

/// One side of a polygon.
struct ArrangedEdge {
    enum class Kind : std::uint8_t { boundary, first, second } kind = Kind::boundary;
    Index vertex = 0;   // where it starts: a place, or places + number of a crossing
    Index segment = 0;  // boundary: the place where it starts; else the segment
    bool forward = true;
    Index twin = -1;  // the same side of the neighbouring polygon; -1 on the boundary
};

/// Reused from face to face, so that nothing is allocated once it has grown.
class FaceArrangement {
  public:
    /// `places`: number of places on the boundary.
    void build(Index places, std::span<const ArrangedSegment> first, std::span<const ArrangedSegment> second);

    /// Polygons, counterclockwise. // polygon p: edges polygon_begin()[p] ... polygon_begin()[p + 1]
    [[nodiscard]] std::span<const Index> polygon_begin() const { return polygon_begin_; }
    [[nodiscard]] std::span<const ArrangedEdge> edges() const { return edges_; }
    /// Segments of the first and of the second family that cross, per crossing.
    [[nodiscard]] std::span<const std::array<Index, 2>> crossings() const { return crossings_; }

  private:
    struct Cut {
        Index crossing, ccw, cw;
    };
    void find_crossings();
    void link();
    void trace();
    [[nodiscard]] Index distance(Index from, Index to) const {
        return to >= from ? to - from : to - from + places_;
    }

    Index places_ = 0;
    std::array<std::span<const ArrangedSegment>, 2> family_;
    std::vector<std::array<Index, 2>> crossings_;
    std::vector<std::vector<Cut>> cuts_;  // per segment (first family, then second): crossings in order
    std::vector<Index> piece_begin_;      // per segment: its first sub-edge
    std::vector<ArrangedEdge> half_;      // boundary half-edges, then sub-edges forward and backward in turn
    std::vector<Index> next_, place_of_;  // per half-edge
    std::vector<std::vector<std::array<Index, 2>>> leaving_;  // per place: (distance, half-edge) of segments
    std::vector<Index> polygon_begin_;
    std::vector<ArrangedEdge> edges_;
};

}  // namespace ricci
