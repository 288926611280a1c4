// Many tasks, each in a child process of its own: processors and memory shared out, the dead and the silent
// noticed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "engine/app/isolation/child_process.h"

namespace ricci::app {

/// First messages between a pool and its children; the rest is the tasks' own, from `first_own` on.
enum class PoolMessage : std::uint32_t {
    job = 1,    // to the child: what it is to do
    reply,      // to the child: the answer to what it asked
    threads,    // to the child: i4, so many threads may be busy now
    alive,      // from the child: a sign of life
    first_own,  // ...
};

/// What a child gets.
struct ChildShare {
    int threads = 1;
    std::int64_t memory = 0;  // bytes; 0: no limit
    bool whole = false;       // all of it, with no other child beside it
};

/// A child that is told to end (SIGINT, SIGTERM) while the run goes on is started again so often, before its
/// task is blamed.
inline constexpr int kStartsAgain = 3;

/// Whose tasks they are. Calls come one at a time, from the thread of run_isolated(). std::invalid_argument
/// and ProtocolError out of message() are the child's fault and its end; other exceptions end the run.
class IsolatedWork {
  public:
    enum class Verdict : std::uint8_t {
        finished,  // the task is done with
        again,     // in a fresh child
        alone      // again, when nothing else runs or waits, with all processors and memory
    };

    virtual ~IsolatedWork() = default;
    /// False: not before another task has gone on.
    virtual bool may_start(std::size_t task) = 0;
    /// The contents of its first message; nothing: it needs no child.
    virtual std::optional<std::string> job(std::size_t task, const ChildShare& share) = 0;
    /// A message from the child; `reply` answers it.
    virtual void message(std::size_t task, const Frame& frame,
                         const std::function<void(std::string_view)>& reply) = 0;
    virtual Verdict ended(std::size_t task, const ChildEnd& end, const ChildShare& share) = 0;
    /// Now and then, at least ten times a second.
    virtual void tick() = 0;
};

/// Whether a child that ran out of memory, or was killed by the kernel, may have done so because of what it
/// shared with others.
bool deserves_all(const ChildEnd& end, const ChildShare& share);

struct IsolationOptions {
    int threads = 1;              // busy at a time, over all children
    std::int64_t max_memory = 0;  // bytes, over all children; 0: no limit
    double hang_seconds = 0.0;    // a child that sends nothing for so long is killed; 0: never
    std::function<bool()> stop;   // a signal: children are told, and killed when they do not listen
};

/// Runs tasks 0 ... count - 1, started in this order as far as may_start() lets them. While tasks wait a
/// child gets one thread, or more when there are fewer tasks than threads; what becomes free at the end goes
/// to those that still run. No child outlives the call, nor the process.
void run_isolated(std::size_t count, IsolatedWork& work, const IsolationOptions& options);

}  // namespace ricci::app
