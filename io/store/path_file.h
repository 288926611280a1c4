// Deformation paths as HDF5 and CSV (docs/hdf5.md, "Paths").
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/store/run_store.h"

namespace ricci {

/// One sequence of N frames with C coordinates and fingerprints of K numbers; NaN where a frame failed.
struct PathRecord {
    std::string type;                                  // "g2b0"; "" where every frame failed
    std::vector<std::string> names;                    // C
    std::vector<std::string> files, marking, message;  // N; marking: none, own or carried
    std::vector<std::uint8_t> status;                  // N
    std::vector<std::int32_t> marking_number;          // N: frames of one number share their curves; -1: none
    std::vector<double> coordinates;                   // N x C
    std::vector<double> fingerprint;                   // N x K
    std::vector<double> step, free_step, length;       // N
    std::vector<double> marking_gap, marking_spread;   // N
};

/// A group /paths/1, /paths/2, ... per sequence, and the root attributes of any file with kind = "paths".
/// Written under a temporary name, fsynced and renamed. Throws FileError.
void write_path_file(const std::string& path, const RunInfo& info, const std::vector<PathRecord>& records);

/// The same read back. Throws FileError on anything that does not keep the contract, naming the object.
struct PathFile {
    RunInfo info;
    std::vector<PathRecord> records;
};
PathFile read_path_file(const std::string& path);

/// One row per frame of all sequences, which have the same coordinates; `status_names`: as in RunInfo. What
/// is NaN stays empty. Quotes as in RFC 4180, shortest round-trip decimals. Throws FileError.
void write_path_csv(const std::string& path, const StatusNames& status_names,
                    const std::vector<PathRecord>& records);

}  // namespace ricci
