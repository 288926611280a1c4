// Calls into the engine that may take long: off the interpreter's lock, ended by Ctrl-C, watched by a
// callback.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

#include "engine/app/console.h"
#include "engine/flow/newton.h"

namespace ricci::python {

using Progress = std::variant<IterationLog, SchedulerProgress>;

/// What a call under way and its caller say to each other. The engine's side may be used from any thread.
class Call {
  public:
    /// True once the call is to end: asked by the engine between its steps.
    [[nodiscard]] std::function<bool()> stop() const {
        return [this] { return stopped_.load(std::memory_order_relaxed); };
    }
    /// How far it is; the caller sees the latest only.
    void report(const Progress& progress);

    // The caller's side.
    void end() { stopped_ = true; }
    std::optional<Progress> take_progress();

  private:
    std::atomic<bool> stopped_{false};
    std::mutex mutex_;
    std::optional<Progress> latest_;
};

/// Reports the progress of a sweep, or of an index, to a call.
class ReportedProgress final : public app::ProgressLine {
  public:
    explicit ReportedProgress(Call& call) : ProgressLine(true), call_(&call) {}
    void show(const SchedulerProgress& progress) override { call_->report(progress); }

  private:
    Call* call_;
};

/// Runs work(call) on a thread of its own and waits without the interpreter's lock. Twenty times a second the
/// calling thread lets Python handle signals, hands log messages to Python's `logging`, and calls
/// `progress` (None: nothing) with what was reported last; also once at the end. What one of these raises
/// (Ctrl-C: KeyboardInterrupt) ends the work, and is raised when that has ended. Exceptions of the work come
/// through. OpenBLAS runs one thread meanwhile.
void run_call(const pybind11::object& progress, const std::function<void(Call&)>& work);

/// The same with a result.
template <class Work>
auto run_long(const pybind11::object& progress, Work&& work) {
    std::optional<decltype(work(std::declval<Call&>()))> result;
    run_call(progress, [&](Call& call) { result.emplace(work(call)); });
    return std::move(*result);
}

/// Sends what the project logs to Python's logger "ricci", by way of run_call.
void set_up_log();

/// Whether the OpenBLAS of this process is safe for several callers at a time; true where there is none.
bool blas_is_safe();

}  // namespace ricci::python
