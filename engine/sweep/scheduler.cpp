#include "engine/sweep/scheduler.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <utility>

#include "kernels/parallel.h"

namespace ricci {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// An item under way.
struct OpenItem {
    SweepTask task;
    int lanes = 0;             // of a worker
    std::size_t next = 0;      // first vertex not handed out
    std::size_t solved = 0;    // finished
    std::size_t recorded = 0;  // finished and handed over
    Clock::time_point opened = Clock::now();

    [[nodiscard]] bool has_work() const { return next < task.vertices.size(); }
    [[nodiscard]] std::int64_t worker_bytes() const { return task.surface->worker_bytes(lanes); }
};

/// What one thread holds between items.
struct Seat {
    std::shared_ptr<OpenItem> item;
    std::unique_ptr<SweepWorker> worker;
    std::size_t under_way = 0;       // vertices
    std::vector<SweepSolve> solves;  // not handed over yet
    Clock::time_point handed_over;
};

/// The queue all threads draw from. Its state is under one mutex; opening items and solving happen outside of
/// it. Memory: a thread gives its worker back before it waits, so those who wait hold nothing.
class Queue {
  public:
    Queue(std::size_t sources, const std::function<std::vector<SweepTask>(std::size_t)>& open,
          SweepSink& sink, const SchedulerOptions& options)
        : sources_(sources),
          open_(&open),
          sink_(&sink),
          options_(&options),
          threads_(std::max(options.threads, 1)) {}

    void work() {
        Seat seat;
        try {
            while (find_work(seat)) solve(seat);
        } catch (...) {
            fail();
        }
        leave(seat);
    }

    /// Waits for the threads that were added, and for those that they added.
    void join() {
        for (;;) {
            ExtraThreads joined;
            const std::lock_guard lock(mutex_);
            if (extra_.count() == 0) return;
            std::swap(joined, extra_);
        }
    }

    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    [[nodiscard]] bool stopped() const { return error_ || (options_->stop && options_->stop()); }

    void fail() {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
    }

    void leave(Seat& seat) {
        if (!seat.item) return;
        seat.worker.reset();
        const std::lock_guard lock(mutex_);
        used_memory_ -= seat.item->worker_bytes();
        --seats_taken_;
        seat.item.reset();
        changed_.notify_all();
    }

    [[nodiscard]] bool fits(const OpenItem& item) const {
        return options_->max_memory <= 0 || seats_taken_ == 0 ||
               used_memory_ + item.worker_bytes() <= options_->max_memory;
    }

    /// Gives the seat an item with vertices to solve. False: there is nothing more to do.
    bool find_work(Seat& seat) {
        {
            const std::lock_guard lock(mutex_);
            if (!stopped() && seat.item && seat.item->has_work()) return true;
        }
        leave(seat);
        std::unique_lock lock(mutex_);
        while (!stopped()) {
            const auto found = std::find_if(open_items_.begin(), open_items_.end(), [&](const auto& item) {
                return item->has_work() && fits(*item);
            });
            if (found != open_items_.end()) {
                seat.item = *found;
                used_memory_ += seat.item->worker_bytes();
                ++seats_taken_;
                return true;
            }
            const bool waiting_items = std::any_of(open_items_.begin(), open_items_.end(),
                                                   [](const auto& item) { return item->has_work(); });
            if (!waiting_items && !opening_ && next_source_ < sources_) {
                open_next(lock);
            } else if (waiting_items || opening_) {
                changed_.wait_for(lock, std::chrono::milliseconds(100));
            } else {
                break;
            }
        }
        return false;
    }

    /// Opens the next source, outside of the lock; `opening_` keeps the others out, so sources open in order.
    void open_next(std::unique_lock<std::mutex>& lock) {
        const std::size_t source = next_source_++;
        opening_ = true;
        lock.unlock();
        std::vector<SweepTask> tasks;
        std::exception_ptr fatal;
        try {
            tasks = (*open_)(source);
        } catch (...) {
            fatal = std::current_exception();
        }
        lock.lock();
        opening_ = false;
        changed_.notify_all();
        if (fatal) std::rethrow_exception(fatal);
        for (SweepTask& task : tasks) admit(std::move(task));
        report();
    }

    void admit(SweepTask task) {
        const SweepSurface& surface = *task.surface;
        int lanes = surface.lanes();
        std::int64_t need = 0;
        const auto exceeds = [&] {
            need = surface.shared_bytes() + surface.worker_bytes(lanes);
            return options_->max_memory > 0 && need > options_->max_memory;
        };
        // A step costs about the same for any number of lanes: fewer workers before fewer lanes.
        while (exceeds() && lanes > 1) --lanes;
        if (task.vertices.empty()) {
            sink_->item_finished(task.item, 0.0);
        } else if (exceeds()) {
            sink_->item_failed(
                task.item, Status::out_of_memory,
                fmt::format("one solve needs about {:.0f} MB, more than --max-memory allows ({:.0f} MB)",
                            static_cast<double>(need) / 1e6,
                            static_cast<double>(options_->max_memory) / 1e6));
        } else {
            used_memory_ += surface.shared_bytes();
            solves_known_ += static_cast<std::int64_t>(task.vertices.size());
            open_items_.push_back(std::make_shared<OpenItem>());
            open_items_.back()->task = std::move(task);
            open_items_.back()->lanes = lanes;
        }
    }

    void solve(Seat& seat) {
        if (!seat.worker)
            seat.worker = std::make_unique<SweepWorker>(seat.item->task.surface, seat.item->lanes);
        seat.handed_over = Clock::now();
        seat.worker->run({[&] { return next_vertex(seat); },
                          [&](SweepSolve solved) { take_in(seat, std::move(solved)); },
                          [&](double seconds) { return interruption(seconds); }});
        hand_over(seat);
    }

    /// Starts the threads that were granted since the last look. Under the mutex.
    void grow() {
        if (!options_->grant) return;
        for (const int granted = options_->grant(); threads_ < granted; ++threads_)
            extra_.start([this] { work(); });
    }

    /// The next vertex of the seat's item, as long as the seat holds no more than its share of what is not
    /// solved yet: near the end of an item the threads keep fewer lanes each, rather than some of them none.
    std::optional<Index> next_vertex(Seat& seat) {
        if (options_->alive) options_->alive();
        const std::optional<Index> vertex = draw(seat);
        if (vertex) sink_->solve_started(seat.item->task.item, *vertex);
        return vertex;
    }

    std::optional<Index> draw(Seat& seat) {
        const std::lock_guard lock(mutex_);
        grow();
        OpenItem& item = *seat.item;
        const auto threads = static_cast<std::size_t>(threads_);
        const std::size_t unsolved = item.task.vertices.size() - item.solved;
        if (stopped() || !item.has_work() || seat.under_way >= (unsolved + threads - 1) / threads)
            return std::nullopt;
        ++seat.under_way;
        return item.task.vertices[item.next++];
    }

    std::optional<Status> interruption(double seconds) const {
        if (options_->alive) options_->alive();
        const std::lock_guard lock(mutex_);
        if (stopped()) return Status::cancelled;
        if (options_->timeout_seconds > 0.0 && seconds > options_->timeout_seconds) return Status::timeout;
        return std::nullopt;
    }

    void take_in(Seat& seat, SweepSolve solved) {
        const bool dropped = solved.status == Status::cancelled;
        if (!dropped) seat.solves.push_back(std::move(solved));
        --seat.under_way;
        if (dropped) return;
        // An exception of the sink stops the solver by way of stopped(), not through its frames.
        try {
            {
                const std::lock_guard lock(mutex_);
                ++seat.item->solved;
                ++solves_done_;
                report();
            }
            if (seconds_since(seat.handed_over) > options_->block_seconds) hand_over(seat);
        } catch (...) {
            fail();
        }
    }

    void hand_over(Seat& seat) {
        seat.handed_over = Clock::now();
        if (seat.solves.empty()) return;
        std::vector<SweepSolve> solves = std::exchange(seat.solves, {});
        const std::size_t count = solves.size();
        std::sort(solves.begin(), solves.end(),
                  [](const SweepSolve& a, const SweepSolve& b) { return a.vertex < b.vertex; });
        const std::lock_guard sink_lock(sink_mutex_);
        sink_->block_finished(seat.item->task.item, std::move(solves));
        const std::lock_guard lock(mutex_);
        OpenItem& item = *seat.item;
        item.recorded += count;
        if (item.recorded == item.task.vertices.size()) {
            used_memory_ -= item.task.surface->shared_bytes();
            std::erase(open_items_, seat.item);
            sink_->item_finished(item.task.item, seconds_since(item.opened));
            report();
        }
        changed_.notify_all();
    }

    void report() {
        sink_->progress({next_source_, sources_, solves_done_, solves_known_, seconds_since(start_)});
    }

    std::size_t sources_;
    const std::function<std::vector<SweepTask>(std::size_t)>* open_;
    SweepSink* sink_;
    const SchedulerOptions* options_;
    Clock::time_point start_ = Clock::now();

    mutable std::mutex mutex_;
    std::mutex sink_mutex_;  // taken before mutex_ where both are
    std::condition_variable changed_;
    std::list<std::shared_ptr<OpenItem>> open_items_;
    std::size_t next_source_ = 0;
    bool opening_ = false;
    std::int64_t used_memory_ = 0, solves_done_ = 0, solves_known_ = 0;
    int seats_taken_ = 0;
    int threads_;
    std::exception_ptr error_;
    ExtraThreads extra_;
};

/// SplitMix64 (Steele, Lea, Flood 2014).
class SplitMix64 {
  public:
    explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    /// Uniform in [0, bound), by rejection.
    std::uint64_t below(std::uint64_t bound) {
        const std::uint64_t limit = ~std::uint64_t{0} - (~std::uint64_t{0} % bound + 1) % bound;
        std::uint64_t value = next();
        while (value > limit) value = next();
        return value % bound;
    }

  private:
    std::uint64_t state_;
};

}  // namespace

void run_sweeps(std::size_t sources, const std::function<std::vector<SweepTask>(std::size_t)>& open,
                SweepSink& sink, const SchedulerOptions& options) {
    Queue queue(sources, open, sink, options);
    run_workers(std::max(options.threads, 1), [&](int) { queue.work(); });
    queue.join();
    queue.rethrow();
}

std::vector<Index> sample_vertices(const std::vector<Index>& candidates, std::int64_t count,
                                   std::uint64_t seed) {
    std::vector<Index> drawn = candidates;
    if (count < static_cast<std::int64_t>(drawn.size())) {
        SplitMix64 random(seed);
        for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
            std::swap(drawn[k], drawn[k + static_cast<std::size_t>(random.below(drawn.size() - k))]);
        drawn.resize(static_cast<std::size_t>(count));
    }
    std::sort(drawn.begin(), drawn.end());
    return drawn;
}

}  // namespace ricci
