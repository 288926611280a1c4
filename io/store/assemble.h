// Writing the final file from segments.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/store/run_state.h"
#include "io/store/run_store.h"
#include "io/store/shard_table.h"

namespace ricci {

/// What a result file is made of, item by item, so that no more than one of them need be in memory.
struct ResultSource {
    std::vector<std::string> items;                             // in the order of the file
    std::function<const ItemState&(const std::string&)> state;  // of an item; may be gone at the next call
    std::vector<FailureRecord> failures;                        // any order
    const ShardTable* shard = nullptr;                          // where the file is one of several
};

/// Writes the result file whole, durably, with `complete` = 1. Callers hold an hdf5::Session. Throws
/// FileError, and std::invalid_argument as RunStore::assemble does.
void write_result_file(const std::string& path, const RunInfo& info, const ResultSource& source,
                       const KeepPolicy& keep);

/// The same of a run's state.
void write_result_file(const std::string& path, const RunInfo& info, const RunState& state,
                       const std::vector<std::string>& items, const KeepPolicy& keep,
                       const ShardTable* shard);

}  // namespace ricci
