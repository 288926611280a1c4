#include "io/store/path_file.h"

#include <fmt/format.h>

#include <cmath>

#include "io/store/csv_text.h"
#include "io/store/durable.h"
#include "io/store/schema.h"
#include "io/store/schema_shapes.h"
#include "io/store/whole_file.h"

namespace ricci {
namespace {

using hdf5::Handle;

std::string cell(double value) {
    return std::isnan(value) ? std::string() : fmt::format("{}", value);
}

void write_matrix(hid_t group, const char* name, const std::vector<double>& values, hsize_t rows) {
    hdf5::write_array(group, name, std::span<const double>(values),
                      {rows, rows > 0 ? values.size() / rows : 0});
}

void write_record(hid_t parent, const std::string& name, const PathRecord& record) {
    const Handle group = hdf5::create_group(parent, name);
    hdf5::write_text_attribute(group, "type", record.type);
    hdf5::seal(group);
    hdf5::write_text_list(group, "name", record.names);
    hdf5::write_text_list(group, "file", record.files);
    hdf5::write_text_list(group, "marking", record.marking);
    hdf5::write_text_list(group, "message", record.message);
    hdf5::write_array(group, "status", record.status);
    hdf5::write_array(group, "marking_number", record.marking_number);
    write_matrix(group, "coordinates", record.coordinates, record.files.size());
    write_matrix(group, "fingerprint", record.fingerprint, record.files.size());
    hdf5::write_array(group, "step", record.step);
    hdf5::write_array(group, "free_step", record.free_step);
    hdf5::write_array(group, "length", record.length);
    hdf5::write_array(group, "marking_gap", record.marking_gap);
    hdf5::write_array(group, "marking_spread", record.marking_spread);
}

/// The row of frame i.
std::string csv_row(std::size_t sequence, std::size_t i, const PathRecord& r,
                    const StatusNames& status_names) {
    std::string row = fmt::format("{},{},{},{},{},{},{},{},{},{},{}", sequence, i, csv_field(r.files[i]),
                                  status_names.names.at(r.status[i]), r.marking[i], r.marking_number[i],
                                  cell(r.marking_gap[i]), cell(r.marking_spread[i]), cell(r.step[i]),
                                  cell(r.free_step[i]), cell(r.length[i]));
    for (std::size_t k = 0; k < r.names.size(); ++k) row += "," + cell(r.coordinates[i * r.names.size() + k]);
    return row + "," + csv_field(r.message[i]) + "\n";
}

std::vector<double> read_matrix(hid_t group, const char* name, hsize_t rows) {
    const hdf5::Input input(group, name);
    input.expect_type(hdf5::stored_type<double>());
    if (input.shape().size() != 2 || input.shape()[0] != rows)
        throw FileError(fmt::format("{} is not a matrix of {} rows", input.name(), rows));
    std::vector<double> values(input.size());
    input.read_into(hdf5::stored_type<double>(), values.data());
    return values;
}

PathRecord read_record(hid_t parent, const std::string& name) {
    const Handle group = hdf5::open_group(parent, name);
    PathRecord record;
    record.type = hdf5::read_text_attribute(group, "type");
    record.names = hdf5::read_text_list(group, "name");
    record.files = hdf5::read_text_list(group, "file");
    const hsize_t frames = record.files.size();
    const hdf5::Shape each{frames};
    record.marking = hdf5::read_text_list(group, "marking", frames);
    record.message = hdf5::read_text_list(group, "message", frames);
    record.status = hdf5::read_array<std::uint8_t>(group, "status", each);
    record.marking_number = hdf5::read_array<std::int32_t>(group, "marking_number", each);
    record.coordinates = read_matrix(group, "coordinates", frames);
    if (record.coordinates.size() != frames * record.names.size())
        throw FileError(hdf5::name_of(group) + ": not one coordinate for each name");
    record.fingerprint = read_matrix(group, "fingerprint", frames);
    record.step = hdf5::read_array<double>(group, "step", each);
    record.free_step = hdf5::read_array<double>(group, "free_step", each);
    record.length = hdf5::read_array<double>(group, "length", each);
    record.marking_gap = hdf5::read_array<double>(group, "marking_gap", each);
    record.marking_spread = hdf5::read_array<double>(group, "marking_spread", each);
    return record;
}

}  // namespace

std::vector<PathRecord> schema::read_paths(hid_t root) {
    std::vector<PathRecord> records;
    const Handle group = hdf5::open_group(root, "paths");
    const std::size_t sequences = hdf5::link_names(group).size();
    for (std::size_t k = 1; k <= sequences; ++k) records.push_back(read_record(group, fmt::format("{}", k)));
    return records;
}

PathFile read_path_file(const std::string& path) {
    const hdf5::Session session;
    PathFile file;
    schema::read_whole_file(path, "paths", [&](hid_t root) {
        file.info = schema::read_run_info(root);
        file.records = schema::read_paths(root);
    });
    return file;
}

void write_path_file(const std::string& path, const RunInfo& info, const std::vector<PathRecord>& records) {
    schema::write_whole_file(path, info, "paths", [&](hid_t root) {
        const Handle group = hdf5::create_group(root, "paths");
        for (std::size_t k = 0; k < records.size(); ++k)
            write_record(group, fmt::format("{}", k + 1), records[k]);
    });
}

void write_path_csv(const std::string& path, const StatusNames& status_names,
                    const std::vector<PathRecord>& records) {
    std::string text =
        "sequence,frame,file,status,marking,marking_number,marking_gap,marking_spread,step,free_step,length";
    if (!records.empty())
        for (const std::string& name : records.front().names) text += "," + csv_field(name);
    text += ",message\n";
    for (std::size_t s = 0; s < records.size(); ++s)
        for (std::size_t i = 0; i < records[s].files.size(); ++i)
            text += csv_row(s + 1, i, records[s], status_names);
    write_text_durably(path, text);
}

}  // namespace ricci
