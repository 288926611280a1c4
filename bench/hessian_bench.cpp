// The sparse matrix of a Newton step: built from scratch, filled with values, and following flips. One item
// is one face.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numeric>

#include "bench/clocks.h"
#include "bench/surfaces.h"
#include "engine/flow/hessian.h"
#include "kernels/delaunay.h"
#include "kernels/face_kernels.h"

namespace {

using namespace ricci;
using bench::at;

struct Input {
    IntrinsicTriangulation<double> triangulation;
    std::vector<Index> unknown;
    std::vector<double> angle, off, diagonal;

    void evaluate() {
        const std::size_t halfedges = triangulation.log_chord.size();
        angle.resize(halfedges);
        off.resize(halfedges);
        diagonal.resize(halfedges);
        const std::vector<double> u(unknown.size(), 0.0);
        const ScaledChords<double> chords{triangulation.connectivity.tail, triangulation.log_chord, u};
        evaluate_faces<double>(Geometry::euclidean, chords, {angle, off, diagonal, {}}, false);
    }
    [[nodiscard]] Index unknowns() const { return static_cast<Index>(unknown.size()); }
};

Input make_input(Index faces) {
    Input input;
    input.triangulation = intrinsic_triangulation<double>(bench::generated("eight", faces));
    input.unknown.resize(at(input.triangulation.connectivity.vertex_count));
    std::iota(input.unknown.begin(), input.unknown.end(), Index{0});
    input.evaluate();
    return input;
}

/// The matrix times x, from its lower triangle.
std::vector<double> product(const SymmetricPattern& pattern, const std::vector<double>& values,
                            const std::vector<double>& x) {
    std::vector<double> y(x.size(), 0.0);
    for (Index j = 0; j < pattern.size(); ++j)
        for (Index p = pattern.column_begin[at(j)]; p < pattern.column_begin[at(j) + 1]; ++p) {
            const Index i = pattern.row[at(p)];
            y[at(i)] += values[at(p)] * x[at(j)];
            if (i != j) y[at(j)] += values[at(p)] * x[at(i)];
        }
    return y;
}

/// The Euclidean Hessian annihilates constants; a non-constant vector must not vanish.
bool annihilates_constants(const SymmetricPattern& pattern, const std::vector<double>& values) {
    const auto n = static_cast<std::size_t>(pattern.size());
    for (const double y : product(pattern, values, std::vector<double>(n, 1.0)))
        if (!(std::abs(y) < 1e-9)) return false;
    std::vector<double> hat(n, 0.0);
    hat[0] = 1.0;
    return product(pattern, values, hat)[0] > 0.1;
}

void build(benchmark::State& state) {
    const Input input = make_input(static_cast<Index>(state.range(0)));
    const Connectivity& c = input.triangulation.connectivity;
    HessianAssembler assembler;
    for (auto _ : state) {
        assembler.build(c, input.unknown, input.unknowns());
        benchmark::ClobberMemory();
    }
    if (assembler.pattern().size() != input.unknowns()) state.SkipWithError("wrong size");
    state.SetItemsProcessed(state.iterations() * c.face_count());
}

void assemble(benchmark::State& state) {
    const Input input = make_input(static_cast<Index>(state.range(0)));
    const Connectivity& c = input.triangulation.connectivity;
    HessianAssembler assembler;
    assembler.build(c, input.unknown, input.unknowns());
    std::vector<double> values;
    for (auto _ : state) {
        assembler.assemble(c, input.off, input.diagonal, -1, values);
        benchmark::ClobberMemory();
    }
    if (!annihilates_constants(assembler.pattern(), values)) state.SkipWithError("wrong matrix");
    state.SetItemsProcessed(state.iterations() * c.face_count());
    // Reads two fields and an index per corner, writes one value per nonzero.
    state.SetBytesProcessed(state.iterations() *
                            static_cast<std::int64_t>(20 * input.off.size() + 8 * values.size()));
}

/// Baseline of follow_flips is `build`. About `flips` edges are flipped; the matrix must equal one built
/// anew.
void follow(benchmark::State& state) {
    Input input = make_input(static_cast<Index>(state.range(0)));
    Connectivity& c = input.triangulation.connectivity;
    HessianAssembler before;
    before.build(c, input.unknown, input.unknowns());
    std::vector<Index> touched;
    const auto wanted = static_cast<std::size_t>(2 * state.range(1));
    for (Index h = 0; h < c.halfedge_count() && touched.size() < wanted; h += 30) {
        if (!flippable(c, h)) continue;
        touched.push_back(face_of(h));
        touched.push_back(face_of(c.twin[at(h)]));
        const double length = ptolemy_log<double>(input.triangulation.log_chord, c, h);
        flip_edge<double>(c, input.triangulation.log_chord, h, length);
    }
    HessianAssembler assembler;
    bool changed = false;
    for (auto _ : state) {
        assembler = before;
        const double begin = bench::thread_seconds();
        changed = assembler.follow_flips(c, touched);
        state.SetIterationTime(bench::thread_seconds() - begin);
    }
    HessianAssembler fresh;
    fresh.build(c, input.unknown, input.unknowns());
    // Any values do: the two matrices must agree as operators.
    std::vector<double> off(c.tail.size()), diagonal(c.tail.size()), values, expected, x;
    for (std::size_t h = 0; h < off.size(); ++h) {
        off[h] = 1.0 + c.edge[h] % 7;
        diagonal[h] = -10.0;
    }
    for (Index v = 0; v < input.unknowns(); ++v) x.push_back(std::sin(v));
    assembler.assemble(c, off, diagonal, -1, values);
    fresh.assemble(c, off, diagonal, -1, expected);
    const std::vector<double> y = product(assembler.pattern(), values, x),
                              z = product(fresh.pattern(), expected, x);
    for (std::size_t v = 0; v < y.size(); ++v)
        if (!(std::abs(y[v] - z[v]) < 1e-9)) state.SkipWithError("the matrix did not follow the flips");
    state.SetItemsProcessed(state.iterations() * c.face_count());
    state.counters["flips"] = 0.5 * static_cast<double>(touched.size());
    state.counters["pattern_changed"] = changed ? 1.0 : 0.0;
}

BENCHMARK(build)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK(assemble)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK(follow)
    ->ArgNames({"faces", "flips"})
    ->Args({10000, 1})
    ->Args({10000, 20})
    ->Args({100000, 1})
    ->Args({100000, 200})
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
