#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/sweep_arguments.h"
#include "engine/app/sweep_job.h"
#include "engine/app/sweep_run.h"

namespace ricci::app {
namespace {

nlohmann::json to_json(const ItemSummary& s) {
    const auto vertex = [](const std::optional<SweepRow>& row) {
        return row ? nlohmann::json(row->vertex) : nlohmann::json();
    };
    const auto distortion = [](const std::optional<SweepRow>& row) {
        return row ? finite_or_null(row->area_distortion) : nlohmann::json();
    };
    const double rate = s.seconds > 0.0 ? static_cast<double>(s.solved + s.failed) / s.seconds : 0.0;
    return {{"item", s.name},
            {"vertices", s.vertices},
            {"solved", s.solved},
            {"failed", s.failed},
            {"best_vertex", vertex(s.best)},
            {"best_area_distortion", distortion(s.best)},
            {"worst_vertex", vertex(s.worst)},
            {"worst_area_distortion", distortion(s.worst)},
            {"seconds", s.seconds},
            {"solves_per_second", rate},
            {"status", name_of(s.status)},
            {"message", s.message}};
}

void print_table(const std::vector<ItemSummary>& summaries) {
    std::size_t width = 4;
    for (const ItemSummary& s : summaries) width = std::max(width, s.name.size());
    fmt::print("{:<{}}  {:>8}  {:>7}  {:>6}  {:>8}  {:>10}  {:>8}  {:>10}  {:>9}  {:>8}\n", "item", width,
               "vertices", "solved", "failed", "best", "distortion", "worst", "distortion", "seconds",
               "solves/s");
    for (const ItemSummary& s : summaries) {
        if (s.status != Status::converged) {
            fmt::print("{:<{}}  {}: {}\n", s.name, width, name_of(s.status), s.message);
            continue;
        }
        const auto vertex = [](const auto& row) {
            return row ? fmt::format("{}", row->vertex) : std::string("-");
        };
        const auto value = [](const auto& row) {
            return row ? fmt::format("{:.6g}", row->area_distortion) : std::string("-");
        };
        const double rate = s.seconds > 0.0 ? static_cast<double>(s.solved + s.failed) / s.seconds : 0.0;
        fmt::print("{:<{}}  {:>8}  {:>7}  {:>6}  {:>8}  {:>10}  {:>8}  {:>10}  {:>9.2f}  {:>8.1f}\n", s.name,
                   width, s.vertices, s.solved, s.failed, vertex(s.best), value(s.best), vertex(s.worst),
                   value(s.worst), s.seconds, rate);
    }
}

/// Seconds of a worker per solve, from as many solves as it has under way at a time.
double probe_seconds(const SweepTask& task) {
    SweepWorker worker(task.surface);
    const std::size_t count = task.vertices.size(),
                      probes = std::min(count, static_cast<std::size_t>(std::max(task.surface->lanes(), 1)));
    std::size_t given = 0;
    double seconds = 0.0;
    const auto next = [&]() -> std::optional<Index> {
        if (given == probes) return std::nullopt;
        return task.vertices[(2 * given++ + 1) * count / (2 * probes)];
    };
    worker.run({next, [&](const SweepSolve& solve) { seconds += solve.seconds; }, {}});
    return seconds / static_cast<double>(std::max<std::size_t>(probes, 1));
}

/// What would run: a few solves per item are timed, its memory predicted.
int dry_run(const SweepConfig& config, const std::vector<std::string>& files, const SweepPlan& plan,
            const CommonOptions& common) {
    ProgressLine progress(true);
    StoreRecords records(nullptr, false, progress);
    SweepRun run(config, sweep_sources(files), plan, records, progress);
    const int threads = common.resolved_threads();
    double total = 0.0;
    for (std::size_t f = 0; f < plan.files().size(); ++f) {
        for (const SweepTask& task : run.open(f)) {
            const SweepSurface& surface = *task.surface;
            const double each = probe_seconds(task);
            const double seconds = each * static_cast<double>(task.vertices.size()) / threads;
            const double megabytes =
                static_cast<double>(surface.shared_bytes() + threads * surface.worker_bytes()) / 1e6;
            const std::string name = run.stage_of(task.item).item;
            total += seconds;
            if (common.json) {
                print_json({{"item", name},
                            {"vertices", task.vertices.size()},
                            {"seconds_per_solve", each},
                            {"estimated_seconds", seconds},
                            {"estimated_megabytes", megabytes}});
            } else {
                fmt::print("{}: {} solves, about {:.3g} s each, {:.3g} s on {} threads, {:.0f} MB\n", name,
                           task.vertices.size(), each, seconds, threads, megabytes);
            }
        }
    }
    if (!common.json) fmt::print("about {:.3g} s in all\n", total);
    return run.any_failure() ? kSomeFailed : kDone;
}

/// Everything, or this machine's part of it.
SweepPlan make_plan(const SweepConfig& config, const std::vector<std::string>& files,
                    const CommonOptions& common) {
    if (config.shard.empty()) return {files.size(), parse_resolutions(config.resolutions).size()};
    require_shardable(config);
    SweepPlan plan(config, files, common.resolved_threads());
    spdlog::info("{}", plan.summary());
    return plan;
}

int report(const std::vector<ItemSummary>& summaries, bool failed, const std::string& output,
           const CommonOptions& common) {
    for (const ItemSummary& s : summaries) {
        failed = failed || s.failed > 0;
        if (common.json) print_json(to_json(s));
    }
    if (!common.json) {
        print_table(summaries);
        fmt::print("wrote {}\n", output);
    }
    return failed ? kSomeFailed : kDone;
}

int sweep(const SweepConfig& config, const CommonOptions& common, bool dry) {
    const std::vector<std::string> files = expand_inputs(config.meshes);
    if (files.empty()) throw UsageError("no meshes: name them, or give a configuration with [input] meshes");
    const SweepPlan plan = make_plan(config, files, common);
    if (dry) return dry_run(config, files, plan, common);
    catch_signals();
    ProgressLine progress(common.quiet);
    const SweepJob job = sweep_to_file(config, sweep_sources(files), plan, progress, stopped_by_signal);
    if (job.stopped) {
        spdlog::warn("stopped by a signal; what is finished is in {}.parts: continue with --resume",
                     config.output);
        return 128 + caught_signal();
    }
    return report(job.summaries, job.any_failure, config.output, common);
}

}  // namespace

SweepConfig resolved_config(const CLI::App& command, const SweepArguments& a) {
    SweepConfig c = a.config.empty() ? SweepConfig{} : read_sweep_config(a.config);
    const SweepConfig& v = a.values;
    const auto given = [&](const char* name) {
        const CLI::Option* option = command.get_option_no_throw(name);
        return option != nullptr && option->count() > 0;
    };
    if (given("MESH")) c.meshes = v.meshes;
    if (given("--repair")) c.repair = v.repair;
    if (given("--scheme")) c.scheme = v.scheme;
    if (given("--boundary")) c.boundary = v.boundary;
    if (given("--cone-curvature")) c.cone_curvature = v.cone_curvature;
    if (given("--delaunay")) c.delaunay = v.delaunay;
    if (given("--tolerance")) c.tolerance = v.tolerance;
    if (given("--max-iterations")) c.max_iterations = v.max_iterations;
    if (given("--densify")) c.densify = v.densify;
    if (given("--solver")) c.solver = v.solver;
    if (given("--precision")) c.precision = v.precision;
    if (given("--vertices")) c.vertices = v.vertices;
    if (given("--resolutions")) c.resolutions = v.resolutions;
    if (given("--keep")) c.keep = v.keep;
    if (given("--output")) c.output = v.output;
    if (given("--shard")) c.shard = v.shard;
    if (given("--lanes")) c.lanes = v.lanes;
    if (given("--max-memory")) c.max_memory = v.max_memory;
    if (given("--timeout")) c.timeout = v.timeout;
    if (given("--component")) c.component = v.component;
    if (given("--isolate")) c.isolate = v.isolate;
    if (given("--hang-timeout")) c.hang_timeout = v.hang_timeout;
    c.resume = v.resume;
    c.retry_failed = v.retry_failed;
    return c;
}

void add_sweep_options(CLI::App* command, SweepArguments* a) {
    SweepConfig& v = a->values;
    command->add_option("MESH", v.meshes, "Files, folders or globs");
    command->add_option("--config", a->config,
                        "TOML file with [input], [solve], [sweep], [run]; options given here win");
    command->add_option("-o,--output", v.output, "Result file (HDF5); default sweep.h5");
    command->add_option("--vertices", v.vertices,
                        "all, sample:N[:SEED], list:V,V,..., or a file with vertex numbers");
    command->add_option("--resolutions", v.resolutions, "Face counts, or input: 5000,10000,input")
        ->delimiter(',');
    command->add_option(
        "--keep", v.keep,
        "Conformal factors to store: none, best, worst, best,worst (default), all, or a number");
    command->add_option("--scheme", v.scheme,
                        "vertex-scaling, inversive-distance, thurston, tangential, virtual-radius");
    command->add_option("--boundary", v.boundary,
                        "geodesic, or free: u = 0 there, the boundary takes what the cone leaves");
    command->add_option("--cone-curvature", v.cone_curvature, "Of the cone, like -4pi; default 2 pi chi");
    command->add_option("--delaunay", v.delaunay, "isometric (default), or none");
    command->add_option("--tolerance", v.tolerance, "On max |K - target|, radians; default 1e-10")
        ->check(CLI::PositiveNumber);
    command
        ->add_option("--max-iterations", v.max_iterations,
                     "Steps of a solve; 0: 500, in lanes 60 and then Newton's method")
        ->check(CLI::NonNegativeNumber);
    command->add_flag("--densify", v.densify,
                      "Refine around each cone and raise its valence (circle packings)");
    command->add_option("--solver", v.solver,
                        "lanes (default): several vertices at a time where the scheme is vertex-scaling; or "
                        "newton: one at a time");
    command->add_option(
        "--precision", v.precision,
        "auto (default: double, and 19 or 50 digits where its rounding is too coarse), double, "
        "extended (no lanes)");
    command->add_option("--lanes", v.lanes, "Vertices at a time on each thread, 1 to 16; default 16")
        ->check(CLI::Range(1, kLanes));
    command->add_option("--repair", v.repair, "Changes to make: orient,weld,drop-degenerate");
    command->add_option("--timeout", v.timeout, "Seconds per solve; 0: none")->check(CLI::NonNegativeNumber);
    command->add_option("--max-memory", v.max_memory,
                        "Bound on the predicted memory, like 8G; with --isolate on the memory itself");
}

void add_sweep(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("sweep", "The main job: every vertex in turn as the only cone, of every mesh");
    auto a = std::make_shared<SweepArguments>();
    add_sweep_options(command, a.get());
    SweepConfig& v = a->values;
    command->add_flag("--resume", v.resume, "Continue what an interrupted run finished");
    command->add_flag("--retry-failed", v.retry_failed,
                      "Continue as --resume does, or go on from a complete file, and try what failed again");
    command->add_flag("--isolate,!--no-isolate", v.isolate,
                      "Each file in a child process: a crash, a hang or a memory blow-up becomes a recorded "
                      "failure with a reproducer in OUTPUT.failures/, and everything else goes on");
    command
        ->add_option("--hang-timeout", v.hang_timeout,
                     "With --isolate: seconds without a sign of life after which a child is killed; default "
                     "600, 0: never")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--component", v.component,
                     "Only this component of each file (numbers as in item names, from 0)")
        ->check(CLI::NonNegativeNumber);
    command->add_flag("--dry-run", a->dry_run, "Only say what would run, with time and memory");
    command->add_option("--shard", v.shard,
                        "i/N: the i-th of N equal parts of the whole work (i = 0 … N-1), to be joined by "
                        "'ricci merge'; see 'ricci submit'");
    add_common(*command, common);
    command->footer(
        "Example: ricci sweep eight.off --vertices sample:200 --resolutions 5000,input -o eight.h5");
    command->callback([&common, &action, a, command] {
        action = [&common, a, command] {
            SweepConfig config = resolved_config(*command, *a);
            CommonOptions resolved = common;
            if (resolved.threads == 0) resolved.threads = config.threads;
            config.threads = resolved.resolved_threads();
            return sweep(config, resolved, a->dry_run);
        };
    });
}

}  // namespace ricci::app
