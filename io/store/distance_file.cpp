#include "io/store/distance_file.h"

#include <fmt/format.h>

#include "io/store/durable.h"
#include "io/store/schema.h"

namespace ricci {
namespace {

using hdf5::Handle;

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
    return result + "\"";
}

void write_texts(hid_t group, const char* name, const std::vector<std::string>& texts) {
    std::vector<std::string> stored;
    stored.reserve(texts.size());
    for (const std::string& text : texts) stored.push_back(hdf5::stored_text(text));
    std::vector<const char*> pointers;
    pointers.reserve(stored.size());
    for (const std::string& text : stored) pointers.push_back(text.c_str());
    hdf5::write_texts(group, name, hdf5::text_type(), {stored.size()}, pointers);
}

void write_record(hid_t parent, const DistanceRecord& record) {
    const Handle group = hdf5::create_group(parent, record.type);
    hdf5::write_text_attribute(group, "metric", record.metric);
    hdf5::write_text_attribute(group, "linkage", record.linkage);
    hdf5::seal(group);
    const hsize_t count = record.shapes.size();
    write_texts(group, "shape", record.shapes);
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
    const std::string temporary = path + ".tmp";
    {
        const hdf5::Session session;
        hdf5::write_file(temporary, [&](hdf5::OutputFile& file) {
            hdf5::write_text_attribute(file.root(), "kind", "distances");
            schema::write_run_info(file.root(), info, schema::now());
            const Handle group = hdf5::create_group(file.root(), "distances");
            for (const DistanceRecord& record : records) write_record(group, record);
            file.flush();
            hdf5::write_attribute<std::int32_t>(file.root(), "complete", 1);
        });
    }
    rename_durably(temporary, path);
}

void write_distance_csv(const std::string& path, const DistanceRecord& record) {
    std::string text = "shape";
    for (const std::string& name : record.shapes) text += "," + quoted(name);
    text += "\n";
    const std::size_t count = record.shapes.size();
    for (std::size_t i = 0; i < count; ++i) {
        text += quoted(record.shapes[i]);
        for (std::size_t j = 0; j < count; ++j) text += fmt::format(",{}", record.distances[i * count + j]);
        text += "\n";
    }
    write_text_durably(path, text);
}

}  // namespace ricci
