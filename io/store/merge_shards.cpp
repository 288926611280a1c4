#include "io/store/merge_shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
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

    [[nodiscard]] bool stored() const { return item->stored != 0; }
    /// Its vertices were chosen: the shard did not fail before.
    [[nodiscard]] bool chosen() const { return item->chosen >= 0; }
};

/// "0/3, 2/3".
std::string shards_of(const std::vector<Piece>& pieces) {
    std::string names;
    for (const Piece& piece : pieces) names += (names.empty() ? "" : ", ") + piece.shard->name();
    return names;
}

/// Input, component, resolution: the order of the items of a whole run.
using Place = std::array<std::int32_t, 3>;

/// An item of the whole run.
struct WholeItem {
    std::string name;
    std::vector<Piece> pieces;  // ascending by shard

    [[nodiscard]] bool stored() const { return first_stored() != nullptr; }
    /// Null: none.
    [[nodiscard]] const Piece* first_stored() const {
        const auto found =
            std::find_if(pieces.begin(), pieces.end(), [](const Piece& p) { return p.stored(); });
        return found == pieces.end() ? nullptr : &*found;
    }
    [[nodiscard]] const Piece* first_chosen() const {
        const auto found =
            std::find_if(pieces.begin(), pieces.end(), [](const Piece& p) { return p.chosen(); });
        return found == pieces.end() ? nullptr : &*found;
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
    // What failed before it was stored takes no item's name.
    std::map<std::string, int> uses;
    for (auto& [place, item] : items) {
        const Piece* stored = item.first_stored();
        item.name = stored != nullptr ? stored->item->base : item.pieces.front().item->name;
        if (stored == nullptr) continue;
        if (const int use = ++uses[item.name]; use > 1) item.name += fmt::format("~{}", use);
    }
    return items;
}

/// All shards read the same bytes of an input, as far as anything of it is stored.
void check_sources(const std::map<Place, WholeItem>& items, std::vector<std::string>& complaints) {
    std::map<std::int32_t, Piece> first;
    std::set<std::int32_t> differing;
    for (const auto& [place, item] : items)
        for (const Piece& piece : item.pieces) {
            if (!piece.stored()) continue;
            const auto [known, is_new] = first.emplace(place[0], piece);
            const ItemSource &a = known->second.shard->stored.at(known->second.item->name),
                             &b = piece.shard->stored.at(piece.item->name);
            if (is_new || a.source_hash == b.source_hash || !differing.insert(place[0]).second) continue;
            complaints.push_back(
                fmt::format("{}: shards {} and {} read different contents of this file; remove what the "
                            "outdated one has made, and run it again",
                            b.source, known->second.shard->name(), piece.shard->name()));
        }
}

/// The shards agree about an item, and together have each chosen vertex once.
void check_item(const WholeItem& item, std::vector<std::string>& complaints) {
    std::int64_t own = 0;
    const Piece *surface = item.first_stored(), *choice = item.first_chosen();
    for (const Piece& piece : item.pieces) {
        own += piece.item->own;
        // A shard that failed before it knew says nothing.
        const bool same_surface = !piece.stored() || piece.item->base == surface->item->base;
        const bool same_choice = !piece.chosen() || (piece.item->chosen == choice->item->chosen &&
                                                     piece.item->chosen_xxh3 == choice->item->chosen_xxh3);
        if (same_surface && same_choice) continue;
        complaints.push_back(fmt::format("{}: shards {} and {} found different surfaces or vertices",
                                         item.name, (same_surface ? choice : surface)->shard->name(),
                                         piece.shard->name()));
        return;
    }
    const std::int64_t chosen = choice != nullptr ? choice->item->chosen : 0;
    if (item.given_up() || own == chosen) return;
    complaints.push_back(fmt::format("{}: {} of its {} chosen vertices are in shards {}", item.name, own,
                                     chosen, shards_of(item.pieces)));
}

/// Every input is there, with all resolutions of all its components, or as one that could not be read.
void check_inputs(const std::map<Place, WholeItem>& items, const ShardTable& table,
                  std::vector<std::string>& complaints) {
    struct Found {
        std::string unreadable;  // by these shards
        std::set<std::pair<std::int32_t, std::int32_t>> places;
    };
    std::map<std::int32_t, Found> found;
    for (const auto& [place, item] : items) {
        if (place[1] < 0)
            found[place[0]].unreadable = shards_of(item.pieces);
        else
            found[place[0]].places.emplace(place[1], place[2]);
    }
    std::int32_t next = 0;
    const auto missing = [&](std::int32_t end) {  // in one line: a file may claim any number of inputs
        if (end - next == 1) complaints.push_back(fmt::format("input {} is in no shard", next));
        if (end - next > 1)
            complaints.push_back(fmt::format("inputs {} to {} are in no shard", next, end - 1));
    };
    for (const auto& [input, what] : found) {
        missing(input);
        next = input + 1;
        const auto& [unreadable, places] = what;
        const std::string& name = items.lower_bound({input, -1, -1})->second.name;
        if (!unreadable.empty() && !places.empty())
            complaints.push_back(
                fmt::format("{}: shards {} could not read this input, others could: run those again with "
                            "--retry-failed",
                            name, unreadable));
        const std::size_t components =
            places.empty() ? 0 : static_cast<std::size_t>(places.rbegin()->first) + 1;
        if (places.size() != components * static_cast<std::size_t>(table.resolutions))
            complaints.push_back(
                fmt::format("{}: a component or resolution of this input is in no shard", name));
    }
    missing(table.inputs);
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
                                          item.first_stored()->shard->name(), piece.shard->name())});
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
    const Piece* choice = item.first_chosen();
    if (choice == nullptr || digest_of_vertices(vertices) != choice->item->chosen_xxh3)
        throw ShardError({item.name + ": the rows of all shards are not those of the chosen vertices"});
    return whole;
}

/// Of a file or of a resolution that gave no item: recorded under a name that is the same in all shards.
bool before_any_item(const FailureRecord& failure) {
    return failure.stage == "load" || failure.stage == "resample";
}

/// Failures by the names of the whole run, each once.
std::vector<FailureRecord> joined_failures(const std::vector<Shard>& shards,
                                           const std::map<Place, WholeItem>& items) {
    std::map<std::pair<const Shard*, std::string>, const std::string*> names;
    for (const auto& [place, item] : items)
        for (const Piece& piece : item.pieces)
            if (piece.stored()) names[{piece.shard, piece.item->name}] = &item.name;
    std::map<std::pair<std::string, std::string>, FailureRecord> failures;
    for (const Shard& shard : shards)
        for (FailureRecord failure : shard.failures) {
            if (!before_any_item(failure)) {
                const auto name = names.find({&shard, failure.item});
                if (name == names.end())
                    throw ShardError({fmt::format("shard {} ({}): a failure of {}, which is not in its table",
                                                  shard.name(), shard.path, failure.item)});
                failure.item = *name->second;
            }
            failures.emplace(std::pair(failure.item, failure.stage), failure);
        }
    std::vector<FailureRecord> joined;
    joined.reserve(failures.size());
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

/// Kinds of processors, and the shards that ran on them; empty where all ran on one.
std::vector<std::string> processor_warnings(const std::vector<Shard>& shards) {
    std::map<std::string, std::string> kinds;
    for (const Shard& shard : shards) {
        if (shard.stored.empty()) continue;  // it computed nothing
        std::string& names = kinds[shard.table.processors];
        names += (names.empty() ? "" : ", ") + shard.name();
    }
    if (kinds.size() < 2 && (kinds.empty() || kinds.begin()->first.find("; ") == std::string::npos))
        return {};
    std::string text;
    for (const auto& [kind, names] : kinds)
        text +=
            fmt::format("{}{} (shards {})", text.empty() ? "" : ", ", kind.empty() ? "unknown" : kind, names);
    return {"not all on one kind of processor: " + text +
            ". Results agree to the tolerance, but not to the last bit"};
}

/// Items that some shards gave up on and others finished.
std::vector<std::string> gap_warnings(const std::map<Place, WholeItem>& items) {
    std::vector<std::string> warnings;
    for (const auto& [place, item] : items) {
        std::vector<Piece> missing;
        std::copy_if(item.pieces.begin(), item.pieces.end(), std::back_inserter(missing),
                     [](const Piece& piece) { return piece.item->own < 0; });
        if (missing.empty() || missing.size() == item.pieces.size()) continue;
        warnings.push_back(
            fmt::format("{}: without the rows of shards {}, which gave up on it (see /failures): run those "
                        "again with --retry-failed, then merge again",
                        item.name, shards_of(missing)));
    }
    return warnings;
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
    check_sources(items, complaints);
    if (!complaints.empty()) throw ShardError(std::move(complaints));  // all else would follow from that
    check_inputs(items, table, complaints);
    for (const auto& [place, item] : items) check_item(item, complaints);
    if (!complaints.empty()) throw ShardError(std::move(complaints));

    MergedRun merged;
    merged.shards = shards.size();
    merged.warnings = gap_warnings(items);
    for (std::string& warning : processor_warnings(shards)) merged.warnings.push_back(std::move(warning));
    const RunInfo info = whole_info(shards, merger);
    const auto converged = schema::converged_status(info.status);
    std::map<std::string, const WholeItem*> by_name;
    ItemState current;
    ResultSource source;
    for (const auto& [place, item] : items) {
        if (!item.stored()) continue;
        by_name.emplace(item.name, &item);
        source.items.push_back(item.name);
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
