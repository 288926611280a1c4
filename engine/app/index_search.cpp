#include "engine/app/index_search.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "engine/app/shape_record.h"
#include "engine/app/solve_arguments.h"
#include "engine/app/sweep_config.h"

namespace ricci::app {

IndexSearch::IndexSearch(const std::string& path, ShapeMetric metric)
    : reader_(path), config_(index_config_from_toml(reader_.info().fingerprint)), metric_(metric) {
    if (reader_.descriptor_version() != kDescriptorVersion)
        throw UsageError(path + ": its shapes were described by another version of ricci; build it anew");
}

const IndexSearch::Type* IndexSearch::type(Index genus, Index boundaries) {
    const std::array<Index, 2> key{genus, boundaries};
    if (const auto found = types_.find(key); found != types_.end()) return &found->second;
    std::optional<IndexBucket> bucket = reader_.bucket(genus, boundaries);
    if (!bucket) return nullptr;
    ShapeVectors vectors = shape_vectors(*bucket, metric_);
    return &types_.emplace(key, Type{std::move(*bucket), NeighbourSearch(std::move(vectors))}).first->second;
}

std::vector<IndexQuery> IndexSearch::known_shapes(const std::string& file, std::uint64_t hash) {
    std::vector<IndexQuery> queries;
    std::size_t components = 1;
    for (const auto& [genus, boundaries] : reader_.types()) {
        const Type& found = *type(genus, boundaries);
        for (std::size_t i = 0; i < found.bucket.files.size(); ++i) {
            if (found.bucket.hash[i] != hash) continue;
            const std::span<const double> row = found.search.shapes().row(i);
            components = static_cast<std::size_t>(found.bucket.components[i]);
            const std::string name = shape_name(file, found.bucket.component[i], found.bucket.components[i]);
            const bool seen = std::any_of(queries.begin(), queries.end(),
                                          [&](const IndexQuery& q) { return q.name == name; });
            if (!seen) queries.push_back({name, genus, boundaries, hash, {row.begin(), row.end()}, 0.0});
        }
    }
    if (queries.size() != components) return {};
    std::sort(queries.begin(), queries.end(),
              [](const IndexQuery& a, const IndexQuery& b) { return a.name < b.name; });
    return queries;
}

std::vector<IndexQuery> IndexSearch::describe(const std::string& file, const LoadedMesh& loaded,
                                              const std::function<bool()>& stop, bool& failed) const {
    using Clock = std::chrono::steady_clock;
    for (const Defect& error : loaded.report.errors) spdlog::error("{}: {}", file, error.message);
    failed = failed || !loaded.report.errors.empty();
    std::vector<IndexQuery> queries;
    const auto components = static_cast<std::int32_t>(loaded.components.size());
    for (std::int32_t c = 0; c < components; ++c) {
        const auto start = Clock::now();
        ShapeOptions options = shape_options(config_);
        options.coordinates = metric_ == ShapeMetric::coordinates;
        options.flow.interrupted = interruption(config_.timeout, stop);
        const ShapeRecord shape = describe_to_record(loaded.components[static_cast<std::size_t>(c)], options,
                                                     parse_resolutions(config_.resolutions));
        const std::string name = shape_name(file, c, components);
        if (shape.status != static_cast<std::uint8_t>(Status::converged)) {
            spdlog::error("{}: {}: {}", name, name_of(static_cast<Status>(shape.status)), shape.message);
            failed = true;
            continue;
        }
        queries.push_back({name, shape.genus, shape.boundaries, loaded.content_hash,
                           metric_ == ShapeMetric::spectrum ? shape.fingerprint : shape.coordinates,
                           std::chrono::duration<double>(Clock::now() - start).count()});
    }
    return queries;
}

std::vector<Neighbour> neighbours_of(const IndexQuery& query, const IndexSearch::Type& type,
                                     std::size_t count, bool others) {
    if (query.vector.empty()) return {};
    std::size_t same = 0;
    for (const std::uint64_t hash : type.bucket.hash) same += others && hash == query.hash ? 1 : 0;
    std::vector<Neighbour> found = type.search.nearest(query.vector, count + same);
    if (others)
        std::erase_if(found, [&](const Neighbour& n) { return type.bucket.hash[n.shape] == query.hash; });
    if (found.size() > count) found.resize(count);
    return found;
}

}  // namespace ricci::app
