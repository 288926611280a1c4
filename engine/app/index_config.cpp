#include "engine/app/index_config.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/app/console.h"
#include "engine/app/solve_options.h"
#include "engine/app/sweep_config.h"
#include "engine/app/toml_text.h"

namespace ricci::app {
namespace {

template <class T>
void take(const toml::table& root, const char* table, const char* key, T& value) {
    const toml::node* node = root[table][key].node();
    const auto found = node == nullptr ? std::optional<T>() : toml_value<T>(*node);
    if (!found) throw UsageError(fmt::format("the index lacks its option [{}] {}", table, key));
    value = *found;
}

/// What add_index_options() asks of arguments holds of stored options too: they decide what a query computes.
void require_ranges(const IndexConfig& c) {
    const bool in_range = c.max_length > 0.0 && std::isfinite(c.max_length) && c.count >= 0 &&
                          c.fingerprint >= 1 && c.fingerprint <= 1000 && c.tolerance > 0.0 &&
                          std::isfinite(c.tolerance) && c.max_iterations >= 0 && c.timeout >= 0.0;
    if (!in_range) throw UsageError("an option of the index is out of its range");
}

}  // namespace

void add_index_options(CLI::App& command, IndexConfig& c) {
    command.add_option("--max-length", c.max_length, "Length spectra complete up to here")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command.add_option("--count", c.count, "At least so many lengths instead")->check(CLI::NonNegativeNumber);
    command.add_option("--fingerprint", c.fingerprint, "Lengths that neighbours are sought by")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    command.add_flag("!--no-coordinates", c.coordinates, "Leave the Teichmueller coordinates out");
    command
        .add_option("--resolutions", c.resolutions,
                    "Face counts, or input: the finest is the entry, the others give its error bars")
        ->delimiter(',');
    command
        .add_option("--scheme", c.scheme,
                    "vertex-scaling, inversive-distance, thurston, tangential, virtual-radius")
        ->capture_default_str();
    command.add_option("--delaunay", c.delaunay, "isometric, or none")->capture_default_str();
    command.add_option("--tolerance", c.tolerance, "On max |K - target|, radians")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command.add_option("--max-iterations", c.max_iterations, "0: 500 Newton steps")
        ->check(CLI::NonNegativeNumber);
    command.add_option("--repair", c.repair, "Changes to make: orient,weld,drop-degenerate");
    command.add_option("--timeout", c.timeout, "Seconds per shape; 0: none")->check(CLI::NonNegativeNumber);
}

std::vector<std::string> index_arguments(const IndexConfig& c) {
    std::vector<std::string> words{fmt::format("--max-length={}", c.max_length),
                                   fmt::format("--count={}", c.count),
                                   fmt::format("--fingerprint={}", c.fingerprint),
                                   fmt::format("--resolutions={}", fmt::join(c.resolutions, ",")),
                                   fmt::format("--scheme={}", c.scheme),
                                   fmt::format("--delaunay={}", c.delaunay),
                                   fmt::format("--tolerance={}", c.tolerance),
                                   fmt::format("--max-iterations={}", c.max_iterations),
                                   fmt::format("--timeout={}", c.timeout)};
    if (!c.repair.empty()) words.push_back(fmt::format("--repair={}", c.repair));
    if (!c.coordinates) words.emplace_back("--no-coordinates");
    return words;
}

std::string to_toml(const IndexConfig& c) {
    toml::array resolutions;
    for (const std::string& r : c.resolutions) resolutions.push_back(r);
    const toml::table root{{"input", toml::table{{"repair", c.repair}, {"resolutions", resolutions}}},
                           {"solve", toml::table{{"scheme", c.scheme},
                                                 {"delaunay", c.delaunay},
                                                 {"tolerance", c.tolerance},
                                                 {"max_iterations", c.max_iterations},
                                                 {"timeout", c.timeout}}},
                           {"shape", toml::table{{"max_length", c.max_length},
                                                 {"count", c.count},
                                                 {"coordinates", c.coordinates},
                                                 {"fingerprint", c.fingerprint}}}};
    return toml_text(root);
}

IndexConfig index_config_from_toml(const std::string& text) {
    IndexConfig c;
    const toml::table root = parse_toml(text, "the options of the index");
    take(root, "input", "repair", c.repair);
    take(root, "solve", "scheme", c.scheme);
    take(root, "solve", "delaunay", c.delaunay);
    take(root, "solve", "tolerance", c.tolerance);
    take(root, "solve", "max_iterations", c.max_iterations);
    take(root, "solve", "timeout", c.timeout);
    take(root, "shape", "max_length", c.max_length);
    take(root, "shape", "count", c.count);
    take(root, "shape", "coordinates", c.coordinates);
    take(root, "shape", "fingerprint", c.fingerprint);
    const toml::array* resolutions = root["input"]["resolutions"].as_array();
    if (resolutions == nullptr) throw UsageError("the index lacks its option [input] resolutions");
    c.resolutions.clear();
    for (const toml::node& node : *resolutions) c.resolutions.push_back(node.value_or(std::string()));
    require_ranges(c);
    return c;
}

ShapeOptions shape_options(const IndexConfig& c) {
    ShapeOptions options;
    options.flow.scheme = parse_scheme(c.scheme);
    options.flow.delaunay = parse_delaunay(c.delaunay);
    options.flow.tolerance = c.tolerance;
    options.flow.max_iterations = c.max_iterations;
    options.max_length = c.max_length;
    options.count = c.count;
    options.coordinates = c.coordinates;
    options.fingerprint = c.fingerprint;
    parse_resolutions(c.resolutions);
    parse_repair(c.repair);
    return options;
}

}  // namespace ricci::app
