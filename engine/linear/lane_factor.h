// One Cholesky factor for all lanes and threads, as preconditioner: single precision, back-solves of kLanes
// right-hand sides at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/linear/symmetric_solver.h"
#include "kernels/instruction_set.h"
#include "kernels/lanes.h"

namespace ricci {

/// Successive columns of a LaneFactor that are eliminated together: those of a supernode, or some of them.
/// With L_11 their triangle and L_21 the rows below, it holds S = (L_11 L_11^T)^-1 and M = L_21 L_11^-1: the
/// sweeps are then products without any substitution, whose steps would wait for each other.
struct LanePanel {
    std::uint32_t row_begin = 0;  // of its own columns, which the rows of M follow
    Index width = 0;              // columns
    Index height = 0;             // rows of M
};

/// The factor rounded to single precision and laid out for the solves. Read-only: one for all threads.
class LaneFactor {
  public:
    /// `set`: an instruction set that this processor has. Throws std::invalid_argument where the arrays of
    /// `factor` do not fit together or a diagonal entry is not positive.
    explicit LaneFactor(const SupernodalFactor& factor, InstructionSet set = instruction_set());

    /// Position in elimination order -> unknown.
    [[nodiscard]] std::span<const Index> elimination_order() const { return permutation_; }
    [[nodiscard]] Index size() const { return static_cast<Index>(permutation_.size()); }
    /// Solves A x = b for kLanes right-hand sides at a time, in place, rows in elimination order. Lanes do
    /// not interact. Numbers below 1.2e-38 count as zero (on x86). `block`: at least n rows; only the first n
    /// are used.
    void solve(LaneArray<float>& block) const;
    [[nodiscard]] std::int64_t bytes() const;
    /// Entries of L, counting those that supernodes store as zeros.
    [[nodiscard]] std::int64_t entries() const { return entries_; }

  private:
    /// `m`: the beginning of all M, `s`: the end of all -S.
    using Sweeps = void (*)(std::span<const LanePanel> panels, const float* m, const float* s,
                            const std::uint32_t* row, float* block);

    std::vector<Index> permutation_;
    std::vector<LanePanel> panels_;
    std::vector<std::uint32_t> row_;  // times kLanes: where the row begins in a block
    std::vector<float> below_;        // M of each panel, row by row
    std::vector<float> diagonal_;     // -S of each panel
    std::int64_t entries_ = 0;
    Sweeps sweeps_ = nullptr;
};

}  // namespace ricci
