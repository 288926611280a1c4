// The Jacobian dK/du of curvature as a sparse symmetric matrix over the unknowns.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "engine/linear/symmetric_solver.h"
#include "kernels/connectivity.h"

namespace ricci {

/// Assembles face contributions into the matrix. Unknowns are vertices under a map: several vertices may
/// share one (mirror images of a double), others have none (fixed).
class HessianAssembler {
  public:
    /// `unknown`: one per vertex of the connectivity, -1: none.
    void build(const Connectivity& connectivity, std::span<const Index> unknown, Index unknown_count);

    /// Adds entries (pairs of vertices) to the pattern, where they are not in it yet: room for edges that
    /// flips may make. Returns whether the pattern grew.
    bool reserve(std::span<const std::pair<Index, Index>> pairs);

    /// Follows flips: `touched_faces` are the faces of all edges flipped since. Returns true when the pattern
    /// had to grow; it then gets room for the next flips nearby as well.
    bool follow_flips(const Connectivity& connectivity, std::span<const Index> touched_faces);

    /// Fills `values` (nonzeros of the pattern): H_ij = -sum off, H_ii = -sum diag. `off`, `diagonal`: 3F,
    /// derivatives of the angles. `pinned`: an unknown whose row and column become the identity's, or -1.
    void assemble(const Connectivity& connectivity, std::span<const double> off,
                  std::span<const double> diagonal, Index pinned, std::vector<double>& values) const;

    [[nodiscard]] const SymmetricPattern& pattern() const { return pattern_; }
    /// Positions of the diagonal entries. // U
    [[nodiscard]] std::span<const Index> diagonal_positions() const { return diagonal_position_; }

  private:
    /// Position of entry (i, j) of unknowns; kFixed where one of them is none, kAbsent where the pattern
    /// lacks it.
    [[nodiscard]] Index find(Index i, Index j) const;

    static constexpr Index kFixed = -1, kAbsent = -2;

    std::vector<Index> unknown_;
    SymmetricPattern pattern_;
    std::vector<Index> diagonal_position_;  // U
    std::vector<Index> edge_position_;  // E: position of H_ij; of H_ii for a loop; -1 where an end is fixed
};

/// Pairs of vertices that edges may come to join when edges near `seeds` flip: the opposite corners of every
/// edge within `far` rings, and each seed (of a few) with every vertex within `near` rings.
std::vector<std::pair<Index, Index>> likely_flips(const Connectivity& connectivity,
                                                  std::span<const Index> seeds, int near, int far);

}  // namespace ricci
