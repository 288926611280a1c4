// The sweep against its honest baseline, in the same run: the same vertices solved by independent Newton
// iterations on the same triangulation with the same flips, one CHOLMOD factorisation per step under a nested
// dissection that is chosen once per mesh, nothing else shared. Both sides must reach the same accuracy and
// the same solutions.
//
// Counters: ms per solve (median of thread time) of both, their ratio, and for several threads the ratio of
// wall throughput to that of the baseline on one thread. One item is one solve.
#include <benchmark/benchmark.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "bench/clocks.h"
#include "bench/surfaces.h"
#include "engine/flow/target.h"
#include "engine/sweep/scheduler.h"
#include "engine/sweep/sweep_solver.h"
#include "kernels/parallel.h"

namespace {

using namespace ricci;
using bench::at;
using bench::Samples;

constexpr double kTolerance = 1e-10;

/// One vertex after the other, each on its own.
class IndependentNewton {
  public:
    explicit IndependentNewton(const SurfaceMesh& mesh)
        : surface_(make_flow_surface(mesh, true, true)),
          start_(rounded(surface_.triangulation)),
          cone_(2.0 * std::numbers::pi * surface_.topology.euler_characteristic) {
        FlowOptions options;
        options.geometry = Geometry::euclidean;
        target_ = make_target(surface_, options, Geometry::euclidean, Boundary::geodesic);
        newton_ = std::make_unique<NewtonSolver>(surface_, target_, Definiteness::positive, true);
        metric_ = std::make_unique<ScaledMetric<double>>(surface_, Geometry::euclidean, false);
        options_.tolerance = kTolerance;
        options_.factorize_always = true;
    }

    SolveOutcome solve(Index vertex, std::vector<double>& u) {
        u.assign(target_.curvature.size(), 0.0);
        target_.curvature[at(vertex)] = cone_;
        metric_->reset(start_);
        SolveOutcome outcome = newton_->solve(*metric_, target_, options_, u);
        target_.curvature[at(vertex)] = 0.0;
        return outcome;
    }

  private:
    FlowSurface surface_;
    IntrinsicTriangulation<double> start_;
    double cone_;
    CurvatureTarget target_;
    std::unique_ptr<NewtonSolver> newton_;
    std::unique_ptr<ScaledMetric<double>> metric_;
    SolveOptions options_;
};

/// Both have mean zero up to rounding once shifted.
double distance(std::vector<double> a, std::vector<double> b) {
    double mean = 0.0, largest = 0.0;
    for (std::size_t v = 0; v < a.size(); ++v) mean += (a[v] - b[v]) / static_cast<double>(a.size());
    for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, std::abs(a[v] - b[v] - mean));
    return largest;
}

/// Solves `vertices` on `threads` workers, made before the clock starts.
struct TimedSweep {
    double wall = 0.0, processor = 0.0;  // seconds; processor time summed over the workers
    bool converged = true;
};

TimedSweep timed_sweep(const std::shared_ptr<const SweepSurface>& surface, const std::vector<Index>& vertices,
                       int threads) {
    std::vector<std::unique_ptr<SweepWorker>> workers(static_cast<std::size_t>(threads));
    std::vector<std::uint8_t> sound(workers.size(), 1);
    std::vector<double> processor(workers.size());
    run_workers(threads, [&](int w) {
        workers[static_cast<std::size_t>(w)] = std::make_unique<SweepWorker>(surface);
    });
    const double start = bench::wall_seconds();
    run_workers(threads, [&](int w) {
        const auto mine = static_cast<std::size_t>(w);
        const double thread_start = bench::thread_seconds();
        for (std::size_t i = mine; i < vertices.size(); i += workers.size()) {
            const SweepSolve solve = workers[mine]->solve(vertices[i], {});
            if (solve.status != Status::converged || solve.residual_max > kTolerance) sound[mine] = 0;
        }
        processor[mine] = bench::thread_seconds() - thread_start;
    });
    TimedSweep result;
    result.wall = bench::wall_seconds() - start;
    for (std::size_t w = 0; w < workers.size(); ++w) {
        result.processor += processor[w];
        result.converged = result.converged && sound[w] != 0;
    }
    return result;
}

/// Vertex by vertex, baseline and sweep in turn, so that a busy machine slows both alike.
void against_newton(benchmark::State& state, const std::function<SurfaceMesh()>& make_mesh) {
    const SurfaceMesh mesh = make_mesh();
    const auto surface = std::make_shared<const SweepSurface>(mesh, SweepOptions{});
    const std::vector<Index> vertices = sample_vertices(surface->candidates(), 24, 1);
    IndependentNewton independent(mesh);
    SweepWorker worker(surface);
    Samples baseline, sweep;
    double worst_residual = 0.0, worst_distance = 0.0, steps = 0.0, baseline_steps = 0.0, flips = 0.0;
    bool converged = true;
    for (auto _ : state) {
        double inside = 0.0;
        for (const Index vertex : vertices) {
            std::vector<double> u;
            SolveOutcome outcome;
            SweepSolve solve;
            baseline.measure([&] { outcome = independent.solve(vertex, u); });
            sweep.measure([&] { solve = worker.solve(vertex, {}); });
            inside += sweep.thread.back();
            converged = converged && outcome.status == Status::converged && solve.status == Status::converged;
            worst_residual = std::max({worst_residual, outcome.residual_max, solve.residual_max});
            worst_distance = std::max(worst_distance, distance(u, solve.conformal_factor));
            baseline_steps += outcome.iterations;
            steps += solve.newton_iterations;
            flips += static_cast<double>(solve.flips);
        }
        state.SetIterationTime(inside);
    }
    // Residuals below 1e-10 leave the conformal factors uncertain by that times the norm of the inverse
    // Hessian.
    if (!converged || worst_residual > kTolerance) state.SkipWithError("a solve did not converge");
    if (worst_distance > 1e-6) state.SkipWithError("sweep and baseline differ");
    const auto solves = static_cast<double>(sweep.thread.size());
    state.SetItemsProcessed(static_cast<std::int64_t>(solves));
    state.counters["vertices"] = mesh.connectivity.vertex_count;
    state.counters["baseline_ms"] = 1e3 * bench::median(baseline.thread);
    state.counters["sweep_ms"] = 1e3 * bench::median(sweep.thread);
    state.counters["ratio"] = bench::median(baseline.thread) / bench::median(sweep.thread);
    state.counters["baseline_steps"] = baseline_steps / solves;
    state.counters["steps"] = steps / solves;
    state.counters["flips"] = flips / solves;
    state.counters["worst_residual"] = worst_residual;
    state.counters["worst_distance"] = worst_distance;
}

/// Wall throughput on several threads over the baseline's on one, measured just before. Processor time per
/// solve tells contention inside the program (it grows with threads) from a busy machine (it does not).
void threaded(benchmark::State& state, const std::function<SurfaceMesh()>& make_mesh, int threads) {
    const SurfaceMesh mesh = make_mesh();
    const auto surface = std::make_shared<const SweepSurface>(mesh, SweepOptions{});
    const std::vector<Index> vertices = sample_vertices(surface->candidates(), 48, 1);
    IndependentNewton independent(mesh);
    std::vector<double> ratios, processor;
    bool converged = true;
    for (auto _ : state) {
        const double start = bench::wall_seconds();
        std::vector<double> u;
        for (std::size_t i = 0; i < 12; ++i)
            converged = converged && independent.solve(vertices[4 * i], u).status == Status::converged;
        const double baseline = (bench::wall_seconds() - start) / 12.0;
        const TimedSweep sweep = timed_sweep(surface, vertices, threads);
        const auto solves = static_cast<double>(vertices.size());
        converged = converged && sweep.converged;
        state.SetIterationTime(sweep.wall);
        ratios.push_back(baseline * solves / sweep.wall);
        processor.push_back(1e3 * sweep.processor / solves);
    }
    if (!converged) state.SkipWithError("a solve did not converge");
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(vertices.size()));
    state.counters["processor_ms"] = bench::median(processor);
    state.counters["throughput_ratio"] = bench::median(ratios);
}

void add(const std::string& name, const std::function<SurfaceMesh()>& make_mesh, bool with_threads) {
    benchmark::RegisterBenchmark(("sweep/" + name).c_str(), against_newton, make_mesh)
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
    if (!with_threads) return;
    for (int threads = 1; threads <= hardware_threads(); threads *= 2)
        benchmark::RegisterBenchmark(
            ("sweep_threads/" + name + "/threads:" + std::to_string(threads)).c_str(), threaded, make_mesh,
            threads)
            ->UseManualTime()
            ->Iterations(3)
            ->Unit(benchmark::kMillisecond);
}

const bool kRegistered = [] {
    for (const Index faces : {2000, 10000, 24000, 100000})
        add(
            "generated_eight/faces:" + std::to_string(faces),
            [faces] { return bench::generated("eight", faces); }, faces == 10000);
    for (const auto& [name, file] :
         {std::pair{"eight", "closed_g2/eight.off"},
          {"cup", "closed_g2/cup.off"},
          {"fertility_4k", "families/fertility_resolutions/fertility_4494v.off"}}) {
        const auto path = bench::sample_path(std::string("meshes/") + file);
        if (path)
            add(
                name, [path = *path] { return bench::load_single(path); }, false);
    }
    return true;
}();

}  // namespace
