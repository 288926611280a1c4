// The files of the shards of one run, read and checked as a set.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/store/shard_table.h"

namespace ricci {

/// One file.
struct Shard {
    std::string path;
    RunInfo info;
    ShardTable table;
    std::vector<FailureRecord> failures;
    std::map<std::string, ItemSource> stored;  // items with a mesh

    [[nodiscard]] std::string name() const { return shard_name(table.index, table.count); }
};

/// Reads what the files say of themselves; ascending by index. Throws ShardError naming all that is
/// unfinished, damaged, missing, given twice or of another run, and rows that a shard's table promises but
/// its file does not hold.
std::vector<Shard> read_shard_set(const std::vector<std::string>& paths);

}  // namespace ricci
