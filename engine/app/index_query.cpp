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
#include "engine/app/index_search.h"
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

void print_answer(const IndexQuery& query, const IndexSearch::Type* type, const std::vector<Neighbour>& found,
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
    double opened = seconds_since(opening);  // and read: counts for the next query that is answered
    catch_signals();
    const std::vector<std::string> files = expand_inputs(a.paths);
    bool failed = false;
    for (const std::string& file : files) {
        std::vector<IndexQuery> queries;
        try {
            std::string bytes = read_text(file);
            const std::uint64_t hash = checksum_of(std::string_view(bytes));
            const auto start = Clock::now();
            queries = index.known_shapes(file, hash);
            opened += seconds_since(start);
            if (queries.empty())
                with_thread_limit(common.resolved_threads(), [&] {
                    const LoadedMesh loaded =
                        load_mesh_bytes(file, std::move(bytes), parse_repair(index.config().repair));
                    queries = index.describe(file, loaded, stopped_by_signal, failed);
                });
        } catch (const FileError& e) {
            if (files.size() == 1) throw;
            spdlog::error("{}", e.what());
            failed = true;
        }
        if (caught_signal() != 0) return 128 + caught_signal();
        for (const IndexQuery& query : queries) {
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
