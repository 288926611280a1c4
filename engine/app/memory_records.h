// Where a sweep without a result file puts what it finishes.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "engine/app/sweep_records.h"

namespace ricci::app {

/// Keeps items, rows, candidates and failures in memory; nothing is ever known from before.
class MemoryRecords final : public SweepRecords {
  public:
    MemoryRecords(const KeepPolicy& keep, ProgressLine& progress) : keep_(keep), progress_(&progress) {}

    std::optional<FailureRecord> begin(const SweepStage& /*stage*/) override { return std::nullopt; }
    void passed(const SweepStage& /*stage*/) override {}
    Admission admit(const ItemRecord& item, const SweepStage& stage) override;
    void chosen(const std::string& /*item*/, const ChosenVertices& /*vertices*/) override {}
    void started(const std::string& /*item*/, Index /*vertex*/) override {}
    void finished(const SweepBlock& block) override;
    void item_finished(const std::string& /*item*/, double /*seconds*/) override {}
    void failed(const FailureRecord& failure) override;

    /// Items in this order, rows, extremes and kept factors as the assembled file of a run would have them;
    /// failures in the order of the items, then of names.
    StoredRun take(const std::vector<std::string>& names);

  private:
    KeepPolicy keep_;
    ProgressLine* progress_;
    std::mutex mutex_;
    std::map<std::string, StoredItem> items_;
    std::vector<FailureRecord> failures_;
};

/// Sorts the rows of a sweep by vertex and leaves of its candidates those that a result file keeps: best and
/// worst over converged rows (ties to the lowest vertex), then the others, the best first.
void choose_kept(StoredSweep& sweep, const KeepPolicy& keep);

}  // namespace ricci::app
