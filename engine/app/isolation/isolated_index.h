// An index build whose files are read and described in child processes; the parent alone has the store.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/app/index_build.h"
#include "engine/app/isolation/child_pool.h"

namespace ricci::app {

/// From a child that describes one file.
enum class DescribeMessage : std::uint32_t {
    component = static_cast<std::uint32_t>(PoolMessage::first_own),  // i4, i4: number, of how many, is next
    shape,                                                           // shape
    load_error                                                       // text
};

class IsolatedIndex final : public IsolatedWork {
  public:
    /// `order`: what is to be read, in the order of the tasks.
    IsolatedIndex(IndexBuild& build, const std::vector<IndexBuild::Reading*>& order, std::string output,
                  ProgressLine& progress);

    bool may_start(std::size_t /*task*/) override { return true; }
    std::optional<std::string> job(std::size_t task, const ChildShare& share) override;
    void message(std::size_t task, const Frame& frame,
                 const std::function<void(std::string_view)>& reply) override;
    Verdict ended(std::size_t task, const ChildEnd& end, const ChildShare& share) override;
    void tick() override;

    /// After the last child: files with the bytes of another share its fate. Everything is durable then.
    void settle();

    /// Of the shape's reproducer: stem, hash of the bytes, component.
    static std::string bundle_name(const std::string& file, std::uint64_t hash, std::int32_t component);

  private:
    struct Work {
        IndexBuild::Reading* reading = nullptr;
        std::int32_t component = 0, components = 1;
        bool begun = false, done = false;
        std::set<std::int32_t> described;  // by any child of the task, or before
        std::string exception;
    };

    [[nodiscard]] const std::string& file_of(const Work& work) const;
    void look_at(Work& work);
    void finish(Work& work);
    void hand_over();
    void record_death(Work& work, const ChildEnd& end);

    IndexBuild* build_;
    std::string output_;
    ProgressLine* progress_;
    std::vector<Work> tasks_;
    std::map<std::uint64_t, std::size_t> claimed_;  // by the task that comes first
    std::vector<std::size_t> twins_;                // tasks whose bytes another has claimed
    std::vector<IndexBuild::Reading*> finished_;    // not handed over yet
    SchedulerProgress progress_now_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), handed_over_ = start_;
};

}  // namespace ricci::app
