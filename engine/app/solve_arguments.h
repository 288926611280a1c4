// The solving options of the interface as arguments of a subcommand, and what subcommands on single meshes
// share.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/app/console.h"
#include "engine/flow/flow.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {

/// As typed.
struct SolveArguments {
    std::string mesh, repair, geometry = "auto", scheme = "vertex-scaling", method = "newton",
                              sphere = "robust", precision = "auto", target, boundary, delaunay = "isometric";
    std::vector<std::string> cones;
    double tolerance = 1e-10, timeout = 0.0;
    std::int32_t max_iterations = 0;
    bool densify = false;
};

/// Adds MESH and the solving options to a subcommand.
void add_solve_arguments(CLI::App& command, SolveArguments& arguments);

/// Parsed. Throws UsageError.
FlowOptions flow_options(const SolveArguments& arguments);

/// The resolved options, stored with the result.
std::string to_toml(const SolveArguments& arguments);

/// Loads a mesh and logs its notes. Where it has defects, logs them, prints a JSON object (`invalid_input`)
/// where asked, and returns nothing.
std::optional<LoadedMesh> load_input(const std::string& path, const std::string& repair,
                                     const CommonOptions& common);

/// <stem>@<faces>, or <stem>.c<component>@<faces> where there are several.
std::string component_name(const LoadedMesh& loaded, std::size_t component, Index faces);

/// Cones and target files name vertices of one surface. Throws UsageError where there are several.
void require_one_component(const LoadedMesh& loaded, const FlowOptions& options);

/// The component with its cones refined around (--densify).
SurfaceMesh densified(const SurfaceMesh& mesh, const FlowOptions& options);

/// Ends a solve when `stop` says so (a signal was caught), or `timeout` seconds from now (0: never).
std::function<std::optional<Status>()> interruption(double timeout,
                                                    std::function<bool()> stop = stopped_by_signal);

}  // namespace ricci::app
