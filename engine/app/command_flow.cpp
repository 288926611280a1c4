#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <toml++/toml.h>

#include <chrono>
#include <cstdio>
#include <sstream>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/records.h"
#include "engine/app/solve_options.h"
#include "engine/remesh/densify.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

struct FlowArguments {
    std::string mesh, output, repair, geometry = "auto", scheme = "vertex-scaling", method = "newton", target,
                                      boundary, delaunay = "isometric";
    std::vector<std::string> cones;
    double tolerance = 1e-10, timeout = 0.0;
    std::int32_t max_iterations = 0;
    bool log = false, densify = false;
};

FlowOptions flow_options(const FlowArguments& a) {
    FlowOptions options;
    options.geometry = parse_geometry(a.geometry);
    options.scheme = parse_scheme(a.scheme);
    options.method = parse_method(a.method);
    if (!a.target.empty()) parse_target(a.target, options);
    for (const std::string& cone : a.cones) options.cones.push_back(parse_cone(cone));
    if (!a.boundary.empty()) options.boundary = parse_boundary(a.boundary);
    options.delaunay = parse_delaunay(a.delaunay);
    options.tolerance = a.tolerance;
    options.max_iterations = a.max_iterations;
    if (a.densify && a.cones.empty()) throw UsageError("--densify refines around cones: give --cone");
    if (a.densify && options.target == TargetKind::values)
        throw UsageError("--densify adds vertices, which a target file cannot name");
    return options;
}

/// The resolved options, stored with the result.
std::string to_toml(const FlowArguments& a) {
    toml::array cones;
    for (const std::string& cone : a.cones) cones.push_back(cone);
    const toml::table root{{"input", toml::table{{"meshes", toml::array{a.mesh}}, {"repair", a.repair}}},
                           {"solve", toml::table{{"geometry", a.geometry},
                                                 {"scheme", a.scheme},
                                                 {"method", a.method},
                                                 {"target", a.target},
                                                 {"cones", cones},
                                                 {"boundary", a.boundary},
                                                 {"delaunay", a.delaunay},
                                                 {"tolerance", a.tolerance},
                                                 {"max_iterations", a.max_iterations},
                                                 {"densify", a.densify}}}};
    std::ostringstream text;
    text << root << "\n";
    return text.str();
}

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
                             {"extended_precision", r.extended_precision},
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
        r.gauss_bonnet_error, seconds, r.extended_precision ? ", extended precision" : "");
    if (r.packing)
        fmt::print(
            "  initial packing: lengths off by {:.3g} at most, {:.3g} on average; {} obtuse intersections "
            "clipped\n",
            r.packing->max_length_error, r.packing->mean_length_error, r.packing->clipped_edges);
    if (!r.message.empty()) fmt::print("  {}\n", r.message);
}

SurfaceMesh densified(const SurfaceMesh& mesh, const FlowOptions& options) {
    const Topology topology = topology_of(mesh.connectivity);
    SurfaceMesh dense = mesh;
    for (const Cone& cone : options.cones) {
        const Index least = std::max(4 * topology.genus, 3 - 2 * topology.euler_characteristic);
        dense = densify_around(dense, cone.vertex, least).mesh;
    }
    return dense;
}

int flow(const FlowArguments& a, const CommonOptions& common) {
    using Clock = std::chrono::steady_clock;
    FlowOptions options = flow_options(a);
    const LoadedMesh loaded = load_mesh(a.mesh, parse_repair(a.repair));
    for (const Defect& note : loaded.report.notes) spdlog::info("{}: {}", a.mesh, note.message);
    if (!loaded.report.errors.empty()) {
        for (const Defect& error : loaded.report.errors) spdlog::error("{}: {}", a.mesh, error.message);
        if (common.json)
            print_json({{"file", a.mesh},
                        {"status", name_of(Status::invalid_input)},
                        {"message", loaded.report.errors.front().message}});
        return kSomeFailed;
    }
    const bool several = loaded.components.size() > 1;
    if (several && (!options.cones.empty() || options.target == TargetKind::values))
        throw UsageError("cones and target files name vertices of one surface; this input has " +
                         std::to_string(loaded.components.size()) + " components");
    options.parallel = common.resolved_threads() > 1;
    std::unique_ptr<RunStore> store;
    std::vector<std::string> names;
    if (!a.output.empty())
        store = std::make_unique<RunStore>(
            a.output, make_run_info(to_toml(a), command_line(), common.resolved_threads()), false);
    catch_signals();
    int status = kDone;
    for (std::size_t c = 0; c < loaded.components.size(); ++c) {
        const auto start = Clock::now();
        options.interrupted = [&]() -> std::optional<Status> {
            if (caught_signal() != 0) return Status::cancelled;
            const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
            if (a.timeout > 0.0 && seconds > a.timeout) return Status::timeout;
            return std::nullopt;
        };
        const SurfaceMesh mesh = a.densify ? densified(loaded.components[c], options) : loaded.components[c];
        const std::string name = item_name(several ? fmt::format("{}.c{}", loaded.stem, c) : loaded.stem,
                                           mesh.connectivity.face_count());
        FlowResult result;
        with_thread_limit(common.resolved_threads(), [&] { result = solve_flow(mesh, options); });
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (result.outcome.status != Status::converged) {
            status = kSomeFailed;
            spdlog::error("{}: {}: {}", name, name_of(result.outcome.status), result.message);
        }
        if (common.json) {
            nlohmann::json object = to_json(a.mesh, result, options, seconds);
            object["item"] = name;
            print_json(object);
        } else {
            print_text(name, result, options, a.log, seconds);
        }
        if (!store) continue;
        names.push_back(name);
        store->write_item(make_item(name, a.mesh, loaded.content_hash, mesh));
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
    command->add_option("MESH", a->mesh, "OBJ, OFF, PLY, STL (each also .gz) or .len")->required();
    command->add_option("-o,--output", a->output, "Result file (HDF5)");
    command->add_flag("--log", a->log, "Print the residual of every step");
    command->add_option("--geometry", a->geometry, "auto, euclidean, hyperbolic, spherical")
        ->capture_default_str();
    command
        ->add_option("--scheme", a->scheme,
                     "vertex-scaling, inversive-distance, thurston, tangential, virtual-radius")
        ->capture_default_str();
    command->add_option("--method", a->method, "newton, gradient")->capture_default_str();
    command->add_option("--tolerance", a->tolerance, "On max |K - target|, radians")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command->add_option("--max-iterations", a->max_iterations, "0: 200 Newton steps, 100000 gradient steps")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--target", a->target,
                        "flat, uniform, boundary, or a file with one curvature per line (radians)");
    command->add_option("--cone", a->cones, "VERTEX:CURVATURE, repeatable; CURVATURE like -4pi, pi/2, -6.28")
        ->take_all()
        ->allow_extra_args(false);
    command->add_option("--boundary", a->boundary,
                        "geodesic (through the double), free (u = 0), curvature (as the target says)");
    command->add_option("--delaunay", a->delaunay, "isometric, or none: start from the input triangulation")
        ->capture_default_str();
    command->add_option("--repair", a->repair, "Changes to make: orient,weld,drop-degenerate");
    command->add_flag("--densify", a->densify,
                      "Refine around the cones and raise their valence first (circle packings)");
    command->add_option("--timeout", a->timeout, "Seconds for the solve; 0: none")
        ->check(CLI::NonNegativeNumber);
    add_common(*command, common);
    command->footer("Example: ricci flow eight.off --cone=0:-4pi --log -o eight.h5");
    command->callback([&common, &action, a] { action = [&common, a] { return flow(*a, common); }; });
}

}  // namespace ricci::app
