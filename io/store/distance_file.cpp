#include "io/store/distance_file.h"

#include <fmt/format.h>

#include "io/store/csv_text.h"
#include "io/store/durable.h"
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

}  // namespace

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
