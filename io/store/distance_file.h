// Distances between shapes and their clustering as HDF5 and CSV (docs/hdf5.md, "Distances").
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/store/run_store.h"

namespace ricci {

/// Distances between the N shapes of one topological type that have any, and their dendrogram.
struct DistanceRecord {
    std::string type, metric, linkage;
    std::vector<std::string> shapes;                      // N
    std::vector<double> distances;                        // N x N
    std::vector<std::int32_t> merge_first, merge_second;  // N - 1: clusters 0 .. N-1 are shapes, N + k merges
    std::vector<double> merge_height;                     // N - 1
    std::vector<std::int32_t> leaf_order, cluster;        // N
};

/// One group per record below /distances, and the root attributes of any file with kind = "distances".
/// Written under a temporary name, fsynced and renamed. Throws FileError.
void write_distance_file(const std::string& path, const RunInfo& info,
                         const std::vector<DistanceRecord>& records);

/// The same read back. Throws FileError on anything that does not keep the contract, naming the object.
struct DistanceFile {
    RunInfo info;
    std::vector<DistanceRecord> records;  // ascending by type
};
DistanceFile read_distance_file(const std::string& path);

/// The matrix with names in the first row and column; quotes as in RFC 4180, shortest round-trip decimals.
/// Throws FileError.
void write_distance_csv(const std::string& path, const DistanceRecord& record);

}  // namespace ricci
