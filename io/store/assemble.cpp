#include "io/store/assemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

#include "io/store/schema.h"
#include "io/store/schema_shard.h"

namespace ricci {
namespace {

using hdf5::Handle;

struct Choice {
    const SweepRow* best = nullptr;
    const SweepRow* worst = nullptr;
    std::vector<const SweepRow*> kept;
};

// Over converged rows; `rows` ascends by vertex, so that strict comparison leaves ties to the lowest one.
Choice choose_extremes(const std::map<Index, SweepRow>& rows, std::uint8_t converged) {
    Choice choice;
    for (const auto& [vertex, row] : rows) {
        if (row.status != converged) continue;
        if (choice.best == nullptr || row.area_distortion < choice.best->area_distortion) choice.best = &row;
        if (choice.worst == nullptr || row.area_distortion > choice.worst->area_distortion)
            choice.worst = &row;
    }
    return choice;
}

Choice choose(const ItemState& item, const KeepPolicy& keep, std::uint8_t converged) {
    Choice choice = choose_extremes(item.rows, converged);
    if (!keep.best) choice.best = nullptr;
    if (!keep.worst) choice.worst = nullptr;
    if (keep.count == 0) return choice;
    for (const auto& [vertex, row] : item.rows)
        if (row.status == converged && &row != choice.best && &row != choice.worst &&
            (keep.count > 0 || item.factors.contains(vertex)))
            choice.kept.push_back(&row);
    std::stable_sort(choice.kept.begin(), choice.kept.end(), [](const SweepRow* a, const SweepRow* b) {
        return a->area_distortion < b->area_distortion;
    });
    if (keep.count > 0 && choice.kept.size() > static_cast<std::size_t>(keep.count))
        choice.kept.resize(static_cast<std::size_t>(keep.count));
    return choice;
}

const FactorSource& source_of(const ItemState& item, const std::string& name, Index vertex) {
    const auto found = item.factors.find(vertex);
    if (found == item.factors.end())
        throw std::invalid_argument(fmt::format(
            "item {}: the conformal factor of vertex {} is to be kept but is no candidate", name, vertex));
    return found->second;
}

void write_kept(hid_t sweep, hdf5::OutputFile& file, const std::string& name, const ItemState& item,
                const std::vector<const SweepRow*>& kept) {
    const Handle group = hdf5::create_group(sweep, "kept");
    std::vector<Index> vertices;
    vertices.reserve(kept.size());
    for (const SweepRow* row : kept) vertices.push_back(row->vertex);
    hdf5::write_array(group, "vertex", vertices);
    hdf5::RowWriter writer(group, "conformal_factor", kept.size(), item.vertex_count);
    for (const Index vertex : vertices) {
        writer.append(read_factor(source_of(item, name, vertex), item.vertex_count));
        file.check_writes();
    }
    writer.finish();
}

void write_sweep(hid_t group, hdf5::OutputFile& file, const std::string& name, const ItemState& item,
                 const KeepPolicy& keep, const StatusNames& status) {
    const Handle sweep = hdf5::create_group(group, "sweep");
    hdf5::write_attribute<std::uint8_t>(sweep, "keep_best", static_cast<std::uint8_t>(keep.best));
    hdf5::write_attribute<std::uint8_t>(sweep, "keep_worst", static_cast<std::uint8_t>(keep.worst));
    hdf5::write_attribute<std::int64_t>(sweep, "keep_count", keep.count);
    hdf5::seal(sweep);
    std::vector<SweepRow> rows;
    rows.reserve(item.rows.size());
    for (const auto& [vertex, row] : item.rows) rows.push_back(row);
    schema::write_rows(sweep, rows, status);
    const auto converged = schema::converged_status(status);
    if (!converged) return;
    const Choice choice = choose(item, keep, *converged);
    const auto write_one = [&](const char* where, const SweepRow* row) {
        if (row == nullptr) return;
        schema::write_extreme(sweep, where,
                              {row->vertex, row->area_distortion,
                               read_factor(source_of(item, name, row->vertex), item.vertex_count)});
    };
    write_one("best", choice.best);
    write_one("worst", choice.worst);
    if (!choice.kept.empty()) write_kept(sweep, file, name, item, choice.kept);
}

void write_item(hid_t items, hdf5::OutputFile& file, const std::string& name, const ItemState& item,
                const KeepPolicy& keep, const StatusNames& status) {
    const Handle group = hdf5::create_group(items, name);
    const std::string stored_at = item.group.empty() ? item_path(name) : item.group;
    {
        const Handle source = hdf5::open_input(item.file);
        schema::write_item(group, schema::read_item(hdf5::open_group(source, stored_at), name));
    }
    if (!item.rows.empty()) write_sweep(group, file, name, item, keep, status);
    if (!item.flow_file.empty()) {
        const Handle source = hdf5::open_input(item.flow_file);
        const Handle stored = hdf5::open_group(source, stored_at + "/flow");
        schema::write_flow(hdf5::create_group(group, "flow"),
                           schema::read_flow(stored, name, item.vertex_count, status), status);
    }
    for (const auto& [kind, path] : item.result_files) {
        const Handle source = hdf5::open_input(path);
        const Handle stored = hdf5::open_group(source, stored_at + "/" + kind);
        schema::write_result(hdf5::create_group(group, kind), schema::read_result(stored, name, kind, status),
                             status);
    }
    file.check_writes();
}

// In the order of the items, then of names: independent of who failed first.
std::vector<FailureRecord> ordered(std::vector<FailureRecord> failures,
                                   const std::vector<std::string>& items) {
    std::map<std::string, std::size_t> places;
    for (const std::string& item : items) places.emplace(item, places.size());
    const auto place = [&](const FailureRecord& failure) {
        const auto found = places.find(failure.item);
        return found == places.end() ? places.size() : found->second;
    };
    std::stable_sort(failures.begin(), failures.end(), [&](const FailureRecord& a, const FailureRecord& b) {
        const std::size_t x = place(a), y = place(b);
        return x != y ? x < y : std::tie(a.item, a.stage) < std::tie(b.item, b.stage);
    });
    return failures;
}

void require_all_items(const RunState& state, const std::vector<std::string>& items) {
    const std::set<std::string> named(items.begin(), items.end());
    if (named.size() != items.size()) throw std::invalid_argument("an item is to be assembled twice");
    for (const std::string& name : items) {
        const auto found = state.items.find(name);
        if (found == state.items.end() || found->second.file.empty())
            throw std::invalid_argument("item " + name + " is to be assembled but is not stored");
    }
    for (const auto& [name, item] : state.items)
        if (!item.file.empty() && !named.contains(name))
            throw std::invalid_argument("item " + name + " is stored but not to be assembled");
}

}  // namespace

void write_result_file(const std::string& path, const RunInfo& info, const ResultSource& source,
                       const KeepPolicy& keep) {
    hdf5::write_file(path, [&](hdf5::OutputFile& file) {
        schema::write_run_info(file.root(), info, schema::now());
        const Handle group = hdf5::create_group(file.root(), "items");
        for (const std::string& name : source.items)
            write_item(group, file, name, source.state(name), keep, info.status);
        schema::write_failures(file.root(), ordered(source.failures, source.items));
        if (source.shard != nullptr) schema::write_shard(file.root(), *source.shard);
        file.flush();
        hdf5::write_attribute<std::int32_t>(file.root(), "complete", 1);
    });
}

void write_result_file(const std::string& path, const RunInfo& info, const RunState& state,
                       const std::vector<std::string>& items, const KeepPolicy& keep,
                       const ShardTable* shard) {
    require_all_items(state, items);
    std::vector<FailureRecord> failures;
    for (const auto& [key, failure] : state.failures) failures.push_back(failure);
    ItemState at_hand;
    const auto state_of = [&](const std::string& name) -> const ItemState& {
        at_hand = state.items.at(name);
        recall_rows(at_hand, name, info.status);
        return at_hand;
    };
    write_result_file(path, info, {items, state_of, std::move(failures), shard}, keep);
}

}  // namespace ricci
