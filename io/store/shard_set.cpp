#include "io/store/shard_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "io/store/hdf5_file.h"
#include "io/store/merge_shards.h"
#include "io/store/schema.h"
#include "io/store/schema_shard.h"
#include "io/store/verify_file.h"

namespace ricci {
namespace {

namespace fs = std::filesystem;
using Complaints = std::vector<std::string>;

std::optional<Shard> read_shard_file(const std::string& path, Complaints& complaints) {
    if (!fs::exists(path)) {
        complaints.push_back(
            fs::exists(path + ".parts")
                ? fmt::format("{}: unfinished; {}.parts holds what there is: run that shard with "
                              "--resume",
                              path, path)
                : path + ": no such file");
        return std::nullopt;
    }
    if (const std::vector<std::string> defects = verify_result_file(path); !defects.empty()) {
        complaints.push_back("not a sound result file: " + defects.front());
        return std::nullopt;
    }
    const hdf5::Session session;
    const hdf5::Handle file = hdf5::open_input(path);
    Shard shard{path, schema::read_run_info(file), {}, {}, {}};
    std::optional<ShardTable> table = schema::read_shard(file);
    if (!table) {
        complaints.push_back(path + ": not made with --shard, so there is nothing to join it with");
        return std::nullopt;
    }
    shard.table = std::move(*table);
    shard.failures = schema::read_failures(file);
    const hdf5::Handle items = hdf5::open_group(file, "items");
    for (const std::string& name : hdf5::link_names(items)) {
        const hdf5::Handle item = hdf5::open_group(items, name);
        shard.stored[name] = {hdf5::read_text_attribute(item, "source"),
                              hdf5::read_text_attribute(item, "source_hash")};
    }
    return shard;
}

/// What differs between shards that cannot belong to one run; empty when nothing does.
std::string difference(const Shard& a, const Shard& b) {
    if (a.table.count != b.table.count) return "the number of shards";
    if (a.table.fingerprint != b.table.fingerprint) return "the configuration";
    if (a.info.software_version != b.info.software_version || a.info.git != b.info.git)
        return fmt::format("the version of the program ({} {} and {} {})", a.info.software_version,
                           a.info.git, b.info.software_version, b.info.git);
    if (a.info.status.names != b.info.status.names) return "the status names";
    if (a.table.plan != b.table.plan || a.table.inputs != b.table.inputs)
        return "the plan of who does what, so the input files were not the same for both";
    return {};
}

/// All shards of one run, each once.
void check_set(const std::vector<Shard>& shards, Complaints& complaints) {
    bool alike = true;
    for (const Shard& shard : shards)
        if (const std::string what = difference(shards.front(), shard); !what.empty()) {
            alike = false;
            complaints.push_back(
                fmt::format("{} and {} differ in {}", shards.front().path, shard.path, what));
        }
    if (!alike) return;
    std::map<std::int32_t, const Shard*> by_index;
    for (const Shard& shard : shards) {
        const auto [known, is_new] = by_index.emplace(shard.table.index, &shard);
        if (!is_new)
            complaints.push_back(fmt::format("shard {} comes twice: {} and {}", shard.name(),
                                             known->second->path, shard.path));
    }
    // Runs of numbers: a file may claim to be one of two thousand million.
    const std::int32_t count = shards.front().table.count;
    std::int32_t next = 0;
    const auto missing = [&](std::int32_t end) {
        if (end - next == 1) complaints.push_back("missing shard " + shard_name(next, count));
        if (end - next > 1)
            complaints.push_back(
                fmt::format("missing shards {} to {}", shard_name(next, count), shard_name(end - 1, count)));
    };
    for (const auto& [index, shard] : by_index) {
        missing(index);
        next = index + 1;
    }
    missing(count);
}

/// Rows of an item in a file; 0 without a sweep.
std::size_t stored_rows(hid_t items, const std::string& name) {
    const hdf5::Handle group = hdf5::open_group(items, name);
    if (!hdf5::has_link(group, "sweep")) return 0;
    return hdf5::Input(hdf5::open_group(group, "sweep"), "vertex").size();
}

/// Each shard holds what its own table promises.
void check_rows(const std::vector<Shard>& shards, Complaints& complaints) {
    const hdf5::Session session;
    for (const Shard& shard : shards) {
        const hdf5::Handle file = hdf5::open_input(shard.path);
        const hdf5::Handle items = hdf5::open_group(file, "items");
        const auto complain = [&](const std::string& what) {
            complaints.push_back(fmt::format("shard {} ({}): {}", shard.name(), shard.path, what));
        };
        std::set<std::string> known;
        for (const ShardItem& item : shard.table.items) {
            const bool stored = item.stored != 0;
            if (stored && !known.insert(item.name).second) complain(item.name + " is twice in its table");
            if (stored && !shard.stored.contains(item.name)) {
                complain(item.name + " is in its table, its mesh nowhere");
                continue;
            }
            if (item.own < 0) continue;
            const std::size_t rows = stored ? stored_rows(items, item.name) : 0;
            if (rows != static_cast<std::size_t>(item.own))
                complain(fmt::format("{} has {} rows, not {}", item.name, rows, item.own));
        }
        for (const auto& [name, source] : shard.stored)
            if (!known.contains(name)) complain(name + " is not in its table");
    }
}

}  // namespace

std::vector<Shard> read_shard_set(const std::vector<std::string>& paths) {
    Complaints complaints;
    std::vector<Shard> shards;
    for (const std::string& path : paths)
        if (auto shard = read_shard_file(path, complaints)) shards.push_back(std::move(*shard));
    std::sort(shards.begin(), shards.end(),
              [](const Shard& a, const Shard& b) { return a.table.index < b.table.index; });
    if (!shards.empty()) check_set(shards, complaints);
    if (complaints.empty()) check_rows(shards, complaints);
    if (shards.empty() && complaints.empty()) complaints.emplace_back("no shard is given");
    if (!complaints.empty()) throw ShardError(std::move(complaints));
    return shards;
}

}  // namespace ricci
