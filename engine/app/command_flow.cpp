#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/records.h"
#include "engine/app/solve_arguments.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

struct FlowArguments {
    SolveArguments solve;
    std::string output;
    bool log = false;
};

nlohmann::json to_json(const std::string& file, const FlowResult& r, const FlowOptions& options,
                       double seconds) {
    nlohmann::json log = nlohmann::json::array();
    for (const IterationLog& line : r.outcome.log)
        log.push_back({{"iteration", line.iteration},
                       {"residual_max", finite_or_null(line.residual_max)},
                       {"step", line.step},
                       {"flips", line.flips},
                       {"seconds", line.seconds}});
    nlohmann::json object = {{"file", file},
                             {"geometry", name_of(r.geometry)},
                             {"scheme", name_of(options.scheme)},
                             {"method", name_of(options.method)},
                             {"boundary", name_of(r.boundary)},
                             {"status", name_of(r.outcome.status)},
                             {"message", r.message},
                             {"newton_iterations", r.outcome.iterations},
                             {"residual_max", finite_or_null(r.outcome.residual_max)},
                             {"flips", r.outcome.flips},
                             {"gauss_bonnet_error", finite_or_null(r.gauss_bonnet_error)},
                             {"area", finite_or_null(r.area)},
                             {"extended_precision", r.precision_digits > 16},
                             {"precision_digits", r.precision_digits},
                             {"seconds", seconds},
                             {"log", log}};
    if (r.packing) {
        object["packing"] = {{"max_length_error", r.packing->max_length_error},
                             {"mean_length_error", r.packing->mean_length_error},
                             {"clipped_edges", r.packing->clipped_edges}};
    }
    return object;
}

void print_text(const std::string& item, const FlowResult& r, const FlowOptions& options, bool log,
                double seconds) {
    if (log) {
        std::printf("%9s %14s %10s %10s %10s\n", "iteration", "residual_max", "step", "flips", "seconds");
        for (const IterationLog& line : r.outcome.log)
            std::printf("%9d %14.6e %10.3g %10lld %10.4f\n", line.iteration, line.residual_max, line.step,
                        static_cast<long long>(line.flips), line.seconds);
    }
    fmt::print(
        "{}: {} ({}, {}, {}), residual {:.3g}, {} steps, {} flips, Gauss-Bonnet error {:.2g}, {:.3f} s{}\n",
        item, name_of(r.outcome.status), name_of(r.geometry), name_of(options.scheme),
        name_of(options.method), r.outcome.residual_max, r.outcome.iterations, r.outcome.flips,
        r.gauss_bonnet_error, seconds,
        r.precision_digits > 16 ? fmt::format(", {} digits", r.precision_digits) : "");
    if (r.packing)
        fmt::print(
            "  initial packing: lengths off by {:.3g} at most, {:.3g} on average; {} obtuse intersections "
            "clipped\n",
            r.packing->max_length_error, r.packing->mean_length_error, r.packing->clipped_edges);
    if (!r.message.empty()) fmt::print("  {}\n", r.message);
}

int flow(const FlowArguments& a, const CommonOptions& common) {
    using Clock = std::chrono::steady_clock;
    FlowOptions options = flow_options(a.solve);
    const std::optional<LoadedMesh> loaded = load_input(a.solve.mesh, a.solve.repair, common);
    if (!loaded) return kSomeFailed;
    require_one_component(*loaded, options);
    options.parallel = common.resolved_threads() > 1;
    std::unique_ptr<RunStore> store;
    std::vector<std::string> names;
    if (!a.output.empty())
        store = std::make_unique<RunStore>(
            a.output, make_run_info(to_toml(a.solve), command_line(), common.resolved_threads()), false);
    catch_signals();
    int status = kDone;
    for (std::size_t c = 0; c < loaded->components.size(); ++c) {
        const auto start = Clock::now();
        options.interrupted = interruption(a.solve.timeout);
        const SurfaceMesh mesh =
            a.solve.densify ? densified(loaded->components[c], options) : loaded->components[c];
        const std::string name = component_name(*loaded, c, mesh.connectivity.face_count());
        FlowResult result;
        with_thread_limit(common.resolved_threads(), [&] { result = solve_flow(mesh, options); });
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (result.outcome.status != Status::converged) {
            status = kSomeFailed;
            spdlog::error("{}: {}: {}", name, name_of(result.outcome.status), result.message);
        }
        if (common.json) {
            nlohmann::json object = to_json(a.solve.mesh, result, options, seconds);
            object["item"] = name;
            print_json(object);
        } else {
            print_text(name, result, options, a.log, seconds);
        }
        if (!store) continue;
        names.push_back(name);
        store->write_item(make_item(name, a.solve.mesh, loaded->content_hash, mesh));
        store->write_flow(make_flow_record(name, result, options, seconds));
        if (result.outcome.status != Status::converged)
            store->write_failure({name, "flow", std::string(name_of(result.outcome.status)), result.message});
    }
    if (store) store->assemble(names, {});
    return caught_signal() != 0 ? 128 + caught_signal() : status;
}

}  // namespace

void add_flow(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand("flow", "One solve: the metric with prescribed curvature");
    auto a = std::make_shared<FlowArguments>();
    add_solve_arguments(*command, a->solve);
    command->add_option("-o,--output", a->output, "Result file (HDF5)");
    command->add_flag("--log", a->log, "Print the residual of every step");
    add_common(*command, common);
    command->footer("Example: ricci flow eight.off --cone=0:-4pi --log -o eight.h5");
    command->callback([&common, &action, a] { action = [&common, a] { return flow(*a, common); }; });
}

}  // namespace ricci::app
