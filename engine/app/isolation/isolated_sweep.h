// A sweep whose files are opened and swept in child processes; the parent alone has the store.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/app/isolation/child_pool.h"
#include "engine/app/isolation/failure_bundle.h"
#include "engine/app/isolation/sweep_messages.h"
#include "engine/app/sweep_config.h"
#include "engine/app/sweep_items.h"
#include "engine/app/sweep_plan.h"
#include "engine/app/sweep_records.h"

namespace ricci::app {

class IsolatedSweep final : public IsolatedWork {
  public:
    /// A task for each of the plan's files. Throws UsageError.
    IsolatedSweep(const SweepConfig& config, const std::vector<SweepSource>& sources, const SweepPlan& plan,
                  StoreRecords& records, ProgressLine& progress);

    bool may_start(std::size_t task) override;
    std::optional<std::string> job(std::size_t task, const ChildShare& share) override;
    void message(std::size_t task, const Frame& frame,
                 const std::function<void(std::string_view)>& reply) override;
    Verdict ended(std::size_t task, const ChildEnd& end, const ChildShare& share) override;
    void tick() override;

    /// Items, and files that gave none, in input order.
    [[nodiscard]] std::vector<SweepItem> items() const;
    [[nodiscard]] bool any_failure() const { return any_failure_; }

  private:
    /// An item's place among those of its file: component, and place of its resolution in the list.
    using Place = std::pair<Index, std::size_t>;
    struct Entry {
        SweepItem item;
        bool over = false;                // finished or failed
        std::size_t done = 0, known = 0;  // solves
    };
    struct Source {
        SweepSource source;
        std::int32_t input = 0;       // its number in the whole run
        std::vector<WorkPart> parts;  // of it; their units are resolutions
        std::string family;           // sources of one family may claim the same names
        bool named = false;           // all its items have names
        std::map<Place, Entry> items;
        std::optional<SweepItem> load;  // where it gave no items
        int unexplained = 0;            // deaths between items
        // Of the child at work:
        bool opened = false, done = false;
        std::map<std::pair<Index, Index>, int> asked;  // for a component and resolution
        SweepStage stage;
        Place place;
        std::set<Index> under_way;
        std::optional<FailureRecord> exception;
        SweepBlock block;  // not in the store yet
        std::chrono::steady_clock::time_point block_begun;
    };
    using Reply = std::function<void(std::string_view)>;

    Place next_place(Source& source, const SweepStage& stage);
    static bool between_items(const Source& source);
    SweepItem& item_here(Source& source, const std::string& base);
    static Entry& entry_of(Source& source, const std::string& name);
    void begin(Source& source, const SweepStage& stage, const Reply& reply);
    void admit(Source& source, const SweepStage& stage, const ItemRecord& item, const Reply& reply);
    void chosen(Source& source, MessageReader& reader);
    void failed(Source& source, const FailureRecord& failure);
    void take_over(Source& source, const FailureRecord& failure);
    void take_block(Source& source, SweepBlock block);
    void flush(Source& source);
    [[nodiscard]] FailureBundle bundle_of(const Source& source) const;
    void record_death(Source& source, const ChildEnd& end);
    void set_named(Source& source);
    void report();

    SweepConfig config_;
    KeepPolicy keep_;
    StoreRecords* records_;
    ProgressLine* progress_;
    std::vector<Index> resolutions_;
    std::vector<Source> sources_;
    bool any_failure_ = false;
    SchedulerProgress progress_now_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace ricci::app
