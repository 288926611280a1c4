// The layout of the group /shard (docs/hdf5.md, "Shards"). Callers hold an hdf5::Session.
#pragma once

#include <optional>

#include "io/store/hdf5_file.h"
#include "io/store/shard_table.h"

namespace ricci::schema {

/// Writes the group `shard` below the root.
void write_shard(hid_t root, const ShardTable& table);

/// The same read back; nothing when the file is none of several. Throws FileError.
std::optional<ShardTable> read_shard(hid_t root);

}  // namespace ricci::schema
