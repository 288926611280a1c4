// Where a sweep under way puts what it finishes and learns what is finished: the store or, in a child
// process, the pipe to the parent that has the store.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/app/console.h"
#include "engine/app/sweep_items.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// A step of the work on one file that fails, or not, as a whole.
struct SweepStage {
    std::string item;     // what a failure is recorded under
    std::string stage;    // load, resample or sweep
    Index component = 0;  // of the file
    Index resolution = 0;
};

inline constexpr const char *kLoadStage = "load", *kResampleStage = "resample", *kSweepStage = "sweep";
/// "sweep vertex 12", and back.
std::string vertex_stage(Index vertex);
std::optional<Index> vertex_of_stage(const std::string& stage);

/// How far an item is.
struct Admission {
    std::string name;             // with ~2, ~3 where it is taken
    std::vector<Index> finished;  // not to be solved (again), ascending
};

/// Methods may be called from several threads. Throw FileError when the output is lost.
class SweepRecords {
  public:
    virtual ~SweepRecords() = default;
    /// A stage begins. Returns the failure recorded for it when it is not to be tried again.
    virtual std::optional<FailureRecord> begin(const SweepStage& stage) = 0;
    /// The stage is done: a failure recorded for it is void.
    virtual void passed(const SweepStage& stage) = 0;
    /// Stores an item's mesh unless it is there. `item.name` is the name it would like; `stage` says which
    /// component and resolution it is.
    virtual Admission admit(const ItemRecord& item, const SweepStage& stage) = 0;
    virtual void chosen(const std::string& item, const ChosenVertices& vertices) = 0;
    virtual void started(const std::string& item, Index vertex) = 0;
    /// Rows of one item; failures of single vertices come by failed().
    virtual void finished(const SweepBlock& block) = 0;
    virtual void item_finished(const std::string& item, double seconds) = 0;
    virtual void failed(const FailureRecord& failure) = 0;
};

/// Records in a RunStore, and on the log.
class StoreRecords final : public SweepRecords {
  public:
    /// `store` may be null (dry run). `retry`: what is recorded as failed counts as not tried.
    StoreRecords(RunStore* store, bool retry, ProgressLine& progress)
        : store_(store), retry_(retry), progress_(&progress) {}

    /// Failures of a kind that trying again may repeat at a price (a crash, a hang, memory) are not tried
    /// again unless asked for.
    std::optional<FailureRecord> begin(const SweepStage& stage) override;
    void passed(const SweepStage& stage) override;
    /// Throws UsageError when an item of that name and file is stored, but the file has changed since.
    Admission admit(const ItemRecord& item, const SweepStage& stage) override;
    void chosen(const std::string& /*item*/, const ChosenVertices& /*vertices*/) override {}
    void started(const std::string& /*item*/, Index /*vertex*/) override {}
    void finished(const SweepBlock& block) override;
    void item_finished(const std::string& item, double seconds) override;
    void failed(const FailureRecord& failure) override;

    /// What is finished of an item that has been admitted.
    [[nodiscard]] Admission admission_of(const std::string& name) const;
    /// Recorded in this run.
    [[nodiscard]] bool has_failed(const std::string& item, const std::string& stage) const;
    /// After everything has been tried: retracts failures of earlier runs that have not come up again.
    void forget_mended();

  private:
    [[nodiscard]] bool was_admitted(const std::string& item) const;
    std::string name_for(const ItemRecord& item);

    RunStore* store_;
    bool retry_;
    ProgressLine* progress_;
    mutable std::mutex mutex_;
    std::set<std::string> used_;
    std::set<std::pair<std::string, std::string>> failed_;  // in this run: item and stage
};

/// Drops the conformal factors that the assembled file would not keep of these, whatever other blocks of the
/// item hold: all but the first few and the worst.
void drop_needless(std::vector<KeptFactor>& kept, const KeepPolicy& keep);

}  // namespace ricci::app
