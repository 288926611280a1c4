// The Jacobian dK/du of curvature as a sparse symmetric matrix over the unknowns.
#pragma once

#include <span>
#include <vector>

#include "engine/linear/symmetric_solver.h"
#include "kernels/connectivity.h"

namespace ricci {

/// Assembles face contributions into the matrix. Unknowns are vertices under a map: several vertices may share one
/// (mirror images of a double), others have none (fixed).
class HessianAssembler {
  public:
    /// `unknown`: one per vertex of the connectivity, -1: none.
    void build(const Connectivity& connectivity, std::span<const Index> unknown, Index unknown_count);

    /// Follows flips: `touched_faces` are the faces of all edges flipped since. Returns true when the pattern changed
    /// (then it is built anew); where the new edges were in the pattern already, it stays.
    bool follow_flips(const Connectivity& connectivity, std::span<const Index> touched_faces);

    /// Fills `values` (nonzeros of the pattern): H_ij = -sum off, H_ii = -sum diag. `off`, `diagonal`: 3F, derivatives of
    /// the angles. `pinned`: an unknown whose row and column become the identity's, or -1.
    void assemble(const Connectivity& connectivity, std::span<const double> off, std::span<const double> diagonal,
                  Index pinned, std::vector<double>& values) const;

    [[nodiscard]] const SymmetricPattern& pattern() const { return pattern_; }
    /// Positions of the diagonal entries. // U
    [[nodiscard]] std::span<const Index> diagonal_positions() const { return diagonal_position_; }

  private:
    [[nodiscard]] Index find(Index i, Index j) const;

    std::vector<Index> unknown_;
    SymmetricPattern pattern_;
    std::vector<Index> diagonal_position_;  // U
    std::vector<Index> edge_position_;      // E: position of H_ij; of H_ii for a loop; -1 where an end is fixed
};

}  // namespace ricci
