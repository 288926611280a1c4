#include "io/store/distance_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/store/csv_text.h"
#include "io/store/durable.h"
#include "io/store/schema.h"
#include "io/store/schema_shapes.h"
#include "io/store/whole_file.h"

namespace ricci {
namespace {

using hdf5::Handle;

void write_record(hid_t parent, const DistanceRecord& record) {
    const Handle group = hdf5::create_group(parent, record.type);
    hdf5::write_text_attribute(group, "metric", record.metric);
    hdf5::write_text_attribute(group, "linkage", record.linkage);
    hdf5::seal(group);
    const hsize_t count = record.shapes.size();
    hdf5::write_text_list(group, "shape", record.shapes);
    hdf5::write_array(group, "distance", std::span<const double>(record.distances), {count, count});
    hdf5::write_array(group, "merge_first", record.merge_first);
    hdf5::write_array(group, "merge_second", record.merge_second);
    hdf5::write_array(group, "merge_height", record.merge_height);
    hdf5::write_array(group, "leaf_order", record.leaf_order);
    hdf5::write_array(group, "cluster", record.cluster);
}

void require(bool holds, hid_t group, const char* what) {
    if (!holds) throw FileError(hdf5::name_of(group) + ": " + what);
}

bool all_below(const std::vector<std::int32_t>& values, std::size_t limit) {
    return std::all_of(values.begin(), values.end(),
                       [&](std::int32_t v) { return v >= 0 && static_cast<std::size_t>(v) < limit; });
}

DistanceRecord read_record(hid_t parent, const std::string& type) {
    const Handle group = hdf5::open_group(parent, type);
    DistanceRecord record;
    record.type = type;
    record.metric = hdf5::read_text_attribute(group, "metric");
    record.linkage = hdf5::read_text_attribute(group, "linkage");
    record.shapes = hdf5::read_text_list(group, "shape");
    const hsize_t count = record.shapes.size(), merges = count > 0 ? count - 1 : 0;
    record.distances = hdf5::read_array<double>(group, "distance", hdf5::Shape{count, count});
    record.merge_first = hdf5::read_array<std::int32_t>(group, "merge_first", hdf5::Shape{merges});
    record.merge_second = hdf5::read_array<std::int32_t>(group, "merge_second", hdf5::Shape{merges});
    record.merge_height = hdf5::read_array<double>(group, "merge_height", hdf5::Shape{merges});
    record.leaf_order = hdf5::read_array<std::int32_t>(group, "leaf_order", hdf5::Shape{count});
    record.cluster = hdf5::read_array<std::int32_t>(group, "cluster", hdf5::Shape{count});
    std::vector<std::int32_t> order = record.leaf_order;
    std::sort(order.begin(), order.end());
    require(std::adjacent_find(order.begin(), order.end()) == order.end(), group,
            "leaf_order names a shape twice");
    const auto finite = [](double x) { return std::isfinite(x); };
    require(std::all_of(record.distances.begin(), record.distances.end(), finite) &&
                std::all_of(record.merge_height.begin(), record.merge_height.end(), finite),
            group, "a distance or a height is not finite");
    require(all_below(record.leaf_order, count) && all_below(record.cluster, std::max<hsize_t>(count, 1)),
            group, "leaf_order or cluster names what is not there");
    std::vector<std::uint8_t> joined(count + merges, 0);
    for (std::size_t k = 0; k < merges; ++k)
        for (const std::int32_t cluster : {record.merge_first[k], record.merge_second[k]}) {
            require(all_below({cluster}, count + k), group, "a merge joins what is not there yet");
            require(joined[static_cast<std::size_t>(cluster)]++ == 0, group, "a merge joins a cluster again");
        }
    return record;
}

}  // namespace

std::vector<DistanceRecord> schema::read_distances(hid_t root) {
    std::vector<DistanceRecord> records;
    const Handle group = hdf5::open_group(root, "distances");
    for (const std::string& type : hdf5::link_names(group)) records.push_back(read_record(group, type));
    return records;
}

DistanceFile read_distance_file(const std::string& path) {
    const hdf5::Session session;
    DistanceFile file;
    schema::read_whole_file(path, "distances", [&](hid_t root) {
        file.info = schema::read_run_info(root);
        file.records = schema::read_distances(root);
    });
    return file;
}

void write_distance_file(const std::string& path, const RunInfo& info,
                         const std::vector<DistanceRecord>& records) {
    schema::write_whole_file(path, info, "distances", [&](hid_t root) {
        const Handle group = hdf5::create_group(root, "distances");
        for (const DistanceRecord& record : records) write_record(group, record);
    });
}

void write_distance_csv(const std::string& path, const DistanceRecord& record) {
    std::string text = "shape";
    for (const std::string& name : record.shapes) text += "," + csv_field(name);
    text += "\n";
    const std::size_t count = record.shapes.size();
    for (std::size_t i = 0; i < count; ++i) {
        text += csv_field(record.shapes[i]);
        for (std::size_t j = 0; j < count; ++j) text += fmt::format(",{}", record.distances[i * count + j]);
        text += "\n";
    }
    write_text_durably(path, text);
}

}  // namespace ricci
