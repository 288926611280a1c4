// `ricci index distances`: matrices, clusters and their pictures (thesis Tables 6 to 8).
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/app/app.h"
#include "engine/app/index_commands.h"
#include "engine/app/index_vectors.h"
#include "engine/app/pictures/distance_pictures.h"
#include "engine/app/records.h"
#include "engine/app/type_distances.h"
#include "io/store/distance_file.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

std::vector<std::int32_t> narrow(const std::vector<std::size_t>& values) {
    return {values.begin(), values.end()};
}

DistanceRecord make_record(const TypeDistances& d, const IndexArguments& a) {
    DistanceRecord record;
    record.type = d.type;
    record.metric = a.metric;
    record.linkage = a.linkage;
    record.shapes = d.names;
    record.distances = d.matrix.values;
    for (const Merge& merge : d.tree.merges) {
        record.merge_first.push_back(static_cast<std::int32_t>(merge.first));
        record.merge_second.push_back(static_cast<std::int32_t>(merge.second));
        record.merge_height.push_back(merge.height);
    }
    record.leaf_order = narrow(d.order);
    record.cluster = narrow(d.clusters);
    return record;
}

nlohmann::json to_json(const TypeDistances& d, const IndexArguments& a) {
    nlohmann::json rows = nlohmann::json::array(), merges = nlohmann::json::array();
    for (std::size_t i = 0; i < d.matrix.size; ++i) {
        nlohmann::json row = nlohmann::json::array();
        for (std::size_t j = 0; j < d.matrix.size; ++j) row.push_back(d.matrix(i, j));
        rows.push_back(row);
    }
    for (const Merge& merge : d.tree.merges)
        merges.push_back({{"first", merge.first},
                          {"second", merge.second},
                          {"height", merge.height},
                          {"members", merge.members}});
    return {{"type", d.type},    {"metric", a.metric}, {"linkage", a.linkage}, {"shapes", d.names},
            {"distances", rows}, {"merges", merges},   {"order", d.order},     {"clusters", d.clusters}};
}

/// The neighbourhoods of thesis Tables 7 and 8: each shape's nearest, sorted.
void print_neighbourhoods(const TypeDistances& d, const IndexArguments& a) {
    const std::vector<std::string> names = short_names(d.names);
    fmt::print("{}: {} shapes, metric {}\n", d.type, names.size(), a.metric);
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::vector<std::size_t> others;
        for (std::size_t j = 0; j < names.size(); ++j)
            if (j != i) others.push_back(j);
        const std::size_t shown = std::min(others.size(), static_cast<std::size_t>(a.neighbours));
        std::stable_sort(others.begin(), others.end(),
                         [&](std::size_t x, std::size_t y) { return d.matrix(i, x) < d.matrix(i, y); });
        std::string line = fmt::format("  {}", names[i]);
        if (a.clusters > 0) line += fmt::format(" [{}]", d.clusters[i]);
        line += ":";
        for (std::size_t k = 0; k < shown; ++k)
            line += fmt::format("{} {} {:.4g}", k == 0 ? "" : ",", names[others[k]], d.matrix(i, others[k]));
        fmt::print("{}\n", line);
    }
}

/// FILE.ext, or FILE.g2b0.ext where there are several types.
std::string file_of_type(const std::string& path, const std::string& type, bool several) {
    if (!several) return path;
    const std::size_t slash = path.rfind('/'), dot = path.rfind('.');
    if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return path + "." + type;
    return path.substr(0, dot) + "." + type + path.substr(dot);
}

void write_files(const TypeDistances& d, const IndexArguments& a, bool several) {
    if (a.output.ends_with(".csv"))
        write_distance_csv(file_of_type(a.output, d.type, several), make_record(d, a));
    const std::vector<std::string> names = short_names(d.names);
    const std::string title = fmt::format("{}: distances ({}) of {} shapes", d.type, a.metric, names.size());
    if (!a.heatmap.empty())
        draw_distances(d.matrix, d.order, names, title).save(file_of_type(a.heatmap, d.type, several));
    if (!a.dendrogram.empty())
        draw_dendrogram(d.tree, d.clusters, names, fmt::format("{}, {} linkage", title, a.linkage))
            .save(file_of_type(a.dendrogram, d.type, several));
}

/// The types asked for that hold at least two shapes. Throws UsageError when there are none.
std::vector<IndexBucket> chosen_buckets(const IndexArguments& a) {
    const IndexReader reader(a.index);
    std::vector<IndexBucket> buckets;
    std::string types;
    for (const auto& [genus, boundaries] : reader.types()) {
        const std::string type = type_name(genus, boundaries);
        types += (types.empty() ? "" : ", ") + type;
        if (!a.type.empty() && a.type != type) continue;
        IndexBucket bucket = reader.bucket(genus, boundaries).value();
        if (bucket.files.size() > 1 || !a.type.empty()) buckets.push_back(std::move(bucket));
    }
    if (!buckets.empty()) return buckets;
    if (a.type.empty()) throw UsageError(a.index + ": no topological type holds two shapes");
    throw UsageError(fmt::format("{}: holds no shape of type '{}' (it holds: {})", a.index, a.type, types));
}

}  // namespace

int index_distances(const IndexArguments& a, const CommonOptions& common) {
    const ShapeMetric metric = parse_shape_metric(a.metric);
    const Linkage linkage = parse_linkage(a.linkage);
    if (!a.output.empty() && !a.output.ends_with(".csv") && !a.output.ends_with(".h5"))
        throw UsageError(fmt::format("'{}' ends neither in .csv nor in .h5", a.output));
    const std::vector<IndexBucket> buckets = chosen_buckets(a);
    std::vector<DistanceRecord> records;
    for (const IndexBucket& bucket : buckets) {
        TypeDistances d;
        with_thread_limit(common.resolved_threads(), [&] {
            d = measure_distances(bucket, metric, linkage, static_cast<std::size_t>(a.clusters));
        });
        if (d.names.empty()) {
            spdlog::warn("{}: no shape has {}", d.type, a.metric);
            continue;
        }
        write_files(d, a, buckets.size() > 1);
        if (a.output.ends_with(".h5")) records.push_back(make_record(d, a));
        if (common.json)
            print_json(to_json(d, a));
        else
            print_neighbourhoods(d, a);
    }
    if (a.output.ends_with(".h5")) {
        const IndexReader reader(a.index);
        write_distance_file(
            a.output,
            make_run_info(reader.info().config, reader.info().fingerprint, common.resolved_threads()),
            records);
    }
    return kDone;
}

}  // namespace ricci::app
