#ifndef RICCI_HAS_CHOLMOD

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/linear/symmetric_solver.h"

namespace ricci {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

class EigenSolver final : public SymmetricSolver {
  public:
    explicit EigenSolver(Definiteness definiteness) : positive_(definiteness == Definiteness::positive) {}

    void choose_ordering(const SymmetricPattern& pattern, Ordering /*ordering*/) override {
        analyze(pattern);
    }

    // Eigen orders anew at every analysis, which for minimum degree costs little.
    [[nodiscard]] std::span<const Index> ordering() const override { return {}; }
    void use_ordering(std::span<const Index> /*ordering*/) override {}

    void analyze(const SymmetricPattern& pattern) override {
        factorized_ = false;
        pattern_ = pattern;
        values_.assign(pattern_.row.size(), 1.0);
        factor_.analyzePattern(view());
    }

    bool factorize(std::span<const double> values) override {
        values_.assign(values.begin(), values.end());
        factor_.factorize(view());
        factorized_ = factor_.info() == Eigen::Success && (!positive_ || factor_.vectorD().minCoeff() > 0.0);
        return factorized_;
    }

    void solve(std::span<const double> rhs, std::span<double> solution) override {
        const Eigen::Map<const Eigen::VectorXd> b(rhs.data(), static_cast<Eigen::Index>(rhs.size()));
        const Eigen::VectorXd x = factor_.solve(b);
        Eigen::Map<Eigen::VectorXd>(solution.data(), x.size()) = x;
    }

    [[nodiscard]] SupernodalFactor supernodal_factor() const override {
        if (!factorized_ || !(factor_.vectorD().minCoeff() > 0.0))
            throw std::logic_error("no Cholesky factor to share");
        const auto& l = factor_.matrixL().nestedExpression();  // strictly below its diagonal of ones
        const auto n = static_cast<Index>(l.cols());
        SupernodalFactor shared;
        for (Index j = 0; j < n; ++j) {
            const double root = std::sqrt(factor_.vectorD()[j]);
            shared.first_column.push_back(j);
            shared.row_begin.push_back(static_cast<std::int64_t>(shared.row.size()));
            shared.row.push_back(j);
            shared.value.push_back(root);
            for (SparseMatrix::InnerIterator entry(l, j); entry; ++entry) {
                if (entry.row() <= j) continue;
                shared.row.push_back(static_cast<Index>(entry.row()));
                shared.value.push_back(root * entry.value());
            }
        }
        shared.first_column.push_back(n);
        shared.row_begin.push_back(static_cast<std::int64_t>(shared.row.size()));
        shared.value_begin = shared.row_begin;
        // Eigen's P takes unknown i to position indices()[i].
        shared.permutation.resize(static_cast<std::size_t>(n));
        const auto& position = factor_.permutationP().indices();
        for (Index i = 0; i < n; ++i)
            shared.permutation[static_cast<std::size_t>(position.size() == 0 ? i : position[i])] = i;
        return shared;
    }

    [[nodiscard]] std::int64_t factor_bytes() const override {
        return 12 * static_cast<std::int64_t>(factor_.matrixL().nestedExpression().nonZeros());
    }

  private:
    [[nodiscard]] Eigen::Map<const SparseMatrix> view() const {
        const auto n = static_cast<Eigen::Index>(pattern_.size());
        return {n,
                n,
                static_cast<Eigen::Index>(pattern_.row.size()),
                pattern_.column_begin.data(),
                pattern_.row.data(),
                values_.data()};
    }

    bool positive_, factorized_ = false;
    SymmetricPattern pattern_;
    std::vector<double> values_;
    Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
};

}  // namespace

std::unique_ptr<SymmetricSolver> make_symmetric_solver(Definiteness definiteness) {
    return std::make_unique<EigenSolver>(definiteness);
}

std::string_view symmetric_solver_name() {
    static const std::string name = "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
                                    std::to_string(EIGEN_MAJOR_VERSION) + "." +
                                    std::to_string(EIGEN_MINOR_VERSION);
    return name;
}

}  // namespace ricci

#endif  // RICCI_HAS_CHOLMOD
