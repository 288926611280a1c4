#include "kernels/parallel.h"

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
