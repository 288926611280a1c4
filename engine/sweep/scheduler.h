// Sweeps of whole data sets: workers over the vertices of several surfaces at a time, memory bounded.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/sweep_solver.h"

namespace ricci {

/// A surface to sweep, made when its turn comes.
struct SweepTask {
    std::size_t item = 0;  // the caller's number for it
    std::shared_ptr<const SweepSurface> surface;
    std::vector<Index> vertices;  // to be solved, ascending
};

struct SchedulerOptions {
    int threads = 1;
    std::function<int()> grant;    // threads allowed by now, where they become more; empty: `threads`
    std::int64_t max_memory = 0;   // bytes for surfaces and workers; 0: no limit
    double timeout_seconds = 0.0;  // per solve, from its start, whatever else runs; 0: none
    double block_seconds = 5.0;    // a worker hands over its finished solves about this often
    std::function<void()> alive;   // called from steps of solves alone: a sign that one goes on
    std::function<bool()> stop;    // cancelled (a signal): finish nothing more, hand over what is finished
};

struct SchedulerProgress {
    std::size_t sources_opened = 0, sources = 0;
    std::int64_t solves_done = 0, solves_known = 0;  // of the sources opened so far
    double seconds = 0.0;
};

/// What the scheduler tells its caller. Calls come from worker threads, possibly several at once.
class SweepSink {
  public:
    virtual ~SweepSink() = default;
    /// A solve is about to begin. An exception stops everything, as those of the other calls do.
    virtual void solve_started(std::size_t /*item*/, Index /*vertex*/) {}
    /// Solves of one item in any order among blocks, ascending by vertex within one.
    virtual void block_finished(std::size_t item, std::vector<SweepSolve> solves) = 0;
    /// All vertices of an item are solved; `seconds` is the time since it was opened.
    virtual void item_finished(std::size_t item, double seconds) = 0;
    virtual void item_failed(std::size_t item, Status status, const std::string& message) = 0;
    virtual void progress(const SchedulerProgress& progress) = 0;
};

/// Sweeps the surfaces of `sources` sources. `open(i)` makes those of the i-th; it is called in ascending
/// order, one call at a time, when workers run out of vertices. Its exceptions, and those of the sink (output
/// lost), stop everything and come through: what concerns one source alone, `open` records itself.
void run_sweeps(std::size_t sources, const std::function<std::vector<SweepTask>(std::size_t)>& open,
                SweepSink& sink, const SchedulerOptions& options);

/// Every vertex, or `count` of them drawn without replacement by Fisher-Yates on SplitMix64 seeded with
/// `seed`, ascending.
std::vector<Index> sample_vertices(const std::vector<Index>& candidates, std::int64_t count,
                                   std::uint64_t seed);

}  // namespace ricci
