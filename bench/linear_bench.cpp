// The linear solver on a grounded cotangent Laplacian: ordering, analysis, numeric factorisation, back-solve.
// The baseline, in the same run, is Eigen's SimplicialLDLT. One item is one unknown.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <memory>

#include "bench/grounded_laplacian.h"
#include "engine/linear/symmetric_solver.h"

namespace {

using namespace ricci;
using bench::at;

struct Matrix {
    SymmetricPattern pattern;
    std::vector<double> values, rhs;
};

Matrix make_matrix(Index faces) {
    const bench::GroundedLaplacian laplacian = bench::grounded_laplacian(faces);
    Matrix matrix{laplacian.pattern, laplacian.values, {}};
    for (Index v = 0; v < matrix.pattern.size(); ++v) matrix.rhs.push_back(std::sin(0.1 * v));
    return matrix;
}

/// max |A x - b| over the largest entry of x: backward stable solves leave a few roundings per row.
bool solves(const Matrix& m, const std::vector<double>& x) {
    std::vector<double> residual = m.rhs;
    double largest = 0.0;
    for (Index j = 0; j < m.pattern.size(); ++j) {
        largest = std::max(largest, std::abs(x[at(j)]));
        for (Index p = m.pattern.column_begin[at(j)]; p < m.pattern.column_begin[at(j) + 1]; ++p) {
            const Index i = m.pattern.row[at(p)];
            residual[at(i)] -= m.values[at(p)] * x[at(j)];
            if (i != j) residual[at(j)] -= m.values[at(p)] * x[at(i)];
        }
    }
    for (const double r : residual)
        if (!(std::abs(r) <= 1e-11 * (1.0 + largest))) return false;
    return true;
}

void finish(benchmark::State& state, SymmetricSolver& solver, const Matrix& matrix) {
    std::vector<double> x(matrix.rhs.size());
    if (!solver.factorize(matrix.values)) state.SkipWithError("not positive definite");
    solver.solve(matrix.rhs, x);
    if (!solves(matrix, x)) state.SkipWithError("wrong solution");
    state.SetItemsProcessed(state.iterations() * matrix.pattern.size());
    state.counters["factor_MB"] = 1e-6 * static_cast<double>(solver.factor_bytes());
}

template <Ordering ordering>
void choose_ordering(benchmark::State& state) {
    const Matrix matrix = make_matrix(static_cast<Index>(state.range(0)));
    const auto solver = make_symmetric_solver(Definiteness::positive);
    for (auto _ : state) solver->choose_ordering(matrix.pattern, ordering);
    finish(state, *solver, matrix);
}

template <Ordering ordering>
void analyze(benchmark::State& state) {
    const Matrix matrix = make_matrix(static_cast<Index>(state.range(0)));
    const auto solver = make_symmetric_solver(Definiteness::positive);
    solver->choose_ordering(matrix.pattern, ordering);
    for (auto _ : state) solver->analyze(matrix.pattern);
    finish(state, *solver, matrix);
}

template <Ordering ordering>
void factorize(benchmark::State& state) {
    const Matrix matrix = make_matrix(static_cast<Index>(state.range(0)));
    const auto solver = make_symmetric_solver(Definiteness::positive);
    solver->choose_ordering(matrix.pattern, ordering);
    bool definite = true;
    for (auto _ : state) definite = solver->factorize(matrix.values) && definite;
    if (!definite) state.SkipWithError("not positive definite");
    finish(state, *solver, matrix);
}

template <Ordering ordering>
void back_solve(benchmark::State& state) {
    const Matrix matrix = make_matrix(static_cast<Index>(state.range(0)));
    const auto solver = make_symmetric_solver(Definiteness::positive);
    solver->choose_ordering(matrix.pattern, ordering);
    if (!solver->factorize(matrix.values)) return state.SkipWithError("not positive definite");
    std::vector<double> x(matrix.rhs.size());
    for (auto _ : state) {
        solver->solve(matrix.rhs, x);
        benchmark::ClobberMemory();
    }
    finish(state, *solver, matrix);
    state.SetBytesProcessed(state.iterations() * 2 * solver->factor_bytes());  // read forwards and backwards
}

using EigenMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

EigenMatrix eigen_matrix(const Matrix& m) {
    return Eigen::Map<const EigenMatrix>(
        m.pattern.size(), m.pattern.size(), static_cast<Eigen::Index>(m.pattern.row.size()),
        m.pattern.column_begin.data(), m.pattern.row.data(), m.values.data());
}

using EigenSolver = Eigen::SimplicialLDLT<EigenMatrix, Eigen::Lower, Eigen::AMDOrdering<Index>>;

enum class Part { analyze, factorize, back_solve };

template <Part part>
void eigen(benchmark::State& state) {
    const Matrix matrix = make_matrix(static_cast<Index>(state.range(0)));
    const EigenMatrix a = eigen_matrix(matrix);
    const Eigen::Map<const Eigen::VectorXd> b(matrix.rhs.data(), a.rows());
    EigenSolver solver;
    solver.analyzePattern(a);
    solver.factorize(a);
    Eigen::VectorXd x = solver.solve(b);
    for (auto _ : state) {
        if constexpr (part == Part::analyze) solver.analyzePattern(a);
        if constexpr (part == Part::factorize) solver.factorize(a);
        if constexpr (part == Part::back_solve) x = solver.solve(b);
        benchmark::ClobberMemory();
    }
    if (solver.info() != Eigen::Success || !solves(matrix, {x.begin(), x.end()}))
        state.SkipWithError("wrong solution");
    state.SetItemsProcessed(state.iterations() * matrix.pattern.size());
}

#define RICCI_SIZES ->Arg(2000)->Arg(24000)->Arg(100000)->Unit(benchmark::kMillisecond)
BENCHMARK(choose_ordering<Ordering::minimum_degree>) RICCI_SIZES;
BENCHMARK(choose_ordering<Ordering::nested_dissection>) RICCI_SIZES;
BENCHMARK(eigen<Part::analyze>) RICCI_SIZES;
BENCHMARK(analyze<Ordering::minimum_degree>) RICCI_SIZES;
BENCHMARK(analyze<Ordering::nested_dissection>) RICCI_SIZES;
BENCHMARK(factorize<Ordering::minimum_degree>) RICCI_SIZES;
BENCHMARK(factorize<Ordering::nested_dissection>) RICCI_SIZES;
BENCHMARK(eigen<Part::factorize>) RICCI_SIZES;
BENCHMARK(back_solve<Ordering::minimum_degree>) RICCI_SIZES;
BENCHMARK(back_solve<Ordering::nested_dissection>) RICCI_SIZES;
BENCHMARK(eigen<Part::back_solve>) RICCI_SIZES;
#undef RICCI_SIZES

}  // namespace
