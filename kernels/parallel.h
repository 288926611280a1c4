// The one header through which the project uses threads.
#pragma once

#ifndef RICCI_PLAIN_THREADS
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#endif

#include <algorithm>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace ricci {

// The thread sanitizer does not see what TBB's own code synchronises, and would report races that are none.
// With RICCI_PLAIN_THREADS the same functions run on plain threads; nothing else of the project knows of it.

/// Threads this process may use (affinity and cgroup limits respected).
int hardware_threads();

/// Runs body(0) … body(workers-1), at most so many at a time, and waits. A body may wait for another one's
/// progress only if that one is running already. The first exception is rethrown.
void run_workers(int workers, const std::function<void(int)>& body);

/// Threads that join workers under way, for a process that is given more processors as it runs. Their bodies
/// must not throw. Destruction waits for them.
class ExtraThreads {
  public:
    void start(std::function<void()> body) { threads_.emplace_back(std::move(body)); }
    [[nodiscard]] int count() const { return static_cast<int>(threads_.size()); }

  private:
    std::vector<std::jthread> threads_;
};

/// Runs `body` with parallel loops inside it limited to `threads`.
void with_thread_limit(int threads, const std::function<void()>& body);

#ifdef RICCI_PLAIN_THREADS
/// run(0) ... run(count-1) on as many threads as with_thread_limit allows here.
void run_on_plain_threads(std::int64_t count, const std::function<void(std::int64_t)>& run);
#endif

/// Calls body(begin, end) over [0, count) in fixed blocks of `block`; in parallel where asked and worth it.
/// Blocks do not depend on the number of threads, so a body whose blocks are independent gives the same bits
/// always.
template <class Body>
void for_blocks(std::int64_t count, std::int64_t block, bool parallel, Body&& body) {
    const std::int64_t blocks = (count + block - 1) / block;
    const auto run = [&](std::int64_t b) { body(b * block, std::min(count, (b + 1) * block)); };
    if (!parallel || blocks < 2) {
        for (std::int64_t b = 0; b < blocks; ++b) run(b);
        return;
    }
#ifdef RICCI_PLAIN_THREADS
    run_on_plain_threads(blocks, run);
#else
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, blocks),
                      [&](const tbb::blocked_range<std::int64_t>& range) {
                          for (std::int64_t b = range.begin(); b != range.end(); ++b) run(b);
                      });
#endif
}

}  // namespace ricci
