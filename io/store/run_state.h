// What is known to be finished of a run, and where it lies: the index over segments and result files.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/store/hdf5_file.h"
#include "io/store/run_store.h"

namespace ricci {

/// Where a conformal factor lies: a whole dataset, or a row of one.
struct FactorSource {
    Index vertex = 0;
    double area_distortion = 0.0;
    std::string file, dataset;
    std::optional<hsize_t> row;
};

/// What is finished of one item. Conformal factors and meshes stay on disk.
struct ItemState {
    std::string file;                                 // holds the item's mesh; empty: not stored
    ItemSource source;                                // of that mesh
    std::string group;                                // of the item in its files; empty: by its name
    std::string flow_file;                            // holds its flow; empty: none
    std::map<std::string, std::string> result_files;  // kind of a further result: the file that holds it
    std::size_t vertex_count = 0;                     // V, once the mesh is stored
    std::vector<std::string> sweep_files;  // hold its rows; a later one replaces failed rows of earlier ones
    bool rows_at_hand = true;              // false: rows and factors are in the files only
    std::map<Index, SweepRow> rows;
    std::map<Index, FactorSource> factors;
};

/// What is finished of a run.
struct RunState {
    std::set<std::string> processors;  // of all starts
    std::map<std::string, ItemState> items;
    std::map<std::pair<std::string, std::string>, FailureRecord> failures;  // by item and stage
};

/// Reads what the group `items` of a file holds of an item; sources get the file name `recorded`. Callers
/// hold an hdf5::Session. Throws FileError.
ItemState read_item_state(hid_t items, const std::string& name, const std::string& recorded,
                          const StatusNames& status);

/// The same of all that a segment or result file holds.
RunState read_contents(const std::string& path, const std::string& recorded, const StatusNames& status);

/// Whether a row stands for a solve that failed: another for the same vertex replaces it.
bool replaceable(const SweepRow& row);

/// Adds what is new in `part`; what is there already stays, but for rows that are replaceable.
void merge_contents(RunState& state, RunState part);

/// Forgets rows and factors, which stay in the item's files; and reads them again where they were forgotten.
/// Callers of the latter hold an hdf5::Session. It throws FileError.
void release_rows(ItemState& item);
void recall_rows(ItemState& item, const std::string& name, const StatusNames& status);

/// Throws FileError, naming `where`, when a row of an item belongs to none of its vertices
/// (as far as its mesh is stored).
void require_rows_of_vertices(const RunState& state, const std::string& where);

/// Reads one conformal factor of V values. Throws FileError.
std::vector<double> read_factor(const FactorSource& source, std::size_t vertex_count);

/// Group of an item within a file.
std::string item_path(const std::string& item);

}  // namespace ricci
