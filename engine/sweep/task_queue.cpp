#include "engine/sweep/task_queue.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

#include "kernels/parallel.h"

namespace ricci {
namespace {

using Clock = std::chrono::steady_clock;

/// What all threads draw from. Tasks run outside of the mutex; hand-overs are one at a time.
class TaskQueue {
  public:
    TaskQueue(std::size_t count, const std::function<bool(std::size_t)>& work,
              const std::function<void(const std::vector<std::size_t>&)>& finished,
              const std::function<std::int64_t(std::size_t)>& bytes, const TaskQueueOptions& options)
        : count_(count), work_(&work), finished_(&finished), bytes_(&bytes), options_(&options) {}

    void run() {
        try {
            while (const std::optional<std::size_t> task = next()) {
                const bool done = run_one(*task);
                if (done) take_in(*task);
            }
        } catch (...) {
            fail();
        }
    }

    /// Hands over what is left; after an error as well, whose exception goes first.
    void finish() {
        try {
            hand_over();
        } catch (...) {
            fail();
        }
        if (error_) std::rethrow_exception(error_);
    }

  private:
    [[nodiscard]] bool stopped() const { return error_ || (options_->stop && options_->stop()); }

    void fail() {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        changed_.notify_all();
    }

    std::optional<std::size_t> next() {
        std::unique_lock lock(mutex_);
        while (!stopped() && next_ < count_) {
            const std::int64_t need = options_->max_memory > 0 ? (*bytes_)(next_) : 0;
            if (running_ == 0 || used_ + need <= options_->max_memory || options_->max_memory <= 0) {
                used_ += need;
                ++running_;
                return next_++;
            }
            changed_.wait_for(lock, std::chrono::milliseconds(100));
        }
        return std::nullopt;
    }

    bool run_one(std::size_t task) {
        const auto give_back = [&] {
            const std::lock_guard lock(mutex_);
            used_ -= options_->max_memory > 0 ? (*bytes_)(task) : 0;
            --running_;
            changed_.notify_all();
        };
        try {
            const bool done = (*work_)(task);
            give_back();
            return done;
        } catch (...) {
            give_back();
            throw;
        }
    }

    void take_in(std::size_t task) {
        bool due = false;
        {
            const std::lock_guard lock(mutex_);
            done_.push_back(task);
            const double waited = std::chrono::duration<double>(Clock::now() - handed_over_).count();
            due = done_.size() >= options_->block_tasks || waited > options_->block_seconds;
            if (due) handed_over_ = Clock::now();
        }
        if (due) hand_over();
    }

    void hand_over() {
        const std::lock_guard one_at_a_time(finish_mutex_);
        std::vector<std::size_t> tasks;
        {
            const std::lock_guard lock(mutex_);
            tasks = std::exchange(done_, {});
        }
        if (tasks.empty()) return;
        std::sort(tasks.begin(), tasks.end());
        (*finished_)(tasks);
    }

    std::size_t count_;
    const std::function<bool(std::size_t)>* work_;
    const std::function<void(const std::vector<std::size_t>&)>* finished_;
    const std::function<std::int64_t(std::size_t)>* bytes_;
    const TaskQueueOptions* options_;

    std::mutex mutex_, finish_mutex_;  // the latter is taken first where both are
    std::condition_variable changed_;
    std::size_t next_ = 0;
    int running_ = 0;
    std::int64_t used_ = 0;
    std::vector<std::size_t> done_;
    Clock::time_point handed_over_ = Clock::now();
    std::exception_ptr error_;
};

}  // namespace

void run_tasks(std::size_t count, const std::function<bool(std::size_t)>& work,
               const std::function<void(const std::vector<std::size_t>&)>& finished,
               const std::function<std::int64_t(std::size_t)>& bytes, const TaskQueueOptions& options) {
    TaskQueue queue(count, work, finished, bytes, options);
    const auto threads =
        std::clamp<std::size_t>(count, 1, static_cast<std::size_t>(std::max(options.threads, 1)));
    if (threads == 1)
        queue.run();  // on this thread, so that what is parallel within a task stays so
    else
        run_workers(static_cast<int>(threads), [&](int) { queue.run(); });
    queue.finish();
}

}  // namespace ricci
