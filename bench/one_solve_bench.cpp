// One solve with one cone, against its floor: Newton steps times one numeric factorisation of CHOLMOD.
//
// Everything is measured in turn, on one thread, in the same run: (a) solve_flow as a user calls it, (b) the
// Newton loop alone, the matrix analysed before, (c) one numeric factorisation of the same Hessian under the
// same ordering. Counters are medians in milliseconds of thread time unless named otherwise; flow_ratio = a /
// (steps c) and newton_ratio = b / (steps c) are the figures to keep low.
#include <benchmark/benchmark.h>
#include <dlfcn.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "bench/clocks.h"
#include "bench/independent_newton.h"
#include "bench/surfaces.h"
#include "engine/flow/flow.h"
#include "engine/flow/newton.h"
#include "engine/flow/target.h"
#include "engine/remesh/resample.h"

namespace {

using namespace ricci;
using bench::at;
using bench::Samples;

constexpr int kRepetitions = 7;

bool with_openmp_teams = false;  // one thread only

FlowOptions one_cone(const SurfaceMesh& mesh) {
    FlowOptions options;
    options.geometry = Geometry::euclidean;
    const Topology topology = topology_of(mesh.connectivity);
    options.cones.push_back(
        {mesh.connectivity.vertex_count / 2, 2.0 * std::numbers::pi * topology.euler_characteristic});
    options.parallel = false;
    return options;
}

/// Forwards to a metric and counts the time spent in it; what it copies out is not counted.
class TimedMetric final : public Metric {
  public:
    explicit TimedMetric(const FlowSurface& surface)
        : Metric(surface, Geometry::euclidean, false), inner_(surface, Geometry::euclidean, false) {}

    bool move_to(ConformalFactor u) override {
        bool done = false;
        moves.measure([&] { done = inner_.move_to(u); });
        copy_flips();
        return done;
    }
    void save() override {
        saves.measure([&] { inner_.save(); });
        saved_touched_ = touched_faces_.size();
    }
    void restore() override {
        saves.measure([&] { inner_.restore(); });
        flips_ = inner_.flips();
        touched_faces_.resize(saved_touched_);
    }
    bool evaluate(bool derivatives) override {
        bool sound = false;
        evaluations.measure([&] { sound = inner_.evaluate(derivatives); });
        curvature_.assign(inner_.curvature().begin(), inner_.curvature().end());
        off_.assign(inner_.off().begin(), inner_.off().end());
        diagonal_.assign(inner_.diagonal().begin(), inner_.diagonal().end());
        area_ = inner_.area();
        return sound;
    }
    [[nodiscard]] const Connectivity& connectivity() const override { return inner_.connectivity(); }
    [[nodiscard]] std::vector<double> edge_lengths() const override { return inner_.edge_lengths(); }

    Samples moves, saves, evaluations;

  private:
    void copy_flips() {
        flips_ = inner_.flips();
        const std::vector<Index> touched = inner_.take_touched_faces();
        touched_faces_.insert(touched_faces_.end(), touched.begin(), touched.end());
    }

    ScaledMetric<double> inner_;
    std::size_t saved_touched_ = 0;
};

double total(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum;
}

/// The prepared problem: what solve_flow makes of the options.
struct Problem {
    FlowSurface surface;
    CurvatureTarget target;
    SolveOptions options;
};

Problem make_problem(const SurfaceMesh& mesh, const FlowOptions& options) {
    Problem problem;
    problem.surface = make_flow_surface(mesh, true, true);
    problem.target = make_target(problem.surface, options, Geometry::euclidean, Boundary::geodesic);
    problem.options.tolerance = options.tolerance;
    return problem;
}

/// Single pieces of a Newton step at the start of the solve, each measured several times.
struct Pieces {
    Samples surface, ordering, analysis, assembly, first_factor, factor, plain_factor, back_solve;
    std::int64_t factor_bytes = 0;
    bool sound = false;
};

Pieces measure_pieces(const SurfaceMesh& mesh, const Problem& problem) {
    Pieces pieces;
    for (int repetition = 0; repetition < kRepetitions; ++repetition)
        pieces.surface.measure([&] { benchmark::DoNotOptimize(make_flow_surface(mesh, true, true)); });
    ScaledMetric<double> metric(problem.surface, Geometry::euclidean, false);
    metric.move_to(std::vector<double>(problem.target.curvature.size(), 0.0));
    metric.evaluate(true);
    std::vector<Index> unknown(problem.surface.orbit.size());
    for (std::size_t s = 0; s < unknown.size(); ++s)
        unknown[s] = problem.target.unknown[at(problem.surface.orbit[s])];
    HessianAssembler assembler;
    assembler.build(metric.connectivity(), unknown, problem.target.unknown_count);
    const std::unique_ptr<SymmetricSolver> solver = make_symmetric_solver(Definiteness::positive);
    std::vector<double> values, rhs(at(problem.target.unknown_count)), solution(rhs.size());
    for (std::size_t i = 1; i < rhs.size(); ++i) rhs[i] = std::sin(static_cast<double>(i));
    pieces.sound = true;
    for (int repetition = 0; repetition < kRepetitions; ++repetition) {
        pieces.ordering.measure(
            [&] { solver->choose_ordering(assembler.pattern(), Ordering::minimum_degree); });
        pieces.analysis.measure([&] { solver->analyze(assembler.pattern()); });
        pieces.assembly.measure(
            [&] { assembler.assemble(metric.connectivity(), metric.off(), metric.diagonal(), 0, values); });
        bool definite = false;
        pieces.first_factor.measure([&] { definite = solver->factorize(values); });  // allocates the factor
        pieces.factor.measure([&] { definite = solver->factorize(values); });
        with_openmp_teams = true;
        pieces.plain_factor.measure([&] { definite = solver->factorize(values) && definite; });
        with_openmp_teams = false;
        pieces.back_solve.measure([&] { solver->solve(rhs, solution); });
        pieces.sound = pieces.sound && definite;
    }
    pieces.factor_bytes = solver->factor_bytes();
    return pieces;
}

double milliseconds(const std::vector<double>& seconds) {
    return 1e3 * bench::median(seconds);
}

/// Where the Newton loop spends its time: the metric's share is measured in place, the matrix's is the
/// pieces' cost times how often they occur, the rest is what remains.
void report_shares(benchmark::State& state, const Problem& problem, const Pieces& pieces, double newton_ms) {
    NewtonSolver solver(problem.surface, problem.target, Definiteness::positive, false);
    TimedMetric metric(problem.surface);
    std::vector<double> u(problem.target.curvature.size(), 0.0);
    const SolveOutcome outcome = solver.solve(metric, problem.target, problem.options, u);
    const double factorizations = outcome.factorizations + outcome.shifted_factorizations;
    const double back_solves = outcome.factorizations + outcome.conjugate_gradient_iterations;
    const double move = 1e3 * total(metric.moves.thread), save = 1e3 * total(metric.saves.thread),
                 evaluate = 1e3 * total(metric.evaluations.thread);
    const double factor = factorizations * milliseconds(pieces.factor.thread),
                 // Every analysis leaves a factor without memory.
        allocation = outcome.symbolic_analyses *
                     (milliseconds(pieces.first_factor.thread) - milliseconds(pieces.factor.thread)),
                 assembly = outcome.iterations * milliseconds(pieces.assembly.thread),
                 back_solve = back_solves * milliseconds(pieces.back_solve.thread),
                 analyses = outcome.symbolic_analyses * milliseconds(pieces.analysis.thread);
    state.counters["share_move_to"] = move;
    state.counters["share_save"] = save;
    state.counters["share_evaluate"] = evaluate;
    state.counters["share_factor"] = factor;
    state.counters["share_allocate_factor"] = allocation;
    state.counters["share_assemble"] = assembly;
    state.counters["share_back_solve"] = back_solve;
    state.counters["share_analyse"] = analyses;
    state.counters["share_rest"] =
        newton_ms - move - save - evaluate - factor - allocation - assembly - back_solve - analyses;
    state.counters["factorizations"] = outcome.factorizations;
    state.counters["conjugate_gradient_iterations"] = outcome.conjugate_gradient_iterations;
    state.counters["analyses"] = outcome.symbolic_analyses;
    state.counters["shifted"] = outcome.shifted_factorizations;
    state.counters["flips"] = static_cast<double>(outcome.flips);
}

void one_solve(benchmark::State& state, const std::function<SurfaceMesh()>& make_mesh) {
    const SurfaceMesh mesh = make_mesh();
    const FlowOptions options = one_cone(mesh);
    const Problem problem = make_problem(mesh, options);
    const Pieces pieces = measure_pieces(mesh, problem);
    Samples flow, newton, preparation, baseline;
    FlowResult result;
    SolveOutcome outcome;
    bool baseline_converged = true;
    for (auto _ : state) {
        flow.measure([&] { result = solve_flow(mesh, options); });
        state.SetIterationTime(flow.thread.back());
        std::unique_ptr<NewtonSolver> solver;
        std::unique_ptr<ScaledMetric<double>> metric;
        preparation.measure([&] {
            solver = std::make_unique<NewtonSolver>(problem.surface, problem.target, Definiteness::positive,
                                                    false);
            metric = std::make_unique<ScaledMetric<double>>(problem.surface, Geometry::euclidean, false);
        });
        std::vector<double> u(problem.target.curvature.size(), 0.0);
        newton.measure([&] { outcome = solver->solve(*metric, problem.target, problem.options, u); });
        SolveOutcome independent;
        baseline.measure([&] {
            bench::IndependentNewton alone(mesh, options.tolerance);
            independent = alone.solve(options.cones.front().vertex, u);
        });
        baseline_converged = baseline_converged && independent.status == Status::converged;
    }
    if (!pieces.sound || result.outcome.status != Status::converged || outcome.status != Status::converged ||
        result.outcome.residual_max > options.tolerance || !baseline_converged) {
        state.SkipWithError("the solve did not converge");
        return;
    }
    const double floor_ms = outcome.iterations * milliseconds(pieces.factor.thread);
    const double floor_wall_ms = outcome.iterations * milliseconds(pieces.factor.wall);
    state.counters["vertices"] = mesh.connectivity.vertex_count;
    state.counters["steps"] = outcome.iterations;
    state.counters["flow_ms"] = milliseconds(flow.thread);
    state.counters["baseline_ms"] = milliseconds(baseline.thread);
    state.counters["baseline_ratio"] = milliseconds(baseline.thread) / milliseconds(flow.thread);
    state.counters["newton_ms"] = milliseconds(newton.thread);
    state.counters["prepare_ms"] = milliseconds(preparation.thread);
    state.counters["factor_ms"] = milliseconds(pieces.factor.thread);
    state.counters["assemble_ms"] = milliseconds(pieces.assembly.thread);
    state.counters["first_factor_ms"] = milliseconds(pieces.first_factor.thread);
    state.counters["surface_ms"] = milliseconds(pieces.surface.thread);
    state.counters["order_ms"] = milliseconds(pieces.ordering.thread);
    state.counters["analyse_ms"] = milliseconds(pieces.analysis.thread);
    state.counters["back_solve_ms"] = milliseconds(pieces.back_solve.thread);
    state.counters["factor_MB"] = 1e-6 * static_cast<double>(pieces.factor_bytes);
    state.counters["flow_ratio"] = milliseconds(flow.thread) / floor_ms;
    state.counters["newton_ratio"] = milliseconds(newton.thread) / floor_ms;
    state.counters["flow_wall_ratio"] = milliseconds(flow.wall) / floor_wall_ms;
    state.counters["newton_wall_ratio"] = milliseconds(newton.wall) / floor_wall_ms;
    const double plain_ms = outcome.iterations * milliseconds(pieces.plain_factor.thread);
    state.counters["plain_factor_ms"] = milliseconds(pieces.plain_factor.thread);
    state.counters["flow_plain_ratio"] = milliseconds(flow.thread) / plain_ms;
    state.counters["newton_plain_ratio"] = milliseconds(newton.thread) / plain_ms;
    report_shares(state, problem, pieces, milliseconds(newton.thread));
    state.SetItemsProcessed(state.iterations());
}

void add(const std::string& name, const std::function<SurfaceMesh()>& make_mesh) {
    benchmark::RegisterBenchmark(("one_solve/" + name).c_str(), one_solve, make_mesh)
        ->UseManualTime()
        ->Iterations(kRepetitions)
        ->Unit(benchmark::kMillisecond);
}

const bool kRegistered = [] {
    add("generated_eight_24k", [] { return bench::generated("eight", 24000); });
    add("generated_eight_200k", [] { return bench::generated("eight", 200000); });
    const auto sample = [](const std::string& name, const std::string& relative, bool loop) {
        const auto path = bench::sample_path("meshes/" + relative);
        if (!path) return;
        add(name, [path = *path, loop] {
            const SurfaceMesh mesh = bench::load_single(path);
            return loop ? subdivide_loop(mesh) : mesh;
        });
    };
    sample("cup", "closed_g2/cup.off", false);
    sample("fertility_14k", "families/fertility_resolutions/fertility_13971v.obj", false);
    sample("eight_loop_22k", "closed_g2/eight.off", true);
    return true;
}();

}  // namespace

/// The program's own definition (engine/app/serial_openmp.cpp), or libgomp's where asked.
extern "C" void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned flags) {
    using Parallel = void (*)(void (*)(void*), void*, unsigned, unsigned);
    static const auto plain = reinterpret_cast<Parallel>(dlsym(RTLD_NEXT, "GOMP_parallel"));
    if (with_openmp_teams && plain != nullptr) {
        plain(body, data, threads, flags);
    } else {
        body(data);
    }
}
