#include "engine/app/isolation/child_pool.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <list>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace ricci::app {
namespace {

using Clock = std::chrono::steady_clock;

/// After it was told to stop, and before it is killed.
constexpr double kPatience = 5.0;
/// A parent that has not looked for so long was stopped itself, and its children with it.
constexpr double kSuspended = 2.0;
/// Memory is looked at so often; also the longest wait for messages.
constexpr int kWeighing = 50;  // milliseconds

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A child at work.
struct Running {
    std::size_t task = 0;
    ChildShare share;
    std::unique_ptr<ChildProcess> child;
    Clock::time_point heard = Clock::now();
    KilledFor killed_for = KilledFor::nothing;
    std::string reason;
    bool spoken = false, in_company = false;

    void kill(KilledFor why, std::string words) {
        if (killed_for != KilledFor::nothing) return;
        killed_for = why;
        reason = std::move(words);
        child->signal_group(SIGKILL);
    }
};

class Pool {
  public:
    Pool(std::size_t count, IsolatedWork& work, const IsolationOptions& options)
        : work_(&work), options_(&options), free_(std::max(options.threads, 1)) {
        for (std::size_t task = 0; task < count; ++task) waiting_.push_back(task);
    }

    void run() {
        for (;;) {
            stop_when_asked();
            if (!stopping_) start_some();
            if (running_.empty()) return;
            listen();
            reap();
            work_->tick();
        }
    }

  private:
    void stop_when_asked() {
        if (stopping_ || !options_->stop || !options_->stop()) return;
        stopping_ = true;
        stopped_at_ = Clock::now();
        for (const Running& running : running_) running.child->signal_group(SIGTERM);
    }

    void start(std::size_t task, int threads) {
        Running running;
        running.task = task;
        const int all = std::max(options_->threads, 1);
        running.share = {threads, options_->max_memory / all * threads, threads == all};
        if (running.share.whole) running.share.memory = options_->max_memory;
        const std::optional<std::string> job = work_->job(task, running.share);
        if (!job) return;
        running.child = std::make_unique<ChildProcess>(std::vector<std::string>{"isolated-child"});
        running.child->send(static_cast<std::uint32_t>(PoolMessage::job), *job);
        free_ -= threads;
        running_.push_back(std::move(running));
        for (Running& each : running_) each.in_company = each.in_company || running_.size() > 1;
    }

    void start_some() {
        for (auto task = waiting_.begin(); task != waiting_.end() && free_ > 0;) {
            if (!work_->may_start(*task)) {
                ++task;
                continue;
            }
            const std::size_t next = *task;
            const int share =
                std::max(1, free_ / static_cast<int>(std::min<std::size_t>(waiting_.size(), 4096)));
            task = waiting_.erase(task);
            start(next, share);
        }
        if (running_.empty() && !alone_.empty()) {
            const std::size_t next = alone_.front();
            alone_.pop_front();
            start(next, free_);
        }
        if (waiting_.empty()) grant();
    }

    /// Threads that nobody waits for go to the children with the fewest.
    void grant() {
        while (free_ > 0 && !running_.empty()) {
            const auto poorest = std::min_element(
                running_.begin(), running_.end(),
                [](const Running& a, const Running& b) { return a.share.threads < b.share.threads; });
            --free_;
            ++poorest->share.threads;
            poorest->child->send(static_cast<std::uint32_t>(PoolMessage::threads),
                                 MessageWriter().put(poorest->share.threads).bytes());
        }
    }

    /// Waits for something to happen, not for long, and takes in what the children say.
    void listen() {
        std::vector<pollfd> polled;
        bool dying = false;
        for (const Running& running : running_) {
            const short events = running.child->has_unsent() ? POLLIN | POLLOUT : POLLIN;
            dying = dying || running.child->messages() < 0;
            polled.push_back({running.child->messages(), events, 0});
            polled.push_back({running.child->errors(), POLLIN, 0});
        }
        ::poll(polled.data(), polled.size(), dying ? 5 : kWeighing);
        forgive_suspension();
        for (Running& running : running_) {
            running.child->send_more();
            if (running.child->receive()) {
                running.heard = Clock::now();
                running.spoken = true;
                take_messages(running);
            } else {
                look_after(running);
            }
            if (stopping_ && seconds_since(stopped_at_) > kPatience)
                running.kill(KilledFor::not_ending, "it was told to stop");
        }
        if (seconds_since(weighed_) * 1000.0 >= kWeighing) weigh();
    }

    /// SIGSTOP, a suspended job: the children could not speak either.
    void forgive_suspension() {
        const Clock::time_point now = Clock::now();
        const auto gap = now - std::exchange(listened_, now);
        if (std::chrono::duration<double>(gap).count() < kSuspended) return;
        for (Running& running : running_) running.heard = std::min(now, running.heard + gap);
        if (stopping_) stopped_at_ = std::min(now, stopped_at_ + gap);
    }

    void look_after(Running& running) const {
        const double hang = options_->hang_seconds;
        if (hang > 0.0 && seconds_since(running.heard) > hang)
            running.kill(KilledFor::silence, fmt::format("no sign of life for {:g} s", hang));
    }

    void weigh() {
        weighed_ = Clock::now();
        for (Running& running : running_) {
            const std::int64_t limit = running.share.memory;
            if (limit <= 0) continue;
            const std::int64_t used = running.child->memory();
            if (used > limit)
                running.kill(KilledFor::memory,
                             fmt::format("{} MB of memory in use, {} allowed", used >> 20, limit >> 20));
        }
    }

    void take_messages(Running& running) {
        // Of one gone astray nothing is believed any more; whole frames of another are sound.
        if (running.killed_for == KilledFor::astray) return;
        const auto reply = [&](std::string_view bytes) {
            running.child->send(static_cast<std::uint32_t>(PoolMessage::reply), bytes);
        };
        try {
            while (const auto frame = running.child->next_message())
                if (frame->kind != static_cast<std::uint32_t>(PoolMessage::alive))
                    work_->message(running.task, *frame, reply);
        } catch (const ProtocolError& e) {
            running.kill(KilledFor::astray, e.what());
        } catch (const std::invalid_argument& e) {
            running.kill(KilledFor::astray, e.what());
        }
    }

    void reap() {
        for (auto running = running_.begin(); running != running_.end();) {
            if (!running->child->has_ended()) {
                ++running;
                continue;
            }
            while (running->child->receive()) {
                running->spoken = true;
                take_messages(*running);
            }
            Running ended = std::move(*running);
            running = running_.erase(running);
            free_ += ended.share.threads;
            conclude(ended);
        }
    }

    void conclude(Running& ended) {
        ChildEnd end = ended.child->end();
        if (!ended.spoken && end.exit_status == kExitNotStarted)
            throw FileError(own_program() + ": cannot be started as a child process");
        end.killed_for = ended.killed_for;
        end.reason = ended.reason;
        // A signal to all processes of a job may end a child before it reaches this one, or one child alone.
        stop_when_asked();
        const bool told = !stopping_ && end.told_to_end() && told_[ended.task]++ < kStartsAgain;
        end.stopped = stopping_;
        end.in_company = ended.in_company;
        switch (told ? IsolatedWork::Verdict::again : work_->ended(ended.task, end, ended.share)) {
            case IsolatedWork::Verdict::finished:
                break;
            case IsolatedWork::Verdict::again:
                waiting_.push_front(ended.task);
                break;
            case IsolatedWork::Verdict::alone:
                alone_.push_back(ended.task);
                break;
        }
    }

    IsolatedWork* work_;
    const IsolationOptions* options_;
    int free_;
    std::list<std::size_t> waiting_, alone_;
    std::list<Running> running_;
    bool stopping_ = false;
    Clock::time_point stopped_at_, weighed_ = Clock::now(), listened_ = Clock::now();
    std::map<std::size_t, int> told_;  // times that a task's child was told to end by others
};

}  // namespace

bool deserves_all(const ChildEnd& end, const ChildShare& share) {
    const bool by_kernel = end.signal == SIGKILL && end.killed_for == KilledFor::nothing;
    const bool pressed = by_kernel ? end.in_company : share.memory > 0;
    return end.out_of_memory() && pressed && !share.whole;
}

void run_isolated(std::size_t count, IsolatedWork& work, const IsolationOptions& options) {
    Pool(count, work, options).run();
}

}  // namespace ricci::app
