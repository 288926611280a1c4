// What a sweep knows of its items while it runs, and what it says of them at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/flow/status.h"
#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"
#include "io/store/shard_table.h"

namespace ricci::app {

/// A mesh file of a sweep, or a mesh in memory that came from one. Its name is the file's stem, with ~2, ~3
/// for further files of the same stem, in the order of the input: failures of the file as a whole go by it.
struct SweepSource {
    std::string file, name;
    std::shared_ptr<const LoadedMesh> loaded{};  // null: to be read from the file

    [[nodiscard]] std::string stem() const;
    /// "", "~2", ...
    [[nodiscard]] std::string suffix() const;
};
std::vector<SweepSource> sweep_sources(const std::vector<std::string>& files);
/// The same where some are in memory: gives all of them their names.
void name_sources(std::vector<SweepSource>& sources);

/// File name without folder, .gz and the format's suffix.
std::string stem_of(const std::string& file);

/// An item, or a file that gave none.
struct SweepItem {
    std::string name;
    bool stored = false;
    std::size_t vertices = 0;  // asked for
    Status status = Status::converged;
    std::string message;
    double seconds = 0.0;
    ShardItem place{};  // in the whole run
};

/// Vertices of an item that are asked for.
struct ChosenVertices {
    std::int32_t all = 0;           // in the whole run
    std::uint64_t all_xxh3 = 0;     // digest_of_vertices
    std::size_t own = 0, left = 0;  // of this machine; of those, still to be solved

    void put_into(SweepItem& item) const {
        item.vertices = own;
        item.place.chosen = all;
        item.place.chosen_xxh3 = all_xxh3;
    }
};

/// One line of the table and of the JSON output.
struct ItemSummary {
    std::string name;
    Status status = Status::converged;  // of the item as a whole
    std::string message;
    std::size_t vertices = 0, solved = 0, failed = 0;  // of those asked for
    std::optional<SweepRow> best, worst;
    double seconds = 0.0;
};

/// Rows are read from the store, which may be null.
std::vector<ItemSummary> summaries_of(const std::vector<SweepItem>& items, const RunStore* store);
/// Names of the items with a mesh in the store.
std::vector<std::string> stored_names(const std::vector<SweepItem>& items);
/// The same with the items that an earlier start of the run stored and this one could not read again, each
/// before the items of later files. `files`: the whole input.
std::vector<std::string> stored_names(const std::vector<SweepItem>& items,
                                      const std::vector<std::string>& files, const RunStore& store);

}  // namespace ricci::app
