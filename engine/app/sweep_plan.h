// Who does what when a sweep is shared out among machines. Each works out the same plan from the same inputs.
#pragma once

#include <string>
#include <vector>

#include "engine/app/sweep_config.h"
#include "engine/sweep/divide_work.h"

namespace ricci::app {

/// What every shard demands of its configuration: that it can be divided, and all that a run would refuse.
/// Throws UsageError.
void require_shardable(const SweepConfig& config);

/// What one shard of a sweep does. A unit of work is one input file at one resolution.
class SweepPlan {
  public:
    /// All of it, on this machine alone.
    SweepPlan(std::size_t files, std::size_t resolutions);
    /// Parts of one file, as parts_of() gives them.
    SweepPlan(std::vector<WorkPart> parts, std::size_t resolutions);
    /// The shard that the configuration names. Small files count by their size on disk; the largest are
    /// loaded, at most `threads` at a time and within a fixed amount of memory, as many as take a small part
    /// of a shard's time: their components, their topology and so their true work are known then. Throws
    /// UsageError; FileError where memory runs out, for the plan would not be that of the other shards.
    SweepPlan(const SweepConfig& config, const std::vector<std::string>& files, int threads);

    /// The files that this machine opens, ascending.
    [[nodiscard]] const std::vector<std::size_t>& files() const { return files_; }
    /// This machine's part of a file at a resolution (a number into the list of them); null: none.
    [[nodiscard]] const WorkPart* part(std::size_t file, std::size_t resolution) const;
    /// This machine's parts of a file; their units are numbers into the list of resolutions.
    [[nodiscard]] std::vector<WorkPart> parts_of(std::size_t file) const;

    [[nodiscard]] bool sharded() const { return sharded_; }
    [[nodiscard]] Shard shard() const { return shard_; }
    [[nodiscard]] std::size_t inputs() const { return inputs_; }
    [[nodiscard]] std::size_t resolutions() const { return resolutions_; }
    /// 16 hexadecimal digits: equal for the same division of inputs of the same paths and sizes, and the same
    /// list of vertices.
    [[nodiscard]] const std::string& digest() const { return digest_; }
    /// Shards that have nothing to do.
    [[nodiscard]] std::size_t idle() const { return idle_; }
    /// For people: how even the division is, and this machine's share of the work.
    [[nodiscard]] std::string division() const;
    [[nodiscard]] std::string summary() const;

  private:
    void take_parts(std::vector<WorkPart> parts);

    std::size_t inputs_ = 0, resolutions_ = 1, loaded_ = 0;
    bool sharded_ = false;
    Shard shard_;
    std::vector<WorkPart> parts_;  // ascending by unit = file * resolutions + resolution
    std::vector<std::size_t> files_;
    std::string digest_;
    double share_ = 1.0, imbalance_ = 1.0, overhead_ = 0.0;
    std::size_t idle_ = 0;
};

}  // namespace ricci::app
