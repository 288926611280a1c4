#include "kernels/parallel.h"

#ifdef RICCI_PLAIN_THREADS

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace ricci {
namespace {

// Of parallel loops that this thread starts; 0: as many as the machine has.
thread_local int thread_limit = 0;

class ThreadLimit {
  public:
    explicit ThreadLimit(int limit) : before_(thread_limit) { thread_limit = limit; }
    ~ThreadLimit() { thread_limit = before_; }
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    int before_;
};

/// body(0) ... body(workers-1), each on a thread of its own, with that limit on loops inside.
void run_on_each(int workers, int limit_inside, const std::function<void(int)>& body) {
    std::exception_ptr first;
    std::mutex mutex;
    std::vector<std::thread> threads;
    threads.reserve(static_cast<std::size_t>(workers));
    for (int k = 0; k < workers; ++k)
        threads.emplace_back([&, k] {
            const ThreadLimit limit(limit_inside);
            try {
                body(k);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!first) first = std::current_exception();
            }
        });
    for (std::thread& thread : threads) thread.join();
    if (first) std::rethrow_exception(first);
}

}  // namespace

int hardware_threads() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void run_workers(int workers, const std::function<void(int)>& body) {
    run_on_each(workers, workers, body);
}

void with_thread_limit(int threads, const std::function<void()>& body) {
    const ThreadLimit limit(threads);
    body();
}

void run_on_plain_threads(std::int64_t count, const std::function<void(std::int64_t)>& run) {
    const int allowed = thread_limit > 0 ? thread_limit : hardware_threads();
    std::atomic<std::int64_t> next = 0;
    run_on_each(static_cast<int>(std::min<std::int64_t>(allowed, count)), 1, [&](int) {
        for (std::int64_t b = next++; b < count; b = next++) run(b);
    });
}

}  // namespace ricci

#else

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace ricci {

int hardware_threads() {
    return tbb::info::default_concurrency();
}

void run_workers(int workers, const std::function<void(int)>& body) {
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(workers));
    tbb::task_arena arena(workers);
    arena.execute([&] {
        tbb::task_group group;
        for (int k = 0; k < workers; ++k) group.run([&body, k] { body(k); });
        group.wait();
    });
}

void with_thread_limit(int threads, const std::function<void()>& body) {
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    arena.execute(body);
}

}  // namespace ricci

#endif
