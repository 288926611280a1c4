#ifdef RICCI_HAS_CHOLMOD

#include <cholmod.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>

#include "engine/linear/ordering_failure.h"
#include "engine/linear/symmetric_solver.h"

// OpenBLAS's own; absent where another BLAS is linked.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));

namespace ricci {
namespace {

/// The workers are the threads; a BLAS that starts its own would oversubscribe the processors.
void keep_blas_serial() {
    static const bool done = [] {
        if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
        return true;
    }();
    static_cast<void>(done);
}

SupernodalFactor from_supernodes(const cholmod_factor& factor) {
    const auto* first = static_cast<const int*>(factor.super);
    const auto* row_begin = static_cast<const int*>(factor.pi);
    const auto* value_begin = static_cast<const int*>(factor.px);
    const auto* row = static_cast<const int*>(factor.s);
    const auto* value = static_cast<const double*>(factor.x);
    const std::size_t count = factor.nsuper + 1;
    SupernodalFactor shared;
    shared.first_column.assign(first, first + count);
    shared.row_begin.assign(row_begin, row_begin + count);
    shared.value_begin.assign(value_begin, value_begin + count);
    shared.row.assign(row, row + shared.row_begin.back());
    shared.value.assign(value, value + shared.value_begin.back());
    return shared;
}

/// Of a simplicial factor: every column is a supernode.
SupernodalFactor from_columns(const cholmod_factor& factor) {
    const auto* begin = static_cast<const int*>(factor.p);
    const auto* entries = static_cast<const int*>(factor.nz);
    const auto* row = static_cast<const int*>(factor.i);
    const auto* value = static_cast<const double*>(factor.x);
    SupernodalFactor shared;
    for (std::size_t j = 0; j < factor.n; ++j) {
        // L D L^T keeps D on the diagonal of L, whose own is one.
        const double d = value[begin[j]], root = std::sqrt(d);
        if (factor.is_ll == 0 && !(d > 0.0)) throw std::logic_error("no Cholesky factor to share");
        shared.first_column.push_back(static_cast<Index>(j));
        shared.row_begin.push_back(static_cast<std::int64_t>(shared.row.size()));
        for (int k = begin[j]; k < begin[j] + entries[j]; ++k) {
            shared.row.push_back(row[k]);
            shared.value.push_back(factor.is_ll != 0 ? value[k] : k == begin[j] ? root : root * value[k]);
        }
    }
    shared.first_column.push_back(static_cast<Index>(factor.n));
    shared.row_begin.push_back(static_cast<std::int64_t>(shared.row.size()));
    shared.value_begin = shared.row_begin;
    return shared;
}

class CholmodSolver final : public SymmetricSolver {
  public:
    explicit CholmodSolver(Definiteness definiteness) {
        keep_blas_serial();
        cholmod_start(&common_);
        common_.print = 0;
        common_.error_handler = nullptr;
        common_.nmethods = 1;
        const bool positive = definiteness == Definiteness::positive;
        common_.supernodal = positive ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
        common_.final_ll = positive ? 1 : 0;
        common_.quick_return_if_not_posdef = 1;
    }
    ~CholmodSolver() override {
        cholmod_free_factor(&factor_, &common_);
        cholmod_free_dense(&solution_, &common_);
        cholmod_free_dense(&work_y_, &common_);
        cholmod_free_dense(&work_e_, &common_);
        cholmod_finish(&common_);
    }
    CholmodSolver(const CholmodSolver&) = delete;
    CholmodSolver& operator=(const CholmodSolver&) = delete;

    void choose_ordering(const SymmetricPattern& pattern, Ordering ordering) override {
        common_.method[0].ordering = ordering == Ordering::nested_dissection ? CHOLMOD_METIS : CHOLMOD_AMD;
        {
            // METIS draws from the C library's one random sequence, which it seeds itself: two threads at a
            // time would get orderings, and so bits, that depend on their timing.
            static std::mutex metis;
            const std::lock_guard lock(metis);
            analyze_with(pattern, nullptr);
        }
        if (take_ordering_failure()) throw std::bad_alloc();
        const auto* permutation = static_cast<const int*>(factor_->Perm);
        permutation_.assign(permutation, permutation + factor_->n);
    }

    [[nodiscard]] std::span<const Index> ordering() const override { return permutation_; }
    void use_ordering(std::span<const Index> ordering) override {
        permutation_.assign(ordering.begin(), ordering.end());
    }

    void analyze(const SymmetricPattern& pattern) override {
        common_.method[0].ordering = CHOLMOD_GIVEN;
        analyze_with(pattern, permutation_.data());
    }

    bool factorize(std::span<const double> values) override {
        // CHOLMOD's supernodal code opens an OpenMP region with a thread count of its own, once per worker:
        // oversubscription, which others have measured at three orders of magnitude. No active levels: every
        // region runs on its caller.
        omp_set_max_active_levels(0);
        cholmod_sparse matrix = view(pattern_, values);
        cholmod_factorize(&matrix, factor_, &common_);
        if (common_.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
        return common_.status == CHOLMOD_OK && factor_->minor == factor_->n;
    }

    void solve(std::span<const double> rhs, std::span<double> solution) override {
        cholmod_dense b{};
        b.nrow = b.nzmax = b.d = rhs.size();
        b.ncol = 1;
        b.x = const_cast<double*>(rhs.data());  // CHOLMOD does not write to it
        b.xtype = CHOLMOD_REAL;
        b.dtype = CHOLMOD_DOUBLE;
        omp_set_max_active_levels(0);
        if (!cholmod_solve2(CHOLMOD_A, factor_, &b, nullptr, &solution_, nullptr, &work_y_, &work_e_,
                            &common_))
            throw std::bad_alloc();
        const auto* x = static_cast<const double*>(solution_->x);
        std::copy(x, x + solution.size(), solution.begin());
    }

    [[nodiscard]] SupernodalFactor supernodal_factor() const override {
        if (factor_ == nullptr || factor_->xtype != CHOLMOD_REAL || factor_->minor != factor_->n)
            throw std::logic_error("no Cholesky factor to share");
        SupernodalFactor shared = factor_->is_super != 0 ? from_supernodes(*factor_) : from_columns(*factor_);
        const auto* permutation = static_cast<const int*>(factor_->Perm);
        shared.permutation.assign(permutation, permutation + factor_->n);
        return shared;
    }

    [[nodiscard]] std::int64_t factor_bytes() const override { return factor_bytes_; }

  private:
    static cholmod_sparse view(const SymmetricPattern& pattern, std::span<const double> values) {
        cholmod_sparse matrix{};
        matrix.nrow = matrix.ncol = static_cast<std::size_t>(pattern.size());
        matrix.nzmax = pattern.row.size();
        matrix.p = const_cast<Index*>(pattern.column_begin.data());
        matrix.i = const_cast<Index*>(pattern.row.data());
        matrix.x = const_cast<double*>(values.data());
        matrix.stype = -1;
        matrix.itype = CHOLMOD_INT;
        matrix.xtype = values.empty() ? CHOLMOD_PATTERN : CHOLMOD_REAL;
        matrix.dtype = CHOLMOD_DOUBLE;
        matrix.sorted = 1;
        matrix.packed = 1;
        return matrix;
    }

    void analyze_with(const SymmetricPattern& pattern, int* permutation) {
        cholmod_free_factor(&factor_, &common_);
        pattern_ = pattern;
        cholmod_sparse matrix = view(pattern_, {});
        factor_ = cholmod_analyze_p(&matrix, permutation, nullptr, 0, &common_);
        if (factor_ == nullptr) throw std::bad_alloc();
        factor_bytes_ =
            static_cast<std::int64_t>(8.0 * std::max(common_.lnz, static_cast<double>(factor_->xsize)));
    }

    cholmod_common common_{};
    cholmod_factor* factor_ = nullptr;
    cholmod_dense *solution_ = nullptr, *work_y_ = nullptr, *work_e_ = nullptr;
    SymmetricPattern pattern_;
    std::vector<int> permutation_;
    std::int64_t factor_bytes_ = 0;
};

}  // namespace

std::unique_ptr<SymmetricSolver> make_symmetric_solver(Definiteness definiteness) {
    return std::make_unique<CholmodSolver>(definiteness);
}

std::string_view symmetric_solver_name() {
    static const std::string name = "CHOLMOD " + std::to_string(CHOLMOD_MAIN_VERSION) + "." +
                                    std::to_string(CHOLMOD_SUB_VERSION) + "." +
                                    std::to_string(CHOLMOD_SUBSUB_VERSION);
    return name;
}

}  // namespace ricci

#endif  // RICCI_HAS_CHOLMOD
