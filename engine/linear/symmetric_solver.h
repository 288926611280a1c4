// Sparse symmetric factorisation behind one small interface: CHOLMOD (supernodal) or Eigen.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// Pattern of a symmetric matrix by columns: lower triangle with the diagonal, rows ascending, no duplicates.
struct SymmetricPattern {
    std::vector<Index> column_begin;  // n+1
    std::vector<Index> row;           // nonzeros

    [[nodiscard]] Index size() const { return static_cast<Index>(column_begin.size()) - 1; }
    friend bool operator==(const SymmetricPattern&, const SymmetricPattern&) = default;
};

/// Fill-reducing orderings. Nested dissection costs several times the analysis of minimum degree and gives
/// the sparser factor: for many solves on one pattern. Eigen knows minimum degree only.
enum class Ordering : std::uint8_t { minimum_degree, nested_dissection };

/// positive: Cholesky, fails on anything not numerically positive definite. indefinite: L D L^T without
/// pivoting, fails on a zero pivot only; no bound on its growth, so callers check residuals.
enum class Definiteness : std::uint8_t { positive, indefinite };

/// A factor L of P A P^T = L L^T by supernodes: groups of successive columns (in elimination order) with the
/// same rows below. Supernode s has columns [first_column[s], first_column[s+1]) and rows row[row_begin[s]
/// ... row_begin[s+1]), the first of which are its own columns. Its entries lie column by column (as many per
/// column as it has rows) from value_begin[s], with the strict upper triangle unused.
struct SupernodalFactor {
    std::vector<Index> first_column;        // S+1
    std::vector<std::int64_t> row_begin;    // S+1
    std::vector<Index> row;                 // in elimination order, ascending within a supernode
    std::vector<std::int64_t> value_begin;  // S+1
    std::vector<double> value;
    std::vector<Index> permutation;  // position in elimination order -> unknown
};

/// One factor and its workspace; not thread-safe, one per thread.
class SymmetricSolver {
  public:
    virtual ~SymmetricSolver() = default;

    /// Chooses the fill-reducing ordering for a pattern (the expensive part) and analyses it.
    virtual void choose_ordering(const SymmetricPattern& pattern, Ordering ordering) = 0;
    /// The ordering in use, to be shared with other solvers of the same size. Empty where the implementation
    /// keeps none.
    [[nodiscard]] virtual std::span<const Index> ordering() const = 0;
    /// Takes over an ordering instead of choosing one; analyse afterwards.
    virtual void use_ordering(std::span<const Index> ordering) = 0;
    /// Symbolic analysis of a pattern of the same size under the ordering chosen before: cheap, for patterns
    /// that a few edge flips changed.
    virtual void analyze(const SymmetricPattern& pattern) = 0;
    /// Numeric factorisation. `values`: one per nonzero of the analysed pattern. False: not (positive)
    /// definite.
    virtual bool factorize(std::span<const double> values) = 0;
    /// Solves with the last factor. `rhs`, `solution`: n each (may be the same span).
    virtual void solve(std::span<const double> rhs, std::span<double> solution) = 0;
    /// A copy of the last factor, for sharing. Throws std::logic_error where there is none or the matrix is
    /// not positive definite.
    [[nodiscard]] virtual SupernodalFactor supernodal_factor() const = 0;
    /// Bytes of the factor, known after the analysis.
    [[nodiscard]] virtual std::int64_t factor_bytes() const = 0;
};

std::unique_ptr<SymmetricSolver> make_symmetric_solver(Definiteness definiteness);

/// "CHOLMOD 3.0.14" or "Eigen 3.4.0".
std::string_view symmetric_solver_name();

}  // namespace ricci
