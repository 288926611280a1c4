// Options of the solver as text, shared by the subcommands and the configuration file.
#pragma once

#include <string>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/sweep/sweep_solver.h"

namespace ricci::app {

/// Parse the names of the interface contract. Throw UsageError with the names that exist.
Scheme parse_scheme(const std::string& text);
Method parse_method(const std::string& text);
Boundary parse_boundary(const std::string& text);
SphereRoute parse_sphere_route(const std::string& text);
std::optional<Geometry> parse_geometry(const std::string& text);  // "auto": unset
SweepSolverKind parse_solver(const std::string& text);
Precision parse_precision(const std::string& text);
bool parse_delaunay(const std::string& text);  // "isometric": true, "none": false

/// "VERTEX:CURVATURE".
Cone parse_cone(const std::string& text);

/// "flat", "uniform", "boundary", or a file with one number per line into options.target_values.
void parse_target(const std::string& text, FlowOptions& options);

/// The integers of a file, one per line ('#' starts a comment). Throws FileError, UsageError.
std::vector<Index> read_vertex_list(const std::string& path);

}  // namespace ricci::app
