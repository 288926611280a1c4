// `ricci index query` and `stats`: everything that reads an index shape by shape.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <optional>

#include "engine/app/app.h"
#include "engine/app/index_commands.h"
#include "engine/app/index_vectors.h"
#include "engine/app/shape_record.h"
#include "engine/app/solve_arguments.h"
#include "engine/app/sweep_config.h"
#include "io/mesh/mesh_file.h"
#include "io/store/durable.h"
#include "io/store/shape_index.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A shape of one topological type that neighbours are sought of.
struct Query {
    std::string name;
    Index genus = 0, boundaries = 0;
    std::uint64_t hash = 0;
    std::vector<double> vector;
    double seconds = 0.0;  // of its own description
};

/// Types of the index, each read and made searchable when first asked for.
class IndexSearch {
  public:
    IndexSearch(const std::string& path, ShapeMetric metric) : reader_(path), metric_(metric) {}

    struct Type {
        IndexBucket bucket;
        NeighbourSearch search;
    };
    [[nodiscard]] const IndexReader& reader() const { return reader_; }
    [[nodiscard]] ShapeMetric metric() const { return metric_; }
    /// None when the index holds no shape of this type.
    const Type* type(Index genus, Index boundaries) {
        const std::array<Index, 2> key{genus, boundaries};
        if (const auto found = types_.find(key); found != types_.end()) return &found->second;
        std::optional<IndexBucket> bucket = reader_.bucket(genus, boundaries);
        if (!bucket) return nullptr;
        ShapeVectors vectors = shape_vectors(*bucket, metric_);
        return &types_.emplace(key, Type{std::move(*bucket), NeighbourSearch(std::move(vectors))})
                    .first->second;
    }

  private:
    IndexReader reader_;
    ShapeMetric metric_;
    std::map<std::array<Index, 2>, Type> types_;
};

/// The shapes of a file with these bytes as the index has them; empty unless it has all.
std::vector<Query> known_shapes(IndexSearch& index, const std::string& file, std::uint64_t hash) {
    std::vector<Query> queries;
    std::size_t components = 1;
    for (const auto& [genus, boundaries] : index.reader().types()) {
        const IndexSearch::Type& type = *index.type(genus, boundaries);
        for (std::size_t i = 0; i < type.bucket.files.size(); ++i) {
            if (type.bucket.hash[i] != hash) continue;
            const std::span<const double> row = type.search.shapes().row(i);
            components = static_cast<std::size_t>(type.bucket.components[i]);
            const std::string name = shape_name(file, type.bucket.component[i], type.bucket.components[i]);
            const bool seen =
                std::any_of(queries.begin(), queries.end(), [&](const Query& q) { return q.name == name; });
            if (!seen) queries.push_back({name, genus, boundaries, hash, {row.begin(), row.end()}, 0.0});
        }
    }
    if (queries.size() != components) return {};
    std::sort(queries.begin(), queries.end(), [](const Query& a, const Query& b) { return a.name < b.name; });
    return queries;
}

/// Describes the shapes of a file; those that fail are logged and left out, which `failed` tells.
std::vector<Query> describe_file(const std::string& file, std::string bytes, std::uint64_t hash,
                                 const IndexConfig& config, ShapeMetric metric, bool& failed) {
    const LoadedMesh loaded = load_mesh_bytes(file, std::move(bytes), parse_repair(config.repair));
    for (const Defect& error : loaded.report.errors) spdlog::error("{}: {}", file, error.message);
    failed = failed || !loaded.report.errors.empty();
    std::vector<Query> queries;
    const auto components = static_cast<std::int32_t>(loaded.components.size());
    for (std::int32_t c = 0; c < components; ++c) {
        const auto start = Clock::now();
        ShapeOptions options = shape_options(config);
        options.coordinates = metric == ShapeMetric::coordinates;
        options.flow.interrupted = interruption(config.timeout);
        const ShapeRecord shape = describe_to_record(loaded.components[static_cast<std::size_t>(c)], options,
                                                     parse_resolutions(config.resolutions));
        const std::string name = shape_name(file, c, components);
        if (shape.status != static_cast<std::uint8_t>(Status::converged)) {
            spdlog::error("{}: {}: {}", name, name_of(static_cast<Status>(shape.status)), shape.message);
            failed = true;
            continue;
        }
        queries.push_back({name, shape.genus, shape.boundaries, hash,
                           metric == ShapeMetric::spectrum ? shape.fingerprint : shape.coordinates,
                           seconds_since(start)});
    }
    return queries;
}

/// The nearest entries; with `others`, none with the query's own bytes.
std::vector<Neighbour> neighbours_of(const Query& query, const IndexSearch::Type& type, std::size_t count,
                                     bool others) {
    if (query.vector.empty()) return {};
    std::size_t same = 0;
    for (const std::uint64_t hash : type.bucket.hash) same += others && hash == query.hash ? 1 : 0;
    std::vector<Neighbour> found = type.search.nearest(query.vector, count + same);
    if (others)
        std::erase_if(found, [&](const Neighbour& n) { return type.bucket.hash[n.shape] == query.hash; });
    if (found.size() > count) found.resize(count);
    return found;
}

void print_answer(const Query& query, const IndexSearch::Type* type, const std::vector<Neighbour>& found,
                  double seconds, const CommonOptions& common) {
    nlohmann::json list = nlohmann::json::array();
    const std::string type_of_query = type_name(query.genus, query.boundaries);
    if (!common.json)
        fmt::print("{} ({}){}\n", query.name, type_of_query,
                   type == nullptr ? ": the index holds no shape of this topological type" : "");
    for (const Neighbour& n : found) {
        const IndexBucket& bucket = type->bucket;
        if (common.json) {
            list.push_back({{"file", bucket.files[n.shape]}, {"distance", n.distance}});
            if (bucket.components[n.shape] > 1) list.back()["component"] = bucket.component[n.shape];
        } else {
            fmt::print(
                "  {:>12.6g}  {}\n", n.distance,
                shape_name(bucket.files[n.shape], bucket.component[n.shape], bucket.components[n.shape]));
        }
    }
    if (common.json)
        print_json({{"query", query.name},
                    {"type", type_of_query},
                    {"neighbours", list},
                    {"describe_seconds", query.seconds},
                    {"search_seconds", seconds}});
}

nlohmann::json to_json(const IndexBucket& bucket, const std::array<double, 4>& seconds,
                       std::size_t near_ties) {
    return {{"type", type_name(bucket.genus, bucket.boundaries)},
            {"genus", bucket.genus},
            {"boundaries", bucket.boundaries},
            {"shapes", bucket.files.size()},
            {"fingerprint", bucket.fingerprint_size},
            {"names", bucket.names},
            {"with_message", near_ties},
            {"seconds",
             {{"flow", seconds[0]},
              {"surface", seconds[1]},
              {"spectrum", seconds[2]},
              {"coordinates", seconds[3]}}}};
}

}  // namespace

int index_query(const IndexArguments& a, const CommonOptions& common) {
    const auto opening = Clock::now();
    IndexSearch index(a.index, parse_shape_metric(a.metric));
    const IndexConfig config = index_config_from_toml(index.reader().info().fingerprint);
    double opened = seconds_since(opening);  // and read: counts for the next query that is answered
    if (index.reader().descriptor_version() != kDescriptorVersion)
        throw UsageError(a.index + ": its shapes were described by another version of ricci; build it anew");
    catch_signals();
    const std::vector<std::string> files = expand_inputs(a.paths);
    bool failed = false;
    for (const std::string& file : files) {
        std::vector<Query> queries;
        try {
            std::string bytes = read_text(file);
            const std::uint64_t hash = checksum_of(std::string_view(bytes));
            const auto start = Clock::now();
            queries = known_shapes(index, file, hash);
            opened += seconds_since(start);
            if (queries.empty())
                with_thread_limit(common.resolved_threads(), [&] {
                    queries = describe_file(file, std::move(bytes), hash, config, index.metric(), failed);
                });
        } catch (const FileError& e) {
            if (files.size() == 1) throw;
            spdlog::error("{}", e.what());
            failed = true;
        }
        if (caught_signal() != 0) return 128 + caught_signal();
        for (const Query& query : queries) {
            const auto start = Clock::now();
            const IndexSearch::Type* type = index.type(query.genus, query.boundaries);
            std::vector<Neighbour> found;
            if (type != nullptr)
                found = neighbours_of(query, *type, static_cast<std::size_t>(a.neighbours), a.others);
            print_answer(query, type, found, opened + seconds_since(start), common);
            opened = 0.0;
        }
    }
    return failed ? kSomeFailed : kDone;
}

int index_stats(const IndexArguments& a, const CommonOptions& common) {
    const ShapeIndex index = read_shape_index(a.index);
    const IndexReader reader(a.index);
    if (!common.json)
        fmt::print("{:<8} {:>8} {:>12} {:>12} {:>12} {:>10} {:>10}\n", "type", "shapes", "fingerprint",
                   "coordinates", "seconds", "flow", "messages");
    for (const auto& [genus, boundaries] : reader.types()) {
        const IndexBucket bucket = reader.bucket(genus, boundaries).value();
        std::array<double, 4> seconds{};
        std::size_t messages = 0;
        for (const IndexEntry& entry : index.entries) {
            if (entry.shape.genus != genus || entry.shape.boundaries != boundaries) continue;
            messages += entry.shape.message.empty() ? 0 : 1;
            for (std::size_t k = 0; k < 4; ++k) seconds[k] += entry.shape.seconds[k];
        }
        const double all = seconds[0] + seconds[1] + seconds[2] + seconds[3];
        if (common.json)
            print_json(to_json(bucket, seconds, messages));
        else
            fmt::print("{:<8} {:>8} {:>12} {:>12} {:>12.3f} {:>9.1f}% {:>10}\n", type_name(genus, boundaries),
                       bucket.files.size(), bucket.fingerprint_size, bucket.names.size(), all,
                       all > 0.0 ? 100.0 * seconds[0] / all : 0.0, messages);
    }
    for (const FailureRecord& failure : index.failures) {
        if (common.json)
            print_json({{"file", failure.item},
                        {"stage", failure.stage},
                        {"status", failure.status},
                        {"message", failure.message}});
        else
            fmt::print("failed: {} ({}): {}: {}\n", failure.item, failure.stage, failure.status,
                       failure.message);
    }
    return kDone;
}

}  // namespace ricci::app
