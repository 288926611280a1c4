#include "engine/app/solve_arguments.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "engine/app/records.h"
#include "engine/app/solve_options.h"
#include "engine/app/toml_text.h"
#include "engine/remesh/densify.h"

namespace ricci::app {

void add_solve_arguments(CLI::App& command, SolveArguments& a) {
    command.add_option("MESH", a.mesh, "OBJ, OFF, PLY, STL (each also .gz) or .len")->required();
    command.add_option("--geometry", a.geometry, "auto, euclidean, hyperbolic, spherical")
        ->capture_default_str();
    command
        .add_option("--scheme", a.scheme,
                    "vertex-scaling, inversive-distance, thurston, tangential, virtual-radius")
        ->capture_default_str();
    command.add_option("--method", a.method, "newton, gradient")->capture_default_str();
    command
        .add_option("--sphere", a.sphere,
                    "Spherical metrics of spheres and disks: robust (through the plane), direct (non-convex)")
        ->capture_default_str();
    command.add_option("--tolerance", a.tolerance, "On max |K - target|, radians")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command
        .add_option("--precision", a.precision,
                    "auto (double, and 19 or 50 digits where its rounding is too coarse), double, extended")
        ->capture_default_str();
    command.add_option("--max-iterations", a.max_iterations, "0: 500 Newton steps, 100000 gradient steps")
        ->check(CLI::NonNegativeNumber);
    command.add_option("--target", a.target,
                       "flat, uniform, boundary, or a file with one curvature per line (radians)");
    command.add_option("--cone", a.cones, "VERTEX:CURVATURE, repeatable; CURVATURE like -4pi, pi/2, -6.28")
        ->take_all()
        ->allow_extra_args(false);
    command.add_option("--boundary", a.boundary,
                       "geodesic (through the double), free (u = 0), curvature (as the target says)");
    command.add_option("--delaunay", a.delaunay, "isometric, or none: start from the input triangulation")
        ->capture_default_str();
    command.add_option("--repair", a.repair, "Changes to make: orient,weld,drop-degenerate");
    command.add_flag("--densify", a.densify,
                     "Refine around the cones and raise their valence first (circle packings)");
    command.add_option("--timeout", a.timeout, "Seconds for the solve; 0: none")
        ->check(CLI::NonNegativeNumber);
}

FlowOptions flow_options(const SolveArguments& a) {
    FlowOptions options;
    options.geometry = parse_geometry(a.geometry);
    options.scheme = parse_scheme(a.scheme);
    options.method = parse_method(a.method);
    options.sphere_route = parse_sphere_route(a.sphere);
    options.precision = parse_precision(a.precision);
    if (options.precision == Precision::extended && options.scheme != Scheme::vertex_scaling)
        throw UsageError("--precision extended is for vertex scaling; circle packings are solved in double");
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

std::string to_toml(const SolveArguments& a) {
    toml::array cones;
    for (const std::string& cone : a.cones) cones.push_back(cone);
    const toml::table root{{"input", toml::table{{"meshes", toml::array{a.mesh}}, {"repair", a.repair}}},
                           {"solve", toml::table{{"geometry", a.geometry},
                                                 {"scheme", a.scheme},
                                                 {"method", a.method},
                                                 {"sphere", a.sphere},
                                                 {"precision", a.precision},
                                                 {"target", a.target},
                                                 {"cones", cones},
                                                 {"boundary", a.boundary},
                                                 {"delaunay", a.delaunay},
                                                 {"tolerance", a.tolerance},
                                                 {"max_iterations", a.max_iterations},
                                                 {"densify", a.densify}}}};
    return toml_text(root);
}

std::optional<LoadedMesh> load_input(const std::string& path, const std::string& repair,
                                     const CommonOptions& common) {
    LoadedMesh loaded = load_mesh(path, parse_repair(repair));
    for (const Defect& note : loaded.report.notes) spdlog::info("{}: {}", path, note.message);
    if (loaded.report.errors.empty()) return loaded;
    for (const Defect& error : loaded.report.errors) spdlog::error("{}: {}", path, error.message);
    if (common.json)
        print_json({{"file", path},
                    {"status", name_of(Status::invalid_input)},
                    {"message", loaded.report.errors.front().message}});
    return std::nullopt;
}

std::string component_name(const LoadedMesh& loaded, std::size_t component, Index faces) {
    const bool several = loaded.components.size() > 1;
    return item_name(several ? fmt::format("{}.c{}", loaded.stem, component) : loaded.stem, faces);
}

void require_one_component(const LoadedMesh& loaded, const FlowOptions& options) {
    if (loaded.components.size() > 1 && (!options.cones.empty() || options.target == TargetKind::values))
        throw UsageError("cones and target files name vertices of one surface; this input has " +
                         std::to_string(loaded.components.size()) + " components");
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

std::function<std::optional<Status>()> interruption(double timeout, std::function<bool()> stop) {
    using Clock = std::chrono::steady_clock;
    return [timeout, stop = std::move(stop), start = Clock::now()]() -> std::optional<Status> {
        if (stop()) return Status::cancelled;
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (timeout > 0.0 && seconds > timeout) return Status::timeout;
        return std::nullopt;
    };
}

}  // namespace ricci::app
