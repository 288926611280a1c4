// The structure of a surface, part by part, beside one Newton step of its metric.
//
// The layout of one fundamental domain is to cost less than one Newton step: the counter newton_steps says
// how many it costs, both measured in this run.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "bench/surfaces.h"
#include "engine/structure/surface_structure.h"

namespace {

using namespace ricci;

/// A generated surface of genus two with everything made once.
struct Prepared {
    SurfaceMesh mesh;
    SurfaceStructure structure;
    double newton_step = 0;  // seconds, the mean over the flow's steps, factorised or not
};

double newton_step_of(const FlowResult& flow) {
    const std::vector<IterationLog>& log = flow.outcome.log;
    if (log.size() < 2) throw std::runtime_error("the flow took no step");
    return (log.back().seconds - log.front().seconds) / static_cast<double>(log.size() - 1);
}

const Prepared& prepared(Index faces) {
    static std::map<Index, std::unique_ptr<Prepared>> made;
    auto& p = made[faces];
    if (p) return *p;
    p = std::make_unique<Prepared>();
    p->mesh = bench::generated("eight", faces);
    StructureOptions options;
    options.flow.parallel = false;
    p->structure = make_surface_structure(p->mesh, options);
    if (p->structure.flow.outcome.status != Status::converged || p->structure.group.relator_error > 1e-8 ||
        p->structure.layout.flipped != 0)
        throw std::runtime_error("the structure is not what it should be");
    p->newton_step = newton_step_of(p->structure.flow);
    return *p;
}

void report(benchmark::State& state, const Prepared& p) {
    state.SetItemsProcessed(state.iterations() * p.mesh.connectivity.face_count());
    state.counters["faces"] = static_cast<double>(p.mesh.connectivity.face_count());
    state.counters["newton_steps"] =
        benchmark::Counter(p.newton_step * static_cast<double>(state.iterations()),
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void layout(benchmark::State& state) {
    const Prepared& p = prepared(static_cast<Index>(state.range(0)));
    LayoutOptions options;
    options.max_digits = 16;
    for (auto _ : state) {
        const SurfaceLayout made =
            make_surface_layout(p.structure.kappa, *p.structure.refinement, p.mesh.connectivity,
                                *p.structure.basis, p.structure.cut, options);
        if (!(made.closing_error < 1e-4)) state.SkipWithError("the layout does not close");
        benchmark::DoNotOptimize(made.radius);
    }
    report(state, p);
}

void refinement(benchmark::State& state) {
    const Prepared& p = prepared(static_cast<Index>(state.range(0)));
    for (auto _ : state) {
        const CommonRefinement made =
            make_common_refinement(p.mesh, p.structure.flow.conformal_factor, p.structure.flow.doubled, true);
        benchmark::DoNotOptimize(made.vertex.data());
    }
    report(state, p);
}

void topology(benchmark::State& state) {
    const Prepared& p = prepared(static_cast<Index>(state.range(0)));
    const std::vector<double> length =
        final_edge_lengths(p.mesh, p.structure.flow.conformal_factor, p.structure.kappa);
    for (auto _ : state) {
        const HomotopyBasis basis = make_homotopy_basis(p.mesh.connectivity, length);
        const CutGraph cut = make_cut_graph(p.mesh.connectivity, basis);
        benchmark::DoNotOptimize(cut.sides.data());
    }
    report(state, p);
}

void group(benchmark::State& state) {
    const Prepared& p = prepared(static_cast<Index>(state.range(0)));
    GroupOptions options;
    options.goal = 0;  // as many digits as allowed
    options.max_digits = static_cast<int>(state.range(1));
    for (auto _ : state) {
        const SurfaceGroup made =
            make_surface_group(p.structure.kappa, *p.structure.refinement, p.mesh.connectivity,
                               *p.structure.basis, p.structure.canonical, options);
        if (made.relator_error > 1e-4) state.SkipWithError("the relator misses the identity");
        benchmark::DoNotOptimize(made.relator_error);
    }
    report(state, p);
}

BENCHMARK(layout)->RangeMultiplier(4)->Range(5000, 80000)->Unit(benchmark::kMillisecond);
BENCHMARK(refinement)->RangeMultiplier(4)->Range(5000, 80000)->Unit(benchmark::kMillisecond);
BENCHMARK(topology)->RangeMultiplier(4)->Range(5000, 80000)->Unit(benchmark::kMillisecond);
BENCHMARK(group)->Args({20000, 16})->Args({20000, 19})->Args({20000, 50})->Unit(benchmark::kMillisecond);

}  // namespace
