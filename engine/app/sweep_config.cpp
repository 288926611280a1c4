#include "engine/app/sweep_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "engine/app/console.h"
#include "engine/app/solve_options.h"
#include "engine/app/toml_text.h"
#include "engine/sweep/scheduler.h"
#include "io/mesh/formats/file_bytes.h"

namespace ricci::app {
namespace {

[[noreturn]] void complain(const std::string& path, const toml::node& node, const std::string& message) {
    throw UsageError(fmt::format("{}:{}: {}", path, node.source().begin.line, message));
}

/// Reads the keys of one table; whatever is not asked for is an error.
class TableReader {
  public:
    TableReader(const std::string& path, const toml::table& root, const std::string& name)
        : path_(&path), name_(name) {
        if (const toml::node* node = root.get(name)) {
            table_ = node->as_table();
            if (table_ == nullptr) complain(path, *node, fmt::format("'{}' must be a table", name));
        }
    }

    void operator()(const char* key, std::string& value) { read(key, value, "a string"); }
    void operator()(const char* key, double& value) { read(key, value, "a number"); }
    void operator()(const char* key, bool& value) { read(key, value, "true or false"); }
    void operator()(const char* key, int& value) { read(key, value, "a whole number"); }
    /// A string or a number, kept as text.
    void text(const char* key, std::string& value) {
        if (const toml::node* node = find(key)) value = text_of(*node, key);
    }
    /// A list of strings or numbers, or a single one.
    void list(const char* key, std::vector<std::string>& value) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        value.clear();
        if (const toml::array* array = node->as_array()) {
            for (const toml::node& element : *array) value.push_back(text_of(element, key));
        } else {
            value.push_back(text_of(*node, key));
        }
    }
    void reject_the_rest() const {
        if (table_ == nullptr) return;
        for (const auto& [key, node] : *table_)
            if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
                complain(*path_, node,
                         fmt::format("unknown key '{}' in [{}]", std::string(key.str()), name_));
    }

  private:
    const toml::node* find(const char* key) {
        known_.emplace_back(key);
        return table_ == nullptr ? nullptr : table_->get(key);
    }
    template <class T>
    void read(const char* key, T& value, const char* kind) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const auto found = toml_value<T>(*node);
        if (!found) complain(*path_, *node, fmt::format("'{}' must be {}", key, kind));
        value = *found;
    }
    std::string text_of(const toml::node& node, const char* key) const {
        if (const auto s = node.value_exact<std::string>()) return *s;
        if (const auto i = node.value_exact<std::int64_t>()) return std::to_string(*i);
        if (const auto d = node.value_exact<double>()) return fmt::format("{}", *d);
        complain(*path_, node, fmt::format("'{}' must hold strings or numbers", key));
    }

    const std::string* path_;
    std::string name_;
    const toml::table* table_ = nullptr;
    std::vector<std::string> known_;
};

void require_threads(int threads, const std::string& where) {
    if (threads < 0 || threads > 4096) throw UsageError(where + "threads must be 0 (all) to 4096");
}

template <class T>
T whole_number(const std::string& text, const std::string& what) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || text.empty())
        throw UsageError(fmt::format("{}: '{}' is not a whole number", what, text));
    return value;
}

std::vector<Index> listed_vertices(const std::string& text) {
    std::vector<Index> list;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        list.push_back(whole_number<Index>(text.substr(begin, end - begin), "vertices list:V,V,..."));
        begin = end + 1;
    }
    return list;
}

}  // namespace

SweepConfig read_sweep_config(const std::string& path) {
    if (!std::filesystem::exists(path)) throw FileError(fmt::format("{}: no such configuration file", path));
    return sweep_config_from_toml(read_file_bytes(path), path);
}

SweepConfig sweep_config_from_toml(std::string_view text, const std::string& path) {
    const toml::table root = parse_toml(text, path);
    for (const auto& [key, node] : root)
        if (key.str() != "input" && key.str() != "solve" && key.str() != "sweep" && key.str() != "run")
            complain(path, node,
                     fmt::format("unknown table or key '{}' (known: input, solve, sweep, run)",
                                 std::string(key.str())));
    SweepConfig c;
    TableReader input(path, root, "input");
    input.list("meshes", c.meshes);
    input("repair", c.repair);
    input("component", c.component);
    input.reject_the_rest();
    TableReader solve(path, root, "solve");
    solve("scheme", c.scheme);
    solve("boundary", c.boundary);
    solve.text("cone_curvature", c.cone_curvature);
    solve("delaunay", c.delaunay);
    solve("tolerance", c.tolerance);
    solve("max_iterations", c.max_iterations);
    solve("densify", c.densify);
    solve("solver", c.solver);
    solve("precision", c.precision);
    solve.reject_the_rest();
    TableReader sweep(path, root, "sweep");
    sweep.text("vertices", c.vertices);
    sweep.list("resolutions", c.resolutions);
    sweep.text("keep", c.keep);
    sweep.reject_the_rest();
    TableReader run(path, root, "run");
    run("output", c.output);
    run.text("shard", c.shard);
    run("threads", c.threads);
    require_threads(c.threads, path + ": ");
    run("lanes", c.lanes);
    run.text("max_memory", c.max_memory);
    run("timeout", c.timeout);
    run("isolate", c.isolate);
    run("hang_timeout", c.hang_timeout);
    run.reject_the_rest();
    return c;
}

std::string to_toml(const SweepConfig& c, bool only_what_decides_results) {
    toml::array meshes, resolutions;
    for (const std::string& m : c.meshes) meshes.push_back(m);
    for (const std::string& r : c.resolutions) resolutions.push_back(r);
    toml::table input{{"meshes", meshes}, {"repair", c.repair}};
    if (c.component >= 0) input.insert("component", c.component);
    toml::table root{
        {"input", std::move(input)},
        {"solve", toml::table{{"scheme", c.scheme},
                              {"boundary", c.boundary},
                              {"cone_curvature", c.cone_curvature},
                              {"delaunay", c.delaunay},
                              {"tolerance", c.tolerance},
                              {"max_iterations", c.max_iterations},
                              {"densify", c.densify},
                              {"solver", c.solver}}},
        {"sweep", toml::table{{"vertices", c.vertices}, {"resolutions", resolutions}, {"keep", c.keep}}}};
    // Runs from before there was a choice can be resumed.
    if (c.precision != "auto" || !only_what_decides_results)
        root["solve"].as_table()->insert("precision", c.precision);
    // A time-out decides which solves fail, a shard which are done at all.
    toml::table run{{"shard", c.shard}, {"timeout", c.timeout}};
    if (!only_what_decides_results) {
        run.insert("output", c.output);
        run.insert("threads", c.threads);
        run.insert("lanes", c.lanes);
        run.insert("max_memory", c.max_memory);
        run.insert("isolate", c.isolate);
        run.insert("hang_timeout", c.hang_timeout);
    }
    root.insert("run", run);
    return toml_text(root);
}

SweepOptions sweep_options(const SweepConfig& c) {
    SweepOptions options;
    options.scheme = parse_scheme(c.scheme);
    options.boundary = parse_boundary(c.boundary);
    if (options.boundary == Boundary::curvature) throw UsageError("a sweep's boundary is geodesic or free");
    if (!c.cone_curvature.empty()) options.cone_curvature = parse_curvature(c.cone_curvature);
    options.delaunay = parse_delaunay(c.delaunay);
    options.densify = c.densify;
    if (options.densify && options.scheme == Scheme::vertex_scaling)
        throw UsageError("densify is for the circle packings; vertex scaling flips edges and needs none");
    if (!(c.tolerance > 0.0) || !std::isfinite(c.tolerance)) throw UsageError("tolerance must be positive");
    if (c.max_iterations < 0) throw UsageError("max_iterations must not be negative");
    if (!(c.timeout >= 0.0)) throw UsageError("timeout must not be negative");
    require_threads(c.threads, "");
    options.tolerance = c.tolerance;
    options.max_iterations = c.max_iterations;
    options.solver = parse_solver(c.solver);
    options.precision = parse_precision(c.precision);
    if (options.precision == Precision::extended && options.scheme != Scheme::vertex_scaling)
        throw UsageError("precision extended is for vertex scaling; circle packings are solved in double");
    if (c.lanes < 1 || c.lanes > kLanes)
        throw UsageError(fmt::format("lanes must be 1 to {}, not {}", kLanes, c.lanes));
    options.lanes = c.lanes;
    return options;
}

KeepPolicy parse_keep(const std::string& text) {
    if (text == "none") return {false, false, 0};
    if (text == "best,worst" || text == "worst,best") return {true, true, 0};
    if (text == "best") return {true, false, 0};
    if (text == "worst") return {false, true, 0};
    if (text == "all") return {true, true, -1};
    const auto count = whole_number<std::int64_t>(text, "keep (none, best, worst, all or a number)");
    if (count < 0) throw UsageError(fmt::format("keep: '{}' is negative", text));
    return {true, true, count};
}

VertexChoice parse_vertices(const std::string& text) {
    VertexChoice choice;
    if (text == "all") return choice;
    if (text.starts_with("sample:")) {
        choice.kind = VertexChoice::Kind::sample;
        const std::string rest = text.substr(7);
        const auto colon = rest.find(':');
        choice.count = whole_number<std::int64_t>(rest.substr(0, colon), "vertices sample:N[:SEED]");
        if (colon != std::string::npos)
            choice.seed = whole_number<std::uint64_t>(rest.substr(colon + 1), "vertices sample:N[:SEED]");
        if (choice.count <= 0) throw UsageError("vertices sample:N needs N > 0");
        return choice;
    }
    choice.kind = VertexChoice::Kind::list;
    choice.list = text.starts_with("list:") ? listed_vertices(text.substr(5)) : read_vertex_list(text);
    return choice;
}

std::vector<Index> choose_vertices(const VertexChoice& choice, const std::vector<Index>& candidates) {
    switch (choice.kind) {
        case VertexChoice::Kind::sample:
            return sample_vertices(candidates, choice.count, choice.seed);
        case VertexChoice::Kind::list: {
            std::vector<Index> chosen = choice.list;
            std::sort(chosen.begin(), chosen.end());
            chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
            for (const Index v : chosen)
                if (!std::binary_search(candidates.begin(), candidates.end(), v))
                    throw std::invalid_argument(
                        fmt::format("vertex {} of the list is no interior vertex of this surface", v));
            return chosen;
        }
        case VertexChoice::Kind::all:
            break;
    }
    return candidates;
}

std::vector<Index> parse_resolutions(const std::vector<std::string>& texts) {
    std::vector<Index> result;
    for (const std::string& text : texts) {
        const Index faces = text == "input" ? 0 : whole_number<Index>(text, "resolutions");
        if (text != "input" && faces < 4)
            throw UsageError(fmt::format("resolution {} is less than a tetrahedron", text));
        result.push_back(faces);
    }
    if (result.empty()) throw UsageError("resolutions: at least one is needed");
    return result;
}

Shard parse_shard(const std::string& text) {
    if (text.empty()) return {};
    const auto slash = text.find('/');
    if (slash == std::string::npos) throw UsageError(fmt::format("shard '{}' is not i/N", text));
    Shard shard;
    shard.index = whole_number<std::size_t>(text.substr(0, slash), "shard i/N");
    shard.count = whole_number<std::size_t>(text.substr(slash + 1), "shard i/N");
    if (shard.count == 0 || shard.index >= shard.count)
        throw UsageError(fmt::format("shard '{}': i must be in 0 … N-1", text));
    return shard;
}

}  // namespace ricci::app
