#include "io/store/schema_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>

#include "io/store/schema.h"

namespace ricci::schema {
namespace {

using hdf5::Handle;
using Type = std::array<Index, 2>;

constexpr const char* kBuckets = "buckets";

// Entries of one type, with their places in the index.
struct Rows {
    std::vector<std::int32_t> order;
    std::vector<const IndexEntry*> entries;

    template <class Value, class Of>
    void column(hid_t group, const char* name, Of&& of) const {
        std::vector<Value> values;
        values.reserve(entries.size());
        for (const IndexEntry* entry : entries) values.push_back(of(*entry));
        hdf5::write_array(group, name, values);
    }

    // A matrix of `width` columns; rows that are empty become NaN.
    template <class Of>
    void matrix(hid_t group, const char* name, std::size_t width, Of&& of) const {
        std::vector<double> values;
        values.reserve(entries.size() * width);
        for (const IndexEntry* entry : entries) {
            const std::vector<double>& row = of(*entry);
            if (row.empty())
                values.insert(values.end(), width, std::numeric_limits<double>::quiet_NaN());
            else
                values.insert(values.end(), row.begin(), row.end());
        }
        hdf5::write_array(group, name, std::span<const double>(values), {entries.size(), width});
    }

    template <class Of>
    void texts(hid_t group, const char* name, Of&& of) const {
        std::vector<std::string> values;
        values.reserve(entries.size());
        for (const IndexEntry* entry : entries) values.push_back(of(*entry));
        hdf5::write_text_list(group, name, values);
    }
};

// Names of the coordinates: of the first entry that has any.
std::vector<std::string> names_of(const Rows& rows) {
    for (const IndexEntry* entry : rows.entries)
        if (!entry->shape.names.empty()) return entry->shape.names;
    return {};
}

void write_lengths(hid_t group, const Rows& rows) {
    std::vector<double> lengths;
    std::vector<std::uint8_t> primitive;
    std::vector<std::int64_t> first{0};
    for (const IndexEntry* entry : rows.entries) {
        const ShapeRecord& shape = entry->shape;
        lengths.insert(lengths.end(), shape.lengths.begin(), shape.lengths.end());
        primitive.insert(primitive.end(), shape.primitive.begin(), shape.primitive.end());
        first.push_back(static_cast<std::int64_t>(lengths.size()));
    }
    hdf5::write_array(group, "lengths", lengths);
    hdf5::write_array(group, "primitive", primitive);
    hdf5::write_array(group, "lengths_first", first);
}

// |x_r - x| at its largest over the resolutions; one value per entry of the vector.
std::vector<double> spread_of(const ShapeRecord& shape, const std::vector<double>& finest,
                              std::vector<double> ShapeResolution::*of) {
    std::vector<double> spread(finest.size(), 0.0);
    for (const ShapeResolution& resolution : shape.resolutions) {
        const std::vector<double>& other = resolution.*of;
        for (std::size_t k = 0; k < spread.size(); ++k)
            spread[k] = other.empty() ? std::numeric_limits<double>::quiet_NaN()
                                      : std::max(spread[k], std::abs(other[k] - finest[k]));
    }
    return spread;
}

// What the shapes look like at other resolutions, ragged: rows resolution_first[i] to resolution_first[i+1]
// belong to shape i. Only where there are any.
void write_resolutions(hid_t group, const Rows& rows, std::size_t width, std::size_t coordinates) {
    std::vector<std::int64_t> first{0};
    std::vector<std::int32_t> faces;
    std::vector<double> fingerprints, values;
    for (const IndexEntry* entry : rows.entries) {
        for (const ShapeResolution& r : entry->shape.resolutions) {
            faces.push_back(r.faces);
            fingerprints.insert(fingerprints.end(), r.fingerprint.begin(), r.fingerprint.end());
            if (r.coordinates.empty())
                values.insert(values.end(), coordinates, std::numeric_limits<double>::quiet_NaN());
            else
                values.insert(values.end(), r.coordinates.begin(), r.coordinates.end());
        }
        first.push_back(static_cast<std::int64_t>(faces.size()));
    }
    if (faces.empty()) return;
    const Handle below = hdf5::create_group(group, "resolutions");
    hdf5::write_array(below, "first", first);
    hdf5::write_array(below, "faces", faces);
    hdf5::write_array(below, "fingerprint", std::span<const double>(fingerprints), {faces.size(), width});
    hdf5::write_array(below, "coordinates", std::span<const double>(values), {faces.size(), coordinates});
    // Error bars beside the entries.
    std::vector<std::vector<double>> spreads;
    for (const IndexEntry* e : rows.entries)
        spreads.push_back(spread_of(e->shape, e->shape.fingerprint, &ShapeResolution::fingerprint));
    std::size_t next = 0;
    const auto take = [&](const IndexEntry&) -> const std::vector<double>& { return spreads[next++]; };
    rows.matrix(below, "fingerprint_spread", width, take);
    spreads.clear();
    next = 0;
    for (const IndexEntry* e : rows.entries)
        spreads.push_back(spread_of(e->shape, e->shape.coordinates, &ShapeResolution::coordinates));
    rows.matrix(below, "coordinates_spread", coordinates, take);
}

void write_bucket(hid_t buckets, const Type& type, const Rows& rows, const StatusNames& status) {
    const Handle group = hdf5::create_group(buckets, type_name(type[0], type[1]));
    const std::vector<std::string> names = names_of(rows);
    const std::size_t width = rows.entries.front()->shape.fingerprint.size();
    hdf5::write_attribute<std::int32_t>(group, "genus", type[0]);
    hdf5::write_attribute<std::int32_t>(group, "boundaries", type[1]);
    hdf5::write_texts_attribute(group, "names", names);
    hdf5::seal(group);
    hdf5::write_array(group, "order", rows.order);
    rows.texts(group, "file", [](const IndexEntry& e) { return e.file; });
    rows.column<std::uint64_t>(group, "hash", [](const IndexEntry& e) { return e.shape.hash; });
    rows.column<std::int32_t>(group, "component", [](const IndexEntry& e) { return e.shape.component; });
    rows.column<std::int32_t>(group, "components", [](const IndexEntry& e) { return e.shape.components; });
    rows.column<std::int32_t>(group, "vertices", [](const IndexEntry& e) { return e.shape.vertices; });
    rows.column<std::int32_t>(group, "faces", [](const IndexEntry& e) { return e.shape.faces; });
    std::vector<std::uint8_t> states;
    for (const IndexEntry* entry : rows.entries) states.push_back(entry->shape.status);
    hdf5::write_values(group, "status", status_type(status), {states.size()},
                       std::as_bytes(std::span<const std::uint8_t>(states)));
    rows.texts(group, "message", [](const IndexEntry& e) { return e.shape.message; });
    rows.matrix(group, "fingerprint", width,
                [](const IndexEntry& e) -> const std::vector<double>& { return e.shape.fingerprint; });
    rows.matrix(group, "coordinates", names.size(),
                [](const IndexEntry& e) -> const std::vector<double>& { return e.shape.coordinates; });
    write_lengths(group, rows);
    rows.column<double>(group, "complete_up_to", [](const IndexEntry& e) { return e.shape.complete_up_to; });
    rows.column<double>(group, "marking_gap", [](const IndexEntry& e) { return e.shape.marking_gap; });
    rows.column<double>(group, "residual_max", [](const IndexEntry& e) { return e.shape.residual_max; });
    rows.column<double>(group, "gauss_bonnet_error",
                        [](const IndexEntry& e) { return e.shape.gauss_bonnet_error; });
    rows.column<std::int32_t>(group, "precision_digits",
                              [](const IndexEntry& e) { return e.shape.precision_digits; });
    std::vector<double> seconds;
    for (const IndexEntry* e : rows.entries)
        seconds.insert(seconds.end(), e->shape.seconds.begin(), e->shape.seconds.end());
    hdf5::write_array(group, "seconds", std::span<const double>(seconds), {rows.entries.size(), 4});
    write_resolutions(group, rows, width, names.size());
}

[[noreturn]] void refuse(const IndexEntry& entry, const char* what) {
    throw std::invalid_argument(fmt::format("index entry {}: {}", entry.file, what));
}

void require_valid(const IndexEntry& entry, const StatusNames& status) {
    const ShapeRecord& shape = entry.shape;
    if (shape.status >= status.names.size()) refuse(entry, "the status has no name");
    if (shape.component < 0 || shape.component >= shape.components) refuse(entry, "no such component");
    if (shape.genus < 0 || shape.boundaries < 0) refuse(entry, "no such topological type");
    if (shape.fingerprint.empty() || !std::all_of(shape.fingerprint.begin(), shape.fingerprint.end(),
                                                  [](double v) { return std::isfinite(v); }))
        refuse(entry, "the fingerprint is empty or not finite");
    if (shape.names.size() != shape.coordinates.size())
        refuse(entry, "the coordinates and their names differ in number");
    if (shape.primitive.size() != shape.lengths.size())
        refuse(entry, "lengths and their primitive flags differ in number");
    for (const ShapeResolution& r : shape.resolutions) {
        if (r.fingerprint.size() != shape.fingerprint.size())
            refuse(entry, "a resolution's fingerprint has another size");
        if (!r.coordinates.empty() && r.coordinates.size() != shape.coordinates.size())
            refuse(entry, "a resolution has another number of coordinates");
    }
}

}  // namespace

void write_index_info(hid_t root, const RunInfo& info, std::int32_t descriptor_version,
                      const std::string& created) {
    hdf5::write_text_attribute(root, "kind", "index");
    hdf5::write_attribute<std::int32_t>(root, "descriptor_version", descriptor_version);
    write_run_info(root, info, created);
}

std::string read_kind(hid_t root) {
    const std::vector<std::string> names = hdf5::attribute_names(root);
    const bool there = std::find(names.begin(), names.end(), "kind") != names.end();
    return there ? hdf5::read_text_attribute(root, "kind") : "";
}

std::int32_t read_descriptor_version(hid_t root) {
    return hdf5::read_attribute<std::int32_t>(root, "descriptor_version");
}

void require_valid(const std::vector<IndexEntry>& entries, const StatusNames& status) {
    std::map<Type, const IndexEntry*> first, first_named;
    for (const IndexEntry& entry : entries) {
        require_valid(entry, status);
        const Type type{entry.shape.genus, entry.shape.boundaries};
        if (first.emplace(type, &entry).first->second->shape.fingerprint.size() !=
            entry.shape.fingerprint.size())
            refuse(entry, "the fingerprint's size differs from that of others of its topological type");
        if (entry.shape.names.empty()) continue;
        if (first_named.emplace(type, &entry).first->second->shape.names != entry.shape.names)
            refuse(entry, "the names of coordinates differ from those of others of its topological type");
    }
}

void write_entries(hid_t root, const std::vector<IndexEntry>& entries, const StatusNames& status) {
    std::map<Type, Rows> types;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        Rows& rows = types[{entries[i].shape.genus, entries[i].shape.boundaries}];
        rows.order.push_back(static_cast<std::int32_t>(i));
        rows.entries.push_back(&entries[i]);
    }
    const Handle buckets = hdf5::create_group(root, kBuckets);
    for (const auto& [type, rows] : types) write_bucket(buckets, type, rows, status);
}

}  // namespace ricci::schema
