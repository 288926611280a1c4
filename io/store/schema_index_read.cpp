// Reading an index file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "io/store/schema.h"
#include "io/store/schema_index.h"

namespace ricci::schema {
namespace {

using hdf5::Handle;
using hdf5::Shape;
using Type = std::array<Index, 2>;

constexpr const char* kBuckets = "buckets";

// A matrix with so many rows; its columns tell `width`.
std::vector<double> read_matrix(hid_t group, const char* name, std::size_t rows, std::size_t& width) {
    const hdf5::Input input(group, name);
    input.expect_type(hdf5::stored_type<double>());
    if (input.shape().size() != 2 || input.shape()[0] != rows)
        throw FileError(fmt::format("{} is not a matrix of {} rows", input.name(), rows));
    width = input.shape()[1];
    std::vector<double> values(rows * width);
    input.read_into(hdf5::stored_type<double>(), values.data());
    return values;
}

std::vector<double> row_of(const std::vector<double>& matrix, std::size_t width, std::size_t row) {
    const auto begin = matrix.begin() + static_cast<std::ptrdiff_t>(row * width);
    return {begin, begin + static_cast<std::ptrdiff_t>(width)};
}

// The row, or nothing where it is NaN throughout.
std::vector<double> known_row_of(const std::vector<double>& matrix, std::size_t width, std::size_t row) {
    std::vector<double> values = row_of(matrix, width, row);
    const bool missing =
        std::all_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
    return missing ? std::vector<double>() : values;
}

// Offsets from 0, ascending, up to `total`.
std::vector<std::int64_t> read_offsets(hid_t group, const char* name, std::size_t rows, std::size_t total) {
    std::vector<std::int64_t> first = hdf5::read_array<std::int64_t>(group, name, Shape{rows + 1});
    if (first.front() != 0 || first.back() != static_cast<std::int64_t>(total) ||
        !std::is_sorted(first.begin(), first.end()))
        throw FileError(fmt::format("{}/{} does not divide its values", hdf5::name_of(group), name));
    return first;
}

template <class Value, class Set>
void read_column(hid_t group, const char* name, std::vector<IndexEntry>& entries, Set&& set) {
    const std::vector<Value> values = hdf5::read_array<Value>(group, name, Shape{entries.size()});
    for (std::size_t i = 0; i < entries.size(); ++i) set(entries[i].shape, values[i]);
}

void read_accuracy(hid_t group, std::vector<IndexEntry>& entries) {
    if (!hdf5::has_link(group, "precision_digits")) {
        for (IndexEntry& entry : entries) {
            entry.shape.residual_max = entry.shape.gauss_bonnet_error =
                std::numeric_limits<double>::quiet_NaN();
            entry.shape.precision_digits = 0;
        }
        return;
    }
    read_column<double>(group, "residual_max", entries, [](ShapeRecord& s, double v) { s.residual_max = v; });
    read_column<double>(group, "gauss_bonnet_error", entries,
                        [](ShapeRecord& s, double v) { s.gauss_bonnet_error = v; });
    read_column<std::int32_t>(group, "precision_digits", entries,
                              [](ShapeRecord& s, std::int32_t v) { s.precision_digits = v; });
}

void read_lengths(hid_t group, std::vector<IndexEntry>& entries) {
    const auto lengths = hdf5::read_array<double>(group, "lengths", std::nullopt);
    const auto primitive = hdf5::read_array<std::uint8_t>(group, "primitive", Shape{lengths.size()});
    const auto first = read_offsets(group, "lengths_first", entries.size(), lengths.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        entries[i].shape.lengths.assign(lengths.begin() + first[i], lengths.begin() + first[i + 1]);
        entries[i].shape.primitive.assign(primitive.begin() + first[i], primitive.begin() + first[i + 1]);
    }
}

void read_resolutions(hid_t bucket, std::size_t width, std::size_t coordinates,
                      std::vector<IndexEntry>& entries) {
    if (!hdf5::has_link(bucket, "resolutions")) return;
    const Handle group = hdf5::open_group(bucket, "resolutions");
    const auto faces = hdf5::read_array<std::int32_t>(group, "faces", std::nullopt);
    const auto first = read_offsets(group, "first", entries.size(), faces.size());
    const auto fingerprints = hdf5::read_array<double>(group, "fingerprint", Shape{faces.size(), width});
    const auto values = hdf5::read_array<double>(group, "coordinates", Shape{faces.size(), coordinates});
    hdf5::read_array<double>(group, "fingerprint_spread", Shape{entries.size(), width});
    hdf5::read_array<double>(group, "coordinates_spread", Shape{entries.size(), coordinates});
    for (std::size_t i = 0; i < entries.size(); ++i)
        for (auto r = static_cast<std::size_t>(first[i]); r < static_cast<std::size_t>(first[i + 1]); ++r)
            entries[i].shape.resolutions.push_back(
                {faces[r], row_of(fingerprints, width, r), known_row_of(values, coordinates, r)});
}

void read_details(hid_t group, const IndexBucket& bucket, const StatusNames& status,
                  std::vector<IndexEntry>& entries) {
    const std::size_t count = bucket.files.size();
    const hdf5::Input states(group, "status");
    const Handle type = status_type(status);
    states.expect_type(type);
    states.expect_shape({count});
    std::vector<std::uint8_t> values(count);
    states.read_into(type, values.data());
    const std::vector<std::string> messages = hdf5::read_text_list(group, "message", count);
    const std::vector<double> seconds = hdf5::read_array<double>(group, "seconds", Shape{count, 4});
    for (std::size_t i = 0; i < count; ++i) {
        ShapeRecord& shape = entries[i].shape;
        shape.status = values[i];
        shape.message = messages[i];
        shape.fingerprint = row_of(bucket.fingerprint, bucket.fingerprint_size, i);
        shape.coordinates = known_row_of(bucket.coordinates, bucket.coordinate_count, i);
        if (!shape.coordinates.empty()) shape.names = bucket.names;
        std::copy_n(seconds.begin() + static_cast<std::ptrdiff_t>(4 * i), 4, shape.seconds.begin());
    }
    read_column<std::int32_t>(group, "vertices", entries, [](ShapeRecord& s, Index v) { s.vertices = v; });
    read_column<std::int32_t>(group, "faces", entries, [](ShapeRecord& s, Index v) { s.faces = v; });
    read_column<double>(group, "complete_up_to", entries,
                        [](ShapeRecord& s, double v) { s.complete_up_to = v; });
    read_column<double>(group, "marking_gap", entries, [](ShapeRecord& s, double v) { s.marking_gap = v; });
    read_accuracy(group, entries);
    read_lengths(group, entries);
    read_resolutions(group, bucket.fingerprint_size, bucket.coordinate_count, entries);
}

// All entries of a type, each with its place in the index.
void read_rows(hid_t root, const Type& type, const StatusNames& status,
               std::vector<std::pair<std::int32_t, IndexEntry>>& all) {
    const IndexBucket bucket = read_bucket(root, type[0], type[1]);
    const Handle group = hdf5::open_group(hdf5::open_group(root, kBuckets), type_name(type[0], type[1]));
    const std::size_t count = bucket.files.size();
    std::vector<IndexEntry> entries(count);
    for (std::size_t i = 0; i < count; ++i) {
        entries[i].file = bucket.files[i];
        ShapeRecord& shape = entries[i].shape;
        shape.genus = type[0];
        shape.boundaries = type[1];
        shape.hash = bucket.hash[i];
        shape.component = bucket.component[i];
        shape.components = bucket.components[i];
    }
    read_details(group, bucket, status, entries);
    const auto order = hdf5::read_array<std::int32_t>(group, "order", Shape{count});
    for (std::size_t i = 0; i < count; ++i) all.emplace_back(order[i], std::move(entries[i]));
}

}  // namespace

std::vector<Type> read_types(hid_t root) {
    const Handle buckets = hdf5::open_group(root, kBuckets);
    std::vector<Type> types;
    for (const std::string& name : hdf5::link_names(buckets)) {
        const Handle group = hdf5::open_group(buckets, name);
        const Type type{hdf5::read_attribute<std::int32_t>(group, "genus"),
                        hdf5::read_attribute<std::int32_t>(group, "boundaries")};
        if (name != type_name(type[0], type[1]))
            throw FileError(hdf5::name_of(group) + ": the name is not that of its topological type");
        types.push_back(type);
    }
    std::sort(types.begin(), types.end());
    return types;
}

IndexBucket read_bucket(hid_t root, Index genus, Index boundaries) {
    const Handle group = hdf5::open_group(hdf5::open_group(root, kBuckets), type_name(genus, boundaries));
    IndexBucket bucket;
    bucket.genus = genus;
    bucket.boundaries = boundaries;
    bucket.files = hdf5::read_text_list(group, "file", std::nullopt);
    const std::size_t count = bucket.files.size();
    bucket.component = hdf5::read_array<std::int32_t>(group, "component", Shape{count});
    bucket.components = hdf5::read_array<std::int32_t>(group, "components", Shape{count});
    bucket.hash = hdf5::read_array<std::uint64_t>(group, "hash", Shape{count});
    bucket.fingerprint = read_matrix(group, "fingerprint", count, bucket.fingerprint_size);
    bucket.coordinates = read_matrix(group, "coordinates", count, bucket.coordinate_count);
    bucket.names = hdf5::read_texts_attribute(group, "names");
    if (bucket.names.size() != bucket.coordinate_count)
        throw FileError(hdf5::name_of(group) + ": not one name per coordinate");
    return bucket;
}

std::vector<IndexEntry> read_entries(hid_t root, const StatusNames& status) {
    std::vector<std::pair<std::int32_t, IndexEntry>> all;
    for (const Type& type : read_types(root)) read_rows(root, type, status, all);
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<IndexEntry> entries;
    entries.reserve(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].first != static_cast<std::int32_t>(i))
            throw FileError("the column order of the buckets does not number the shapes");
        entries.push_back(std::move(all[i].second));
    }
    return entries;
}

}  // namespace ricci::schema
