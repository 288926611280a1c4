// Results on disk: immutable journalled segments while a run is under way, one assembled HDF5 file at its
// end. The layout is the HDF5 contract (docs/hdf5.md). The store knows names and arrays, nothing of flows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"
#include "io/store/result_group.h"
#include "kernels/surface_mesh.h"

namespace ricci {

/// Names of the solve status in the order of their stored values (append only). A copy of engine's enum names
/// is handed in by the application; the store writes it as an HDF5 enum over u1.
struct StatusNames {
    std::vector<std::string> names;
};

/// Root attributes of the file. `complete` and `created` are the store's own business. Text everywhere is
/// UTF-8; bytes that are not are stored as \xNN.
struct RunInfo {
    std::string software_version, git, command, config, host;  // config: resolved TOML
    std::string
        fingerprint;  // what must be equal for --resume: the part of the configuration that decides results
    std::int32_t threads = 1;
    StatusNames status;
    std::string processor{};  // what decides the last bits on this machine; "": not recorded. In the journal,
                              // and in what a shard says of itself
    std::string created;      // ISO 8601, UTC; set by read_run, ignored by RunStore
};

/// Text as the store keeps it.
std::string stored_form(const std::string& text);

/// One item: a surface at one resolution. Its name is <stem>@<faces>, made unique by ~2, ~3 in input order.
struct ItemRecord {
    std::string name;
    std::string source, source_hash, units;  // path as given, 16 hex digits, "" when unknown
    Index vertices = 0, faces = 0, genus = 0, boundaries = 0, euler_characteristic = 0;
    std::vector<Point> points;  // V, unused points included (empty for intrinsic surfaces: then twin and
                                // edge_length are given)
    std::vector<Triangle> triangles;   // F
    std::vector<Index> source_vertex;  // V, or empty where the surface was not resampled
    std::vector<Index> twin;           // 3F, intrinsic surfaces only: mesh/twin
    std::vector<double> edge_length;   // 3F, intrinsic surfaces only: mesh/edge_length
};

/// Where an item's mesh came from, as its record has it.
struct ItemSource {
    std::string source, source_hash;
};

/// One row of a sweep.
struct SweepRow {
    Index vertex = 0;
    std::uint8_t status = 0;
    double area_distortion = 0.0;  // NaN unless converged
    std::uint16_t newton_iterations = 0;
    double residual_max = 0.0;
    std::int32_t flips = 0;
    float seconds = 0.0F;
    double gauss_bonnet_error = 0.0;     // NaN: not recorded (files of earlier versions)
    std::int32_t precision_digits = 16;  // of the arithmetic that measured the residual; 0: not recorded
};

/// A conformal factor worth keeping.
struct KeptFactor {
    Index vertex = 0;
    double area_distortion = 0.0;
    std::vector<double> conformal_factor;  // V
};

/// A finished block of sweep rows: what one segment file holds.
struct SweepBlock {
    std::string item;
    std::vector<SweepRow> rows;    // any order; assembled ascending by vertex
    std::vector<KeptFactor> kept;  // candidates for best/worst/kept, each belonging to a converged row
};

/// Which conformal factors the assembled file stores: best and worst (when a vertex converged); `count` of
/// further ones, the best first (-1: all candidates), ties to the lowest vertex.
struct KeepPolicy {
    bool best = true, worst = true;
    std::int64_t count = 0;
};

/// One flow result.
struct FlowRecord {
    std::string item;
    std::string geometry, scheme, method, boundary;  // attributes of the group flow/
    std::uint8_t status = 0;
    std::int32_t newton_iterations = 0, flips = 0;
    double residual_max = 0.0, gauss_bonnet_error = 0.0, seconds = 0.0;
    std::int32_t precision_digits = 16;    // of the arithmetic that measured the residual; 0: not recorded
    bool doubled = false;                  // the final triangulation is that of the double
    std::vector<double> conformal_factor;  // V
    std::vector<double> conformal_factor_low;  // V, to be added to it unevaluated; empty: 0
    std::vector<double> target_curvature;      // V, radians
    std::vector<double> curvature;             // V, radians
    std::vector<Triangle> triangles;           // F' of the final triangulation
    std::vector<Index> twin;                   // 3F'
    std::vector<double> edge_length;           // 3F'
    std::vector<double> log_residual_max, log_step, log_seconds;  // one per logged iteration
    std::vector<std::int32_t> log_flips;
};

/// A failure of an item, or of a stage of it.
struct FailureRecord {
    std::string item, stage, status, message;
};

struct ShardTable;  // io/store/shard_table.h

/// A run in progress: every method is thread-safe; a write_ method returns once its segment is durable.
/// Throws FileError on input/output failures (disk full, ...); the journal then still tells the truth, and
/// the store can be used further. std::invalid_argument on records whose sizes do not fit together, on a
/// vertex, item, flow or further result that is stored already (a row without area distortion, of a solve
/// that failed, is replaced instead), and on results of an item that is not. A process that may meet a file
/// size limit ignores SIGXFSZ, so that the limit becomes a FileError.
class RunStore {
  public:
    /// Starts `output`.parts afresh (removing left-overs) or, with `resume`, continues what its journal
    /// proves finished. With `resume`, a complete `output` and no parts, everything in `output` is finished.
    /// An existing `output` stays as it is until assemble(). Throws FileError, also when another run holds
    /// the parts; std::invalid_argument when the fingerprint (or the order of status names) of the parts or
    /// output differs.
    RunStore(std::string output, RunInfo info, bool resume);
    /// Keeps the parts for a later resume, unless nothing was written.
    ~RunStore();
    RunStore(const RunStore&) = delete;
    RunStore& operator=(const RunStore&) = delete;

    [[nodiscard]] bool has_item(const std::string& item) const;         // its mesh is stored
    [[nodiscard]] ItemRecord read_item(const std::string& item) const;  // throws invalid_argument
    [[nodiscard]] std::optional<ItemSource> source_of(const std::string& item) const;
    [[nodiscard]] std::vector<std::string> items() const;  // whose mesh is stored, ascending
    [[nodiscard]] std::vector<Index> finished_vertices(const std::string& item) const;  // ascending
    [[nodiscard]] std::vector<SweepRow> finished_rows(const std::string& item) const;   // ascending by vertex
    [[nodiscard]] bool has_flow(const std::string& item) const;
    [[nodiscard]] bool has_result(const std::string& item, const std::string& kind) const;  // a further one
    [[nodiscard]] bool has_failure(const FailureRecord& failure) const;  // same item and stage
    [[nodiscard]] std::optional<FailureRecord> failure_of(const std::string& item,
                                                          const std::string& stage) const;
    [[nodiscard]] std::vector<FailureRecord> failures() const;  // in order of item and stage
    /// What resuming did not believe (torn journal line, damaged segment and the rows lost with it), for the
    /// log.
    [[nodiscard]] std::vector<std::string> notes() const;

    /// No more of the item's rows are expected: they need not be held in memory. They can still be asked for,
    /// and added to. An item that is not stored: no-op.
    void release(const std::string& item);

    void write_item(const ItemRecord& item);
    void write_sweep_block(const SweepBlock& block);
    void write_flow(const FlowRecord& flow);
    void write_result(const ResultGroup& result);
    void write_failure(const FailureRecord& failure);    // replaces one of the same item and stage
    void retract_failure(const FailureRecord& failure);  // before a failed item is tried again; none: no-op

    /// Assembles the final file, verifies it, renames it into place and removes the parts. `items` names
    /// every stored item once, in the order of the file (std::invalid_argument otherwise, and when a
    /// conformal factor that `keep` asks for is not among the candidates). An item without rows gets no sweep
    /// group. Factors are read one at a time. Afterwards the store answers queries but takes no writes
    /// (std::logic_error). Throws FileError where a segment is not what it was when it was written. `shard`:
    /// what the file says of itself where it is one of several.
    void assemble(const std::vector<std::string>& items, const KeepPolicy& keep,
                  const ShardTable* shard = nullptr);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Reads results back (verify, export).
struct StoredSweep {
    std::vector<SweepRow> rows;
    std::vector<KeptFactor> kept;  // best, worst and the others as stored, each vertex once
    std::optional<Index> best, worst;
};
struct StoredItem {
    ItemRecord item;
    std::optional<StoredSweep> sweep;
    std::optional<FlowRecord> flow;
    std::vector<ResultGroup> results{};  // ascending by kind
};
struct StoredRun {
    RunInfo info;
    bool complete = false;
    std::vector<StoredItem> items;
    std::vector<FailureRecord> failures;
};

/// Reads a whole result file, once a child process has walked over it (io/store/foreign_file.h). Throws
/// FileError on anything that does not keep the contract, naming the object.
StoredRun read_run(const std::string& path);

/// Structural check: openable, attributes, shapes, enum, order, checksums, best/worst consistent with the
/// rows, and any left-over parts folder's journal against its segments. Returns complaints, empty when sound.
/// The file is read in a child process under time and memory limits, for damaged HDF5 can loop or crash.
/// Throws FileError when no child can be had.
std::vector<std::string> verify_structure(const std::string& path);

/// Rows of the sweeps of all items as ".csv", written under a temporary name and renamed. Throws FileError.
void export_csv(const std::string& path, const StoredRun& run);

}  // namespace ricci
