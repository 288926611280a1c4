// Everything that decides a sweep, from a TOML file and arguments.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/sweep/sweep_solver.h"
#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"

namespace ricci::app {

struct SweepConfig {
    std::vector<std::string> meshes;  // files, folders, globs
    std::string repair;
    Index component = -1;  // the only one of each file to sweep; -1: all
    std::string scheme = "vertex-scaling", boundary = "geodesic", cone_curvature, delaunay = "isometric";
    double tolerance = 1e-10;
    std::int32_t max_iterations = 0;
    bool densify = false;
    std::string solver = "lanes";
    std::string precision = "auto";
    std::string vertices = "all";                      // all | sample:N[:SEED] | list:V,V,... | FILE
    std::vector<std::string> resolutions = {"input"};  // face counts or "input"
    std::string keep = "best,worst";                   // none | best | worst | best,worst | all | K
    std::string output = "sweep.h5";
    std::string shard;  // i/N, i from 0
    int threads = 0;
    int lanes = kLanes;
    std::string max_memory;
    double timeout = 0.0;
    bool isolate = false;         // a child process per file
    double hang_timeout = 600.0;  // seconds without a sign of life, where isolated
    bool resume = false, retry_failed = false;
};

/// Reads a configuration. Throws FileError; UsageError naming file, line and key for anything unknown or of
/// the wrong type.
SweepConfig read_sweep_config(const std::string& path);
/// The same from its text; `path` is for messages.
SweepConfig sweep_config_from_toml(std::string_view text, const std::string& path);

/// The resolved configuration as TOML: what decides the results, and how it was run.
std::string to_toml(const SweepConfig& config, bool only_what_decides_results);

/// Parsed forms; all throw UsageError.
SweepOptions sweep_options(const SweepConfig& config);
KeepPolicy parse_keep(const std::string& text);

struct VertexChoice {
    enum class Kind : std::uint8_t { all, sample, list } kind = Kind::all;
    std::int64_t count = 0;
    std::uint64_t seed = 0;
    std::vector<Index> list;
};
VertexChoice parse_vertices(const std::string& text);
/// The candidates chosen, ascending. Throws std::invalid_argument for a listed vertex that is no candidate.
std::vector<Index> choose_vertices(const VertexChoice& choice, const std::vector<Index>& candidates);

/// Target face counts; 0 means the input as it is.
std::vector<Index> parse_resolutions(const std::vector<std::string>& texts);

struct Shard {
    std::size_t index = 0, count = 1;
};
Shard parse_shard(const std::string& text);

}  // namespace ricci::app
