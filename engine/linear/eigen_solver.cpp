#ifndef RICCI_HAS_CHOLMOD

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
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
        pattern_ = pattern;
        values_.assign(pattern_.row.size(), 1.0);
        factor_.analyzePattern(view());
    }

    bool factorize(std::span<const double> values) override {
        values_.assign(values.begin(), values.end());
        factor_.factorize(view());
        return factor_.info() == Eigen::Success && (!positive_ || factor_.vectorD().minCoeff() > 0.0);
    }

    void solve(std::span<const double> rhs, std::span<double> solution) override {
        const Eigen::Map<const Eigen::VectorXd> b(rhs.data(), static_cast<Eigen::Index>(rhs.size()));
        const Eigen::VectorXd x = factor_.solve(b);
        Eigen::Map<Eigen::VectorXd>(solution.data(), x.size()) = x;
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

    bool positive_;
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
