// Frames carried along edge paths of the input surface, through the pieces of the common refinement.
#pragma once

#include <span>
#include <vector>

#include "engine/layout/final_metric.h"
#include "engine/topology/homotopy_basis.h"

namespace ricci {

/// Where the walks start and which pieces lie along an input edge; no numbers. Refers to the refinement.
class PieceWalks {
  public:
    /// `basis` tells cones: directions at a cone are counted counterclockwise from its tree edge.
    PieceWalks(const CommonRefinement& refinement, const Connectivity& input, const HomotopyBasis& basis);

    /// Corner at vertex v whose piece carries v's frame: at the boundary the first counterclockwise, at a
    /// cone the one on the right of the tree edge into it.
    [[nodiscard]] Index home(Index v) const { return home_[static_cast<std::size_t>(v)]; }
    /// Corner at the tail of input halfedge h from which its side leaves, the piece on the left of h.
    [[nodiscard]] Index start(Index h) const { return start_[static_cast<std::size_t>(h)]; }
    /// Next corner counterclockwise about the same vertex; -1 beyond the boundary.
    [[nodiscard]] Index turned(Index corner) const {
        return refinement_->twin[static_cast<std::size_t>(refinement_->previous(corner))];
    }

    /// Final halfedges crossed from home(tail) to home(head) along the left side of h; ~g where g is crossed
    /// backwards (from its twin's face). Appends.
    void append_walk(Index h, std::vector<Index>& crossed) const;
    /// Once around v counterclockwise from home(v) back to it.
    void append_turn(Index v, std::vector<Index>& crossed) const;

  private:
    void append_turn_between(Index from, Index to, std::vector<Index>& crossed) const;

    const CommonRefinement* refinement_;
    std::vector<Index> home_, start_;
};

/// Isometries of letters and words in the frame at the base (thesis, section 6.2.2.3): the deck
/// transformation of a loop is the product of the moves along it.
template <class Real>
class Holonomy {
  public:
    Holonomy(const FinalMetric<Real>& metric, const CommonRefinement& refinement, const Connectivity& input,
             const HomotopyBasis& basis);

    /// One per letter of the basis.
    [[nodiscard]] const std::vector<Isometry<Real>>& letters() const { return letters_; }
    /// The product of a word; `reach` (unless null) becomes the largest |a|^2 + |b|^2 on the way.
    [[nodiscard]] Isometry<Real> of(std::span<const Index> word, Real* reach = nullptr) const;

  private:
    [[nodiscard]] Isometry<Real> walk(Index h) const;
    [[nodiscard]] Isometry<Real> product(std::span<const Index> crossed) const;
    const Isometry<Real>& frame(Index v);
    [[nodiscard]] Isometry<Real> element(Step step);

    const FinalMetric<Real>* metric_;
    const CommonRefinement* refinement_;
    const Connectivity* input_;
    const HomotopyBasis* basis_;
    PieceWalks walks_;
    std::vector<Index> cone_of_;          // V, number of the cone, or -1
    std::vector<Isometry<Real>> frames_;  // V, frame at v along the tree
    std::vector<std::uint8_t> known_;
    std::vector<Isometry<Real>> letters_;
};

}  // namespace ricci
