#include "engine/sweep/scheduler.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <new>

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
    std::size_t next = 0;        // first vertex not handed out
    std::size_t solved = 0;      // finished and handed over
    double solve_seconds = 0.0;  // of those, for the size of the next block
    Clock::time_point opened = Clock::now();

    [[nodiscard]] bool has_work() const { return next < task.vertices.size(); }
};

/// A block of vertices of one item: [begin, end) of task.vertices.
struct Block {
    std::shared_ptr<OpenItem> item;
    std::size_t begin = 0, end = 0;
};

/// What one thread holds between blocks.
struct Seat {
    std::shared_ptr<OpenItem> item;
    std::unique_ptr<SweepWorker> worker;
};

/// The queue all threads draw from. Its state is under one mutex; opening items and solving happen outside of
/// it. Memory: a thread gives its worker back before it waits, so those who wait hold nothing.
class Queue {
  public:
    Queue(std::size_t sources, const std::function<std::vector<SweepTask>(std::size_t)>& open,
          SweepSink& sink, const SchedulerOptions& options)
        : sources_(sources), open_(&open), sink_(&sink), options_(&options) {}

    void work() {
        Seat seat;
        try {
            while (auto block = next(seat)) solve(*block, seat);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!error_) error_ = std::current_exception();
        }
        leave(seat);
    }

    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    [[nodiscard]] bool stopped() const { return error_ || (options_->stop && options_->stop()); }

    void leave(Seat& seat) {
        if (!seat.item) return;
        seat.worker.reset();
        const std::lock_guard lock(mutex_);
        used_memory_ -= seat.item->task.surface->worker_bytes();
        --seats_taken_;
        seat.item.reset();
        changed_.notify_all();
    }

    [[nodiscard]] bool fits(const OpenItem& item) const {
        return options_->max_memory <= 0 || seats_taken_ == 0 ||
               used_memory_ + item.task.surface->worker_bytes() <= options_->max_memory;
    }

    std::optional<Block> next(Seat& seat) {
        {
            const std::lock_guard lock(mutex_);
            if (!stopped() && seat.item && seat.item->has_work()) return take(seat.item);
        }
        leave(seat);
        std::unique_lock lock(mutex_);
        while (!stopped()) {
            const auto found = std::find_if(open_items_.begin(), open_items_.end(), [&](const auto& item) {
                return item->has_work() && fits(*item);
            });
            if (found != open_items_.end()) {
                seat.item = *found;
                used_memory_ += seat.item->task.surface->worker_bytes();
                ++seats_taken_;
                return take(seat.item);
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
        return std::nullopt;
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
        const std::int64_t need = surface.shared_bytes() + surface.worker_bytes();
        if (task.vertices.empty()) {
            sink_->item_finished(task.item, 0.0);
        } else if (options_->max_memory > 0 && need > options_->max_memory) {
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
        }
    }

    Block take(const std::shared_ptr<OpenItem>& item) {
        // About block_seconds of work, but small enough that the end of an item is shared evenly.
        const std::size_t left = item->task.vertices.size() - item->next;
        std::size_t size = 4;
        if (item->solved > 0 && item->solve_seconds > 0.0) {
            const double mean = item->solve_seconds / static_cast<double>(item->solved);
            size = static_cast<std::size_t>(std::clamp(options_->block_seconds / mean, 1.0, 1024.0));
        }
        const auto threads = static_cast<std::size_t>(std::max(options_->threads, 1));
        size = std::clamp<std::size_t>(size, 1, std::max<std::size_t>(1, left / threads));
        Block block{item, item->next, item->next + size};
        item->next += size;
        return block;
    }

    void solve(const Block& block, Seat& seat) {
        std::vector<SweepSolve> solves;
        if (!seat.worker) seat.worker = std::make_unique<SweepWorker>(seat.item->task.surface);
        for (std::size_t k = block.begin; k < block.end; ++k) {
            const auto start = Clock::now();
            const auto interrupted = [&]() -> std::optional<Status> {
                if (options_->stop && options_->stop()) return Status::cancelled;
                if (options_->timeout_seconds > 0.0 && seconds_since(start) > options_->timeout_seconds)
                    return Status::timeout;
                return std::nullopt;
            };
            SweepSolve solved;
            try {
                solved = seat.worker->solve(block.item->task.vertices[k], interrupted);
            } catch (const std::bad_alloc&) {
                solved.vertex = block.item->task.vertices[k];
                solved.status = Status::out_of_memory;
                solved.area_distortion = std::nan("");
                solved.message = "memory ran out during the solve";
                seat.worker = std::make_unique<SweepWorker>(seat.item->task.surface);
            }
            if (solved.status == Status::cancelled) break;
            solves.push_back(std::move(solved));
            tick();
        }
        hand_over(block, std::move(solves));
    }

    void tick() {
        const std::lock_guard lock(mutex_);
        ++solves_done_;
        report();
    }

    void hand_over(const Block& block, std::vector<SweepSolve> solves) {
        const std::size_t count = solves.size();
        double seconds = 0.0;
        for (const SweepSolve& s : solves) seconds += s.seconds;
        const std::lock_guard sink_lock(sink_mutex_);
        if (count > 0) sink_->block_finished(block.item->task.item, std::move(solves));
        const std::lock_guard lock(mutex_);
        OpenItem& item = *block.item;
        item.solved += count;
        item.solve_seconds += seconds;
        if (item.solved == item.task.vertices.size()) {
            used_memory_ -= item.task.surface->shared_bytes();
            std::erase(open_items_, block.item);
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
    std::exception_ptr error_;
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
