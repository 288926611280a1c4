#include "io/store/run_state.h"

#include <fmt/format.h>

#include <cmath>

#include "io/store/schema.h"

namespace ricci {
namespace {

void read_sweep(hid_t group, const std::string& item, const std::string& recorded, const StatusNames& status,
                ItemState& state) {
    const hdf5::Handle sweep = hdf5::open_group(group, "sweep");
    for (const SweepRow& row : schema::read_rows(sweep, status)) state.rows.emplace(row.vertex, row);
    const auto add = [&](Index vertex, const std::string& dataset, std::optional<hsize_t> row) {
        const auto found = state.rows.find(vertex);
        if (found == state.rows.end())
            throw FileError(dataset + ": conformal factor of a vertex without a row");
        state.factors.emplace(vertex,
                              FactorSource{vertex, found->second.area_distortion, recorded, dataset, row});
    };
    const std::string path = item_path(item) + "/sweep/";
    for (const char* name : {"best", "worst"})
        if (const auto vertex = schema::read_extreme_vertex(sweep, name))
            add(*vertex, path + name + "/conformal_factor", std::nullopt);
    state.sweep_files.push_back(recorded);
    if (!hdf5::has_link(sweep, "kept")) return;
    const auto kept = hdf5::read_array<Index>(hdf5::open_group(sweep, "kept"), "vertex", std::nullopt);
    for (std::size_t i = 0; i < kept.size(); ++i) add(kept[i], path + "kept/conformal_factor", i);
}

void merge_rows(ItemState& known, ItemState& part) {
    for (const auto& [vertex, row] : part.rows) {
        const auto [there, added] = known.rows.emplace(vertex, row);
        if (!added && replaceable(there->second)) there->second = row;
    }
    known.factors.merge(part.factors);
}

}  // namespace

std::string item_path(const std::string& item) {
    return "/items/" + item;
}

ItemState read_item_state(hid_t items, const std::string& name, const std::string& recorded,
                          const StatusNames& status) {
    const hdf5::Handle group = hdf5::open_group(items, name);
    ItemState item;
    if (hdf5::has_link(group, "mesh")) {
        const ItemRecord record = schema::read_item(group, name);
        item.vertex_count = schema::vertex_slots(record);
        item.file = recorded;
        item.source = {record.source, record.source_hash};
    }
    if (hdf5::has_link(group, "sweep")) read_sweep(group, name, recorded, status, item);
    if (hdf5::has_link(group, "flow")) item.flow_file = recorded;
    for (const std::string& kind : schema::result_kinds(group)) item.result_files.emplace(kind, recorded);
    return item;
}

RunState read_contents(const std::string& path, const std::string& recorded, const StatusNames& status) {
    RunState state;
    const hdf5::Handle file = hdf5::open_input(path);
    const hdf5::Handle items = hdf5::open_group(file, "items");
    for (const std::string& name : hdf5::link_names(items))
        state.items.emplace(name, read_item_state(items, name, recorded, status));
    if (hdf5::has_link(file, "failures"))
        for (FailureRecord& failure : schema::read_failures(file))
            state.failures.emplace(std::pair(failure.item, failure.stage), failure);
    return state;
}

// A converged row has a finite area distortion (require_valid); any other has none.
bool replaceable(const SweepRow& row) {
    return !std::isfinite(row.area_distortion);
}

void merge_contents(RunState& state, RunState part) {
    for (auto& [name, item] : part.items) {
        ItemState& known = state.items[name];
        if (known.file.empty()) {
            known.file = item.file;
            known.vertex_count = item.vertex_count;
            known.source = item.source;
        }
        if (known.flow_file.empty()) known.flow_file = item.flow_file;
        known.result_files.merge(item.result_files);
        known.sweep_files.insert(known.sweep_files.end(), item.sweep_files.begin(), item.sweep_files.end());
        if (known.rows_at_hand) merge_rows(known, item);
    }
    state.failures.merge(part.failures);
}

void release_rows(ItemState& item) {
    item.rows.clear();
    item.factors.clear();
    item.rows_at_hand = false;
}

void recall_rows(ItemState& item, const std::string& name, const StatusNames& status) {
    if (item.rows_at_hand) return;
    for (const std::string& path : item.sweep_files) {
        ItemState part;
        const hdf5::Handle file = hdf5::open_input(path);
        read_sweep(hdf5::open_group(file, item_path(name)), name, path, status, part);
        merge_rows(item, part);
    }
    item.rows_at_hand = true;
}

void require_rows_of_vertices(const RunState& state, const std::string& where) {
    for (const auto& [name, item] : state.items) {
        if (item.rows.empty() || item.file.empty()) continue;
        const Index lowest = item.rows.begin()->first, highest = item.rows.rbegin()->first;
        if (lowest < 0 || static_cast<std::size_t>(highest) >= item.vertex_count)
            throw FileError(fmt::format("{}: item {} has rows from vertex {} to {}, but {} vertices", where,
                                        name, lowest, highest, item.vertex_count));
    }
}

std::vector<double> read_factor(const FactorSource& source, std::size_t vertex_count) {
    const hdf5::Handle file = hdf5::open_input(source.file);
    if (!source.row) return hdf5::read_array<double>(file, source.dataset, hdf5::Shape{vertex_count});
    std::vector<double> row = hdf5::Input(file, source.dataset).read_row(*source.row);
    if (row.size() != vertex_count)
        throw FileError(
            fmt::format("{}: rows of {} values, expected {}", source.dataset, row.size(), vertex_count));
    return row;
}

}  // namespace ricci
