// What decides the shapes of an index, kept with it so that queries are described alike.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/shape_space/shape_descriptor.h"

namespace ricci::app {

/// Raised whenever describe_shape() gives other numbers for the same surface: older indices are then
/// described anew.
inline constexpr std::int32_t kDescriptorVersion = 1;

/// As typed.
struct IndexConfig {
    std::string repair, scheme = "vertex-scaling", delaunay = "isometric";
    double tolerance = 1e-10;
    std::int32_t max_iterations = 0;
    double max_length = 4.0;
    std::int64_t count = 0;
    bool coordinates = true;
    std::int32_t fingerprint = 12;
    std::vector<std::string> resolutions = {"input"};
    double timeout = 0.0;
};

/// Adds the options to a subcommand.
void add_index_options(CLI::App& command, IndexConfig& config);

/// The options as they would be typed.
std::vector<std::string> index_arguments(const IndexConfig& config);

/// All of it as TOML, and back. Reading throws UsageError for text that to_toml() did not make.
std::string to_toml(const IndexConfig& config);
IndexConfig index_config_from_toml(const std::string& text);

/// Parsed. Throws UsageError.
ShapeOptions shape_options(const IndexConfig& config);

}  // namespace ricci::app
