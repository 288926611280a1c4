// What the result file of one of several machines says of itself, so that the files can be joined.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/store/run_store.h"

namespace ricci {

/// An item that a shard had a part of, or an input of it that gave none.
struct ShardItem {
    std::string name;        // in this file: its group and its failures
    std::string base;        // the same without ~2, ~3, which depend on what else the file holds
    std::int32_t input = 0;  // number of the input file in the whole run
    std::int32_t component = -1, resolution = -1;  // its place in the input; -1: the input could not be read
    std::int32_t chosen = -1, own = -1;  // vertices chosen, and this shard's; -1: failed before they were
    std::uint64_t chosen_xxh3 = 0;       // XXH3-64 of the chosen vertices, ascending, as i4
    std::uint8_t stored = 0;  // its mesh is in this file; else `name` is only that of a failure, and may be
                              // the name of another file's item as well
};

/// The group `shard` of a result file.
struct ShardTable {
    std::int32_t index = 0, count = 1;         // i/N
    std::int32_t inputs = 0, resolutions = 1;  // of the whole run
    std::string plan;                          // digest of who does what, equal in all shards
    std::string config, fingerprint;           // RunInfo's, of the whole run
    std::string processors;                    // RunInfo::processor of all starts, "; " between them
    KeepPolicy keep;
    std::vector<ShardItem> items;  // in the order of the whole run
};

/// "3/8".
std::string shard_name(std::int32_t index, std::int32_t count);

/// XXH3-64 of vertex numbers as i4.
std::uint64_t digest_of_vertices(const std::vector<Index>& vertices);

}  // namespace ricci
