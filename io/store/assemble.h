// Writing the final file from segments.
#pragma once

#include <string>
#include <vector>

#include "io/store/run_state.h"
#include "io/store/run_store.h"

namespace ricci {

/// Writes the result file whole, durably, with `complete` = 1, in the order of `items`. Callers hold an
/// hdf5::Session. Throws FileError, and std::invalid_argument as RunStore::assemble does.
void write_result_file(const std::string& path, const RunInfo& info, const RunState& state,
                       const std::vector<std::string>& items, const KeepPolicy& keep);

}  // namespace ricci
