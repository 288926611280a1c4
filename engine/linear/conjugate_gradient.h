// Conjugate gradients preconditioned by the factor of a nearby matrix.
#pragma once

#include <span>
#include <vector>

#include "engine/linear/symmetric_solver.h"

namespace ricci {

/// Solves A x = b for positive definite A (`pattern`, `values`), `nearby` holding a factor of a similar
/// matrix. Stops at |r|_2 <= relative_tolerance |b|_2 and returns true, also after `max_iterations` when
/// |r|_2 <= 1e-2 |b|_2; false when not even that is in reach (as soon as the pace shows it) or A turns out
/// not to be definite: `solution` is then of no use. Serial, sums in index order.
class ConjugateGradient {
  public:
    bool solve(const SymmetricPattern& pattern, std::span<const double> values, SymmetricSolver& nearby,
               std::span<const double> rhs, double relative_tolerance, int max_iterations,
               std::span<double> solution);

    /// Back-solves made by the last call.
    [[nodiscard]] int iterations() const { return iterations_; }

  private:
    int iterations_ = 0;
    std::vector<double> residual_, preconditioned_, direction_, image_;
};

}  // namespace ricci
