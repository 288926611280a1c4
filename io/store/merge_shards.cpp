#include "io/store/merge_shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "io/store/assemble.h"
#include "io/store/schema.h"
#include "io/store/segment_folder.h"
#include "io/store/shard_set.h"

namespace ricci {
namespace {

/// A shard's part of an item.
struct Piece {
    const Shard* shard = nullptr;
    const ShardItem* item = nullptr;

    [[nodiscard]] bool stored() const { return shard->stored.contains(item->name); }
};

/// Input, component, resolution: the order of the items of a whole run.
using Place = std::array<std::int32_t, 3>;

/// An item of the whole run.
struct WholeItem {
    std::string name;
    std::vector<Piece> pieces;  // ascending by shard

    [[nodiscard]] bool stored() const {
        return std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.stored(); });
    }
    /// Some shard gave up on it, and says so among its failures.
    [[nodiscard]] bool given_up() const {
        return std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.item->own < 0; });
    }
};

std::map<Place, WholeItem> whole_items(const std::vector<Shard>& shards) {
    std::map<Place, WholeItem> items;
    for (const Shard& shard : shards)
        for (const ShardItem& item : shard.table.items)
            items[{item.input, item.component, item.resolution}].pieces.push_back({&shard, &item});
    std::map<std::string, int> uses;
    for (auto& [place, item] : items) {
        const std::string& base = item.pieces.front().item->base;
        const int use = ++uses[base];
        item.name = use == 1 ? base : fmt::format("{}~{}", base, use);
    }
    return items;
}

/// The shards agree about an item, and together have each chosen vertex once.
void check_item(const WholeItem& item, std::vector<std::string>& complaints) {
    const ShardItem& first = *item.pieces.front().item;
    std::int64_t own = 0;
    for (const Piece& piece : item.pieces) {
        own += piece.item->own;
        const bool same = piece.item->base == first.base && piece.item->chosen == first.chosen &&
                          piece.item->chosen_xxh3 == first.chosen_xxh3;
        if (same) continue;
        complaints.push_back(fmt::format("{}: shards {} and {} found different surfaces or vertices",
                                         item.name, item.pieces.front().shard->name(), piece.shard->name()));
        return;
    }
    if (item.given_up() || own == first.chosen) return;
    std::string holders;
    for (const Piece& piece : item.pieces) holders += (holders.empty() ? "" : ", ") + piece.shard->name();
    complaints.push_back(fmt::format("{}: {} of its {} chosen vertices are in shards {}", item.name, own,
                                     first.chosen, holders));
}

/// Every input is there, with all resolutions of all its components, or as one that could not be read.
void check_inputs(const std::map<Place, WholeItem>& items, const ShardTable& table,
                  std::vector<std::string>& complaints) {
    std::map<std::int32_t, std::pair<bool, std::set<std::pair<std::int32_t, std::int32_t>>>> found;
    for (const auto& [place, item] : items) {
        auto& [unreadable, places] = found[place[0]];
        if (place[1] < 0)
            unreadable = true;
        else
            places.emplace(place[1], place[2]);
    }
    for (std::int32_t input = 0; input < table.inputs; ++input) {
        const auto at = found.find(input);
        if (at == found.end()) {
            complaints.push_back(fmt::format("input {} is in no shard", input));
            continue;
        }
        const auto& [unreadable, places] = at->second;
        const std::string& name = items.lower_bound({input, -1, -1})->second.name;
        if (unreadable && !places.empty())
            complaints.push_back(fmt::format("{}: some shards could read this input, others not", name));
        const std::int32_t components = places.empty() ? 0 : places.rbegin()->first + 1;
        if (places.size() !=
            static_cast<std::size_t>(components) * static_cast<std::size_t>(table.resolutions))
            complaints.push_back(
                fmt::format("{}: a component or resolution of this input is in no shard", name));
    }
}

/// Checksums of an item's attributes and mesh.
std::vector<std::pair<std::string, std::uint64_t>> mesh_digests(hid_t group) {
    std::vector<std::pair<std::string, std::uint64_t>> digests{
        {"", hdf5::read_attribute<std::uint64_t>(group, "attributes_xxh3")}};
    const hdf5::Handle mesh = hdf5::open_group(group, "mesh");
    for (const std::string& name : hdf5::link_names(mesh))
        digests.emplace_back(name, hdf5::read_attribute<std::uint64_t>(hdf5::Input(mesh, name).id(), "xxh3"));
    std::sort(digests.begin(), digests.end());
    return digests;
}

/// What all shards together hold of an item. Throws ShardError when its parts do not fit together.
ItemState join(const WholeItem& item) {
    ItemState whole;
    std::vector<std::pair<std::string, std::uint64_t>> mesh;
    for (const Piece& piece : item.pieces) {
        if (!piece.stored()) continue;
        const hdf5::Handle file = hdf5::open_input(piece.shard->path);
        const hdf5::Handle items = hdf5::open_group(file, "items");
        const std::string& stored_name = piece.item->name;
        auto digests = mesh_digests(hdf5::open_group(items, stored_name));
        ItemState part = read_item_state(items, stored_name, piece.shard->path, piece.shard->info.status);
        if (whole.file.empty()) {
            mesh = std::move(digests);
            whole.file = part.file;
            whole.group = item_path(stored_name);
            whole.vertex_count = part.vertex_count;
        } else if (digests != mesh) {
            throw ShardError({fmt::format("{}: shards {} and {} hold different meshes", item.name,
                                          item.pieces.front().shard->name(), piece.shard->name())});
        }
        whole.rows.merge(part.rows);
        whole.factors.merge(part.factors);
        if (!part.rows.empty())
            throw ShardError({fmt::format("{}: vertex {} is in shard {} and in another one", item.name,
                                          part.rows.begin()->first, piece.shard->name())});
    }
    if (item.given_up()) return whole;
    std::vector<Index> vertices;
    for (const auto& [vertex, row] : whole.rows) vertices.push_back(vertex);
    if (digest_of_vertices(vertices) != item.pieces.front().item->chosen_xxh3)
        throw ShardError({item.name + ": the rows of all shards are not those of the chosen vertices"});
    return whole;
}

/// Failures by the names of the whole run, each once.
std::vector<FailureRecord> joined_failures(const std::vector<Shard>& shards,
                                           const std::map<Place, WholeItem>& items) {
    std::map<std::pair<const Shard*, std::string>, const std::string*> names;
    for (const auto& [place, item] : items)
        for (const Piece& piece : item.pieces) names[{piece.shard, piece.item->name}] = &item.name;
    std::map<std::pair<std::string, std::string>, FailureRecord> failures;
    for (const Shard& shard : shards)
        for (FailureRecord failure : shard.failures) {
            const auto name = names.find({&shard, failure.item});
            if (name == names.end())
                throw ShardError({fmt::format("shard {} ({}): a failure of {}, which is not in its table",
                                              shard.name(), shard.path, failure.item)});
            failure.item = *name->second;
            failures.emplace(std::pair(failure.item, failure.stage), failure);
        }
    std::vector<FailureRecord> joined;
    for (auto& [key, failure] : failures) joined.push_back(std::move(failure));
    return joined;
}

RunInfo whole_info(const std::vector<Shard>& shards, const RunInfo& merger) {
    RunInfo info = shards.front().info;
    info.command = merger.command;
    info.host = merger.host;
    info.config = shards.front().table.config;
    info.fingerprint = shards.front().table.fingerprint;
    for (const Shard& shard : shards) info.threads = std::max(info.threads, shard.info.threads);
    return info;
}

void count_rows(const ItemState& state, std::optional<std::uint8_t> converged, MergedRun& merged) {
    merged.rows += state.rows.size();
    for (const auto& [vertex, row] : state.rows) merged.failed_rows += row.status == converged ? 0 : 1;
}

}  // namespace

MergedRun merge_shards(const std::vector<std::string>& paths, const std::string& output,
                       const RunInfo& merger) {
    const std::vector<Shard> shards = read_shard_set(paths);
    const ShardTable& table = shards.front().table;
    const std::map<Place, WholeItem> items = whole_items(shards);
    std::vector<std::string> complaints;
    check_inputs(items, table, complaints);
    for (const auto& [place, item] : items) check_item(item, complaints);
    if (!complaints.empty()) throw ShardError(std::move(complaints));

    MergedRun merged;
    merged.shards = shards.size();
    const RunInfo info = whole_info(shards, merger);
    const auto converged = schema::converged_status(info.status);
    std::map<std::string, const WholeItem*> by_name;
    ItemState current;
    ResultSource source;
    for (const auto& [place, item] : items) {
        by_name.emplace(item.name, &item);
        if (item.stored()) source.items.push_back(item.name);
    }
    source.failures = joined_failures(shards, items);
    source.state = [&](const std::string& name) -> const ItemState& {
        current = join(*by_name.at(name));
        count_rows(current, converged, merged);
        return current;
    };
    merged.items = source.items.size();
    merged.failures = source.failures.size();

    const SegmentFolder folder(output);
    if (folder.has_journal())
        throw ShardError(
            {folder.folder() + " holds an unfinished run; finish it with --resume, or remove it"});
    folder.replace_output(
        [&](const std::string& temporary) { write_result_file(temporary, info, source, table.keep); });
    return merged;
}

}  // namespace ricci
