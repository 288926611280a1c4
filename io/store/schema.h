// The layout of the result file, in one place: what each record looks like below its group (docs/hdf5.md).
// Segments hold the same groups under the same names. Callers hold an hdf5::Session.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/store/hdf5_file.h"
#include "io/store/run_store.h"

namespace ricci::schema {

inline constexpr std::int32_t kFormatVersion = 1;

/// Number V of values per vertex: points, or source_vertex of intrinsic surfaces, or the count.
std::size_t vertex_slots(const ItemRecord& item);

/// Throw std::invalid_argument naming the item when sizes or indices of a record do not fit together.
void require_valid(const ItemRecord& item);
void require_valid(const SweepBlock& block, std::size_t vertex_count, const StatusNames& status);
void require_valid(const FlowRecord& flow, std::size_t vertex_count, const StatusNames& status);
void require_valid(const ResultGroup& result, const StatusNames& status);

/// Stored value of "converged"; none when the names lack it.
std::optional<std::uint8_t> converged_status(const StatusNames& status);

/// The enum over u1 in which every status is stored.
hdf5::Handle status_type(const StatusNames& status);

/// Now, for the attribute `created`: ISO 8601, UTC.
std::string now();

/// Root attributes but `complete`. Reading throws FileError on a foreign format or version.
void write_run_info(hid_t root, const RunInfo& info, const std::string& created);
RunInfo read_run_info(hid_t root);

/// The item's attributes and mesh/ into (from) its group.
void write_item(hid_t group, const ItemRecord& item);
ItemRecord read_item(hid_t group, const std::string& name);

/// The columns of rows (ascending by vertex) into (from) the group sweep/.
void write_rows(hid_t sweep, const std::vector<SweepRow>& rows, const StatusNames& status);
std::vector<SweepRow> read_rows(hid_t sweep, const StatusNames& status);

/// best/ or worst/: one row and its conformal factor.
void write_extreme(hid_t sweep, const char* name, const KeptFactor& factor);

/// Vertices of sweep/kept (none when the group is missing), and the factors' shape checked against V.
std::vector<Index> read_kept_vertices(hid_t sweep, std::size_t vertex_count);
/// Vertex of best/ or worst/; none when the group is missing.
std::optional<Index> read_extreme_vertex(hid_t sweep, const char* name);
/// Factor of best/ or worst/.
KeptFactor read_extreme(hid_t sweep, const char* name, std::size_t vertex_count);

/// The attribute `status` of a group, an enum over u1. Reading throws FileError when its names are not these.
void write_status(hid_t group, std::uint8_t value, const StatusNames& status);
std::uint8_t read_status(hid_t group, const StatusNames& status);

/// Attributes and datasets of flow/.
void write_flow(hid_t group, const FlowRecord& flow, const StatusNames& status);
FlowRecord read_flow(hid_t group, const std::string& item, std::size_t vertex_count,
                     const StatusNames& status);

/// Kinds of an item's further results in ascending order: its links but mesh, sweep and flow.
std::vector<std::string> result_kinds(hid_t item_group);

/// Attributes and arrays of a further result into (from) its group. Reading throws FileError on anything that
/// a ResultGroup cannot hold, or that require_valid() refuses.
void write_result(hid_t group, const ResultGroup& result, const StatusNames& status);
ResultGroup read_result(hid_t group, const std::string& item, const std::string& kind,
                        const StatusNames& status);

/// The table /failures.
void write_failures(hid_t root, const std::vector<FailureRecord>& failures);
std::vector<FailureRecord> read_failures(hid_t root);

}  // namespace ricci::schema
