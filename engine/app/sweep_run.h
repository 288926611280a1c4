// A sweep under way: opens inputs, feeds the scheduler, writes to the store.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "engine/app/console.h"
#include "engine/app/sweep_config.h"
#include "engine/app/sweep_items.h"
#include "engine/app/sweep_plan.h"
#include "engine/app/sweep_records.h"
#include "engine/remesh/resample.h"
#include "engine/sweep/scheduler.h"

namespace ricci::app {

class SweepRun final : public SweepSink {
  public:
    /// `plan` must outlive this. Throws UsageError.
    SweepRun(const SweepConfig& config, std::vector<SweepSource> sources, const SweepPlan& plan,
             SweepRecords& records, ProgressLine& progress);

    /// Opens the i-th of the plan's files: one task per component and resolution. Records what is wrong with
    /// it instead of throwing; FileError of the store comes through.
    std::vector<SweepTask> open(std::size_t i);

    void solve_started(std::size_t item, Index vertex) override;
    void block_finished(std::size_t item, std::vector<SweepSolve> solves) override;
    void item_finished(std::size_t item, double seconds) override;
    void item_failed(std::size_t item, Status status, const std::string& message) override;
    void progress(const SchedulerProgress& progress) override;

    /// Items, and files that gave none, in input order.
    [[nodiscard]] std::vector<SweepItem> items() const;
    /// The stage of an item's solves.
    [[nodiscard]] SweepStage stage_of(std::size_t item) const;
    [[nodiscard]] bool any_failure() const { return any_failure_; }

  private:
    std::optional<SweepTask> open_surface(const SweepSource& source, const LoadedMesh& loaded,
                                          ShardItem place, const WorkPart& part);
    std::optional<ResampledMesh> resampled(const SurfaceMesh& mesh, const SweepStage& stage,
                                           const ShardItem& place);
    std::size_t add_item(const SweepStage& stage, bool stored, const ShardItem& place);
    void record_failure(std::size_t item, Status status, const std::string& message);
    void take_over(std::size_t item, const FailureRecord& failure);

    SweepConfig config_;
    std::vector<SweepSource> sources_;
    SweepRecords* records_;
    ProgressLine* progress_;
    SweepOptions options_;
    VertexChoice choice_;
    std::vector<Index> resolutions_;
    const SweepPlan* plan_;
    KeepPolicy keep_;
    RepairOptions repair_;

    mutable std::mutex mutex_;
    std::vector<SweepItem> items_;
    std::vector<SweepStage> stages_;  // of the items
    bool any_failure_ = false;
};

}  // namespace ricci::app
