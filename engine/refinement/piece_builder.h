// Builds the pieces of a common refinement, one face of the middle triangulation after the other.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/refinement/common_refinement.h"
#include "engine/refinement/edge_nodes.h"
#include "engine/refinement/face_arrangement.h"

namespace ricci {

/// Refers to what it is made of; run() appends all pieces to `out`, whose `first` is {0}.
class PieceBuilder {
  public:
    /// `log_length`: 3F of the middle triangulation, flat; `u`: V.
    PieceBuilder(const Crossings& crossings, const EdgeNodes& nodes, std::span<const long double> log_length,
                 std::span<const double> u, CommonRefinement& out)
        : x_(crossings),
          nodes_(nodes),
          log_length_(log_length),
          u_(u),
          out_(out),
          input_segments_(crossings.middle->tail.size() / 3),
          final_segments_(crossings.middle->tail.size() / 3),
          side_corner_(nodes.stretch.size(), {-1, -1}) {}

    void run();
    /// Per crossing inside a face: the nodes or vertices at the ends of the input segment, and the fraction.
    struct Inside {
        Index vertex, from, to;
        long double fraction;
    };
    [[nodiscard]] const std::vector<Inside>& inside() const { return inside_; }

  private:
    /// Place on the boundary of face f of the node `number` (global) that lies on halfedge h of f.
    [[nodiscard]] Index place(Index h, Index number) const;
    [[nodiscard]] Index corner_place(Index h) const;

    void collect_input_segments();

    void collect_final_segments();

    /// A segment across a middle face.
    struct Segment {
        ArrangedSegment placed;
        Index code = 0;  // input: directed edge; final: halfedge, both in the direction from -> to
    };
    /// What lies at a place of the face being built.
    struct Place {
        Index vertex = 0;  // of the refinement
        std::array<long double, 2> flat{};
        Index side = 0;      // halfedge that starts here or on which it lies
        Index stretch = -1;  // stretch of that halfedge's edge after this place
    };

    void lay_out_places(Index f);
    [[nodiscard]] Index first_node_vertex() const { return x_.input->vertex_count; }

    void add_face(Index f);

    /// Points where input and final segments cross.
    void cross_segments();

    void add_polygon(Index f, std::span<const ArrangedEdge> edges, Index corner_base);

    [[nodiscard]] Index input_halfedge_of(DirectedEdge code) const;

    /// Input and final face of the pieces of one middle face: from the sides that lie on their edges, and
    /// from neighbours across sides that do not.
    void name_pieces(Index piece_base, Index corner_base);

    /// Weights of a place as seen from the boundary side that starts (or ends) there.
    [[nodiscard]] std::array<long double, 3> boundary_weights(const Place& side, bool at_start) const;

    /// Corner of its final face that the piece starting at corner c (which leaves a corner of the middle face
    /// across its inside) has there: that of the last final edge counterclockwise before it, or of the middle
    /// edge.
    [[nodiscard]] std::array<long double, 3> inner_corner_weights(Index c, Index place) const;

    void weigh_corners(Index piece_base, Index corner_base);

    /// Weights of crossing x in the final face on the left of `edge`, a side on a final segment.
    [[nodiscard]] std::array<long double, 3> inside_weights(std::size_t x, const ArrangedEdge& edge) const;

    /// A place on a final edge: weights of the tail and head of its halfedge `code`.
    [[nodiscard]] std::array<long double, 2> on_final_edge(Index place, Index code, bool start) const;

    const Crossings& x_;
    const EdgeNodes& nodes_;
    std::span<const long double> log_length_;
    std::span<const double> u_;
    CommonRefinement& out_;
    std::vector<std::vector<Segment>> input_segments_, final_segments_;  // per middle face
    std::vector<std::array<Index, 2>> side_corner_;  // per stretch: corner of the piece on its left, right
    std::vector<Index> input_lowest_ = edge_halfedges(*x_.input);
    std::vector<Inside> inside_;
    // Of the face being built.
    FaceArrangement arrangement_;
    std::vector<Place> places_;
    std::vector<ArrangedSegment> placed_first_, placed_second_;
    std::vector<std::array<long double, 2>> crossing_flat_;
    std::vector<long double> crossing_on_final_;
    std::vector<Index> crossing_vertex_;
    std::vector<std::array<long double, 3>> weights_;
    Index current_base_ = 0;
};

}  // namespace ricci
