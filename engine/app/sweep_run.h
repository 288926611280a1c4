// A sweep under way: opens inputs, feeds the scheduler, writes to the store.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "engine/app/console.h"
#include "engine/app/sweep_config.h"
#include "engine/sweep/scheduler.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// One line of the table and of the JSON output.
struct ItemSummary {
    std::string name;
    Status status = Status::converged;  // of the item as a whole
    std::string message;
    std::size_t vertices = 0, solved = 0, failed = 0;  // of those asked for
    std::optional<SweepRow> best, worst;
    double seconds = 0.0;
};

class SweepRun final : public SweepSink {
  public:
    /// `store` may be null (dry run). Throws UsageError.
    SweepRun(const SweepConfig& config, std::vector<std::string> files, RunStore* store,
             ProgressLine& progress);

    /// Opens the i-th file: one task per component and resolution. Records what is wrong with it instead of
    /// throwing; FileError of the store comes through.
    std::vector<SweepTask> open(std::size_t file);

    void block_finished(std::size_t item, std::vector<SweepSolve> solves) override;
    void item_finished(std::size_t item, double seconds) override;
    void item_failed(std::size_t item, Status status, const std::string& message) override;
    void progress(const SchedulerProgress& progress) override;

    /// Names of all items with a mesh in the store, in input order.
    [[nodiscard]] std::vector<std::string> stored_items() const;
    /// Summaries of all items (and of files that gave none), in input order, rows read from the store.
    [[nodiscard]] std::vector<ItemSummary> summaries() const;
    [[nodiscard]] bool any_failure() const { return any_failure_; }

  private:
    struct Item {
        std::string name;
        bool stored = false;
        std::size_t vertices = 0;  // asked for
        Status status = Status::converged;
        std::string message;
        double seconds = 0.0;
    };

    std::optional<SweepTask> open_surface(const std::string& file, const std::string& stem,
                                          std::uint64_t hash, const SurfaceMesh& mesh, Index resolution);
    std::size_t add_item(Item item);
    std::string unique_name(const std::string& name);
    void record_failure(std::size_t item, const std::string& stage, Status status,
                        const std::string& message);
    [[nodiscard]] std::vector<Index> to_solve(const std::string& item, std::vector<Index> chosen) const;

    SweepConfig config_;
    std::vector<std::string> files_;
    RunStore* store_;
    ProgressLine* progress_;
    SweepOptions options_;
    VertexChoice choice_;
    std::vector<Index> resolutions_;
    Shard shard_;
    KeepPolicy keep_;
    RepairOptions repair_;

    mutable std::mutex mutex_;
    std::vector<Item> items_;
    std::map<std::string, int> name_uses_;
    bool any_failure_ = false;
};

}  // namespace ricci::app
