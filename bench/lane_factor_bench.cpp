// Back-solves with a shared single-precision factor, kLanes right-hand sides at a time, on the grounded
// Laplacian of a generated surface under nested dissection. The baseline, in the same run, is the double
// solver's back-solve, one right-hand side at a time. One item is one right-hand side.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/clocks.h"
#include "bench/grounded_laplacian.h"
#include "engine/linear/lane_factor.h"
#include "engine/linear/symmetric_solver.h"
#include "kernels/instruction_set.h"

namespace {

using namespace ricci;
using bench::at;

/// A factorised matrix, kept for reuse.
struct Problem {
    std::unique_ptr<SymmetricSolver> solver = make_symmetric_solver(Definiteness::positive);
    SupernodalFactor factor;
};

const Problem& problem(Index faces) {
    static std::map<Index, Problem> made;
    const auto found = made.find(faces);
    if (found != made.end()) return found->second;
    Problem& p = made[faces];
    const bench::GroundedLaplacian matrix = bench::grounded_laplacian(faces);
    p.solver->choose_ordering(matrix.pattern, Ordering::nested_dissection);
    if (!p.solver->factorize(matrix.values)) throw std::runtime_error("not positive definite");
    p.factor = p.solver->supernodal_factor();
    return p;
}

/// Unknown j of right-hand side l: a source at one unknown, and everywhere the constant that balances it.
double rhs(Index n, int l, Index j) {
    return 1e-3 * ((j == n / (l + 2) ? 1.0 : 0.0) - 1.0 / n);
}

void fill(const LaneFactor& factor, LaneArray<float>& block) {
    const auto order = factor.elimination_order();
    for (std::size_t i = 0; i < order.size(); ++i)
        for (int l = 0; l < kLanes; ++l)
            block[i].lane[l] = static_cast<float>(rhs(factor.size(), l, order[i]));
}

/// Lane 3 against the double solver.
bool solves(const Problem& p, const LaneFactor& factor, LaneArray<float>& block) {
    fill(factor, block);
    factor.solve(block);
    std::vector<double> b(block.size()), x(block.size());
    for (Index j = 0; j < factor.size(); ++j) b[at(j)] = rhs(factor.size(), 3, j);
    p.solver->solve(b, x);
    double error = 0.0, norm = 0.0;
    for (std::size_t i = 0; i < block.size(); ++i) {
        const double expected = x[at(factor.elimination_order()[i])];
        error += std::pow(block[i].lane[3] - expected, 2);
        norm += expected * expected;
    }
    return error < 1e-6 * norm;
}

template <InstructionSet set>
void lane_solve(benchmark::State& state) {
    if (set > instruction_set()) return state.SkipWithError("not on this processor");
    const Problem& p = problem(static_cast<Index>(state.range(0)));
    const LaneFactor factor(p.factor, set);
    LaneArray<float> block(at(factor.size()));
    fill(factor, block);
    const LaneArray<float> original = block;
    for (auto _ : state) {
        block = original;  // repeated solves of the same block would leave the range of float
        const double begin = bench::thread_seconds();
        factor.solve(block);
        state.SetIterationTime(bench::thread_seconds() - begin);
    }
    if (!solves(p, factor, block)) state.SkipWithError("wrong solution");
    const auto entries = static_cast<double>(factor.entries());
    state.SetItemsProcessed(state.iterations() * kLanes);
    const auto each = benchmark::Counter::kIsIterationInvariantRate;
    state.counters["us_per_rhs"] = benchmark::Counter(1e-6 * kLanes, each | benchmark::Counter::kInvert);
    state.counters["entries"] = entries;
    state.counters["MB"] = 1e-6 * static_cast<double>(factor.bytes());
    state.counters["GFLOP/s"] = benchmark::Counter(1e-9 * 4 * kLanes * entries, each);
    state.counters["GB/s"] = benchmark::Counter(2e-9 * static_cast<double>(factor.bytes()), each);
}

void double_solve(benchmark::State& state) {
    const Problem& p = problem(static_cast<Index>(state.range(0)));
    const auto n = static_cast<Index>(p.factor.permutation.size());
    std::vector<double> b(at(n)), x(at(n));
    for (Index j = 0; j < n; ++j) b[at(j)] = rhs(n, 3, j);
    for (auto _ : state) {
        p.solver->solve(b, x);
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations());
    state.counters["us_per_rhs"] =
        benchmark::Counter(1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Rounding and laying out a factor.
void construct(benchmark::State& state) {
    const Problem& p = problem(static_cast<Index>(state.range(0)));
    for (auto _ : state) {
        const LaneFactor factor(p.factor);
        benchmark::DoNotOptimize(factor.entries());
    }
}

#define RICCI_SIZES ->Arg(11000)->Arg(50000)->Arg(200000)->Unit(benchmark::kMicrosecond)
BENCHMARK(lane_solve<InstructionSet::avx512>) RICCI_SIZES->UseManualTime();
BENCHMARK(lane_solve<InstructionSet::avx2>) RICCI_SIZES->UseManualTime();
BENCHMARK(lane_solve<InstructionSet::baseline>) RICCI_SIZES->UseManualTime();
BENCHMARK(double_solve) RICCI_SIZES;
BENCHMARK(construct) RICCI_SIZES;
#undef RICCI_SIZES

}  // namespace
