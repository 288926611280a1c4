// The Delaunay test over all edges, flipping to Delaunay, and single flips. One item is one face (tests) or
// one flip.
#include <benchmark/benchmark.h>

#include <cmath>

#include "bench/clocks.h"
#include "bench/surfaces.h"
#include "kernels/delaunay.h"

namespace {

using namespace ricci;
using bench::at;

/// A bump that makes a share of the edges of a Delaunay triangulation fail.
std::vector<double> bump(Index vertices) {
    std::vector<double> u(at(vertices));
    for (Index v = 0; v < vertices; ++v) u[at(v)] = 0.4 * std::sin(0.05 * v);
    return u;
}

template <class Real>
IntrinsicTriangulation<Real> delaunay_surface(Index faces) {
    auto t = intrinsic_triangulation<Real>(bench::generated("eight", faces));
    DelaunayWorkspace workspace;
    make_delaunay<Real>(t, {}, FlipRule::isometric, workspace);
    return t;
}

/// The pass that every Newton step makes: all edges tested, none to flip.
template <class Real>
void test_pass(benchmark::State& state) {
    auto t = delaunay_surface<Real>(static_cast<Index>(state.range(0)));
    const std::vector<double> u(at(t.connectivity.vertex_count), 0.0);
    DelaunayWorkspace workspace;
    FlipCount count;
    for (auto _ : state) {
        count = make_delaunay<Real>(t, u, FlipRule::ptolemy, workspace);
        benchmark::ClobberMemory();
    }
    if (count.flips != 0 || count_non_delaunay<Real>(t, u) != 0) state.SkipWithError("not Delaunay at rest");
    state.SetItemsProcessed(state.iterations() * t.connectivity.face_count());
}

/// Baseline: the same test edge by edge, with scalar exponentials.
void scalar_test_pass(benchmark::State& state) {
    const auto t = delaunay_surface<double>(static_cast<Index>(state.range(0)));
    const Connectivity& c = t.connectivity;
    const std::vector<double> u(at(c.vertex_count), 0.0);
    const auto chord = [&](Index h) {
        return std::exp(t.log_chord[at(h)] + 0.5 * (u[at(c.tail[at(h)])] + u[at(c.head(h))]));
    };
    const auto cosine = [&](Index h) {
        const double a = chord(next_halfedge(h)), b = chord(prev_halfedge(h)), l = chord(h);
        return (a * a + b * b - l * l) / (a * b);
    };
    std::int64_t failing = 0;
    for (auto _ : state) {
        failing = 0;
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            const Index twin = c.twin[at(h)];
            if (twin > h) failing += cosine(h) + cosine(twin) < -1e-9 ? 1 : 0;
        }
        benchmark::DoNotOptimize(failing);
    }
    if (failing != 0) state.SkipWithError("not Delaunay at rest");
    state.SetItemsProcessed(state.iterations() * c.face_count());
}

/// From a start to Delaunay: isometric from the jittered input, Ptolemy after a change of u.
template <FlipRule rule>
void flip_to_delaunay(benchmark::State& state) {
    const auto faces = static_cast<Index>(state.range(0));
    const auto start = rule == FlipRule::ptolemy
                           ? delaunay_surface<double>(faces)
                           : intrinsic_triangulation<double>(bench::generated("eight", faces));
    const std::vector<double> u =
        rule == FlipRule::ptolemy ? bump(start.connectivity.vertex_count) : std::vector<double>();
    IntrinsicTriangulation<double> t;
    DelaunayWorkspace workspace;
    FlipCount count;
    for (auto _ : state) {
        t = start;
        const double begin = bench::thread_seconds();
        count = make_delaunay<double>(t, u, rule, workspace);
        state.SetIterationTime(bench::thread_seconds() - begin);
    }
    if (!count.finished || count.flips == 0 || count_non_delaunay<double>(t, u) != 0 ||
        *check_connectivity(t.connectivity) != '\0')
        state.SkipWithError("did not become Delaunay");
    state.SetItemsProcessed(state.iterations() * start.connectivity.face_count());
    state.counters["flips"] = static_cast<double>(count.flips);
    state.counters["flips_per_second"] = benchmark::Counter(
        static_cast<double>(count.flips * state.iterations()), benchmark::Counter::kIsRate);
}

/// Every edge flipped and flipped back: lengths must return.
template <FlipRule rule>
void flip_and_back(benchmark::State& state) {
    auto t =
        intrinsic_triangulation<double>(bench::generated("sphere", static_cast<Index>(state.range(0)), 0.0));
    Connectivity& c = t.connectivity;
    std::vector<double> before(at(c.edge_count));
    for (std::size_t h = 0; h < c.edge.size(); ++h) before[at(c.edge[h])] = t.log_chord[h];
    const auto flip = [&](Index h) {
        const double length = rule == FlipRule::ptolemy ? ptolemy_log<double>(t.log_chord, c, h)
                                                        : unfolded_log<double>(t.log_chord, c, h);
        flip_edge<double>(c, t.log_chord, h, length);
    };
    std::int64_t flips = 0, passes = 0;
    for (auto _ : state) {
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            if (c.twin[at(h)] < h || !flippable(c, h)) continue;
            flip(h);
            flip(next_halfedge(h));  // where the new edge is
            flips += 2;
        }
        ++passes;
    }
    // Each pair of flips rounds a few times; errors add up over the passes.
    const double tolerance = 1e-14 * static_cast<double>(passes + 10);
    for (std::size_t h = 0; h < c.edge.size(); ++h)
        if (!(std::abs(before[at(c.edge[h])] - t.log_chord[h]) <= tolerance * 100))
            state.SkipWithError("an edge changed its length");
    state.SetItemsProcessed(flips);
}

BENCHMARK(test_pass<double>)->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(scalar_test_pass)->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(test_pass<long double>)->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(flip_to_delaunay<FlipRule::isometric>)->Arg(1000)->Arg(10000)->Arg(100000)->UseManualTime();
BENCHMARK(flip_to_delaunay<FlipRule::ptolemy>)->Arg(1000)->Arg(10000)->Arg(100000)->UseManualTime();
BENCHMARK(flip_and_back<FlipRule::isometric>)->Arg(1000)->Arg(100000);
BENCHMARK(flip_and_back<FlipRule::ptolemy>)->Arg(1000)->Arg(100000);

}  // namespace
