// The layout of an index file, in one place (docs/hdf5.md, "Index"). Segments of an index under way hold the
// same groups. Callers hold an hdf5::Session.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "io/store/hdf5_file.h"
#include "io/store/shape_index.h"

namespace ricci::schema {

/// Root attributes `kind` = "index" and `descriptor_version`, then those of any file but `complete`.
void write_index_info(hid_t root, const RunInfo& info, std::int32_t descriptor_version,
                      const std::string& created);
/// The file's kind: "index", or "" for results.
std::string read_kind(hid_t root);
std::int32_t read_descriptor_version(hid_t root);

/// Throws std::invalid_argument naming the entry when sizes or values do not fit together: within a record,
/// or among the records of one topological type.
void require_valid(const std::vector<IndexEntry>& entries, const StatusNames& status);

/// The group buckets/ with all entries, types ascending.
void write_entries(hid_t root, const std::vector<IndexEntry>& entries, const StatusNames& status);
/// The same read back, in the order in which they were given. Throws FileError.
std::vector<IndexEntry> read_entries(hid_t root, const StatusNames& status);

/// Types in buckets/, ascending, and what queries need of one. Throw FileError.
std::vector<std::array<Index, 2>> read_types(hid_t root);
IndexBucket read_bucket(hid_t root, Index genus, Index boundaries);

}  // namespace ricci::schema
