// Many independent tasks on several threads, finished ones handed over in blocks.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace ricci {

struct TaskQueueOptions {
    int threads = 1;
    std::int64_t max_memory = 0;   // bytes of the tasks under way; 0: no limit
    double block_seconds = 3.0;    // finished tasks are handed over about this often,
    std::size_t block_tasks = 64;  // or when there are so many
    std::function<bool()> stop;    // a signal: start no more, hand over what is finished
};

/// Runs work(i) for i = 0 .. count - 1, started in ascending order. work() returns false when it was
/// cancelled: the task counts as not done. finished(tasks) gets the numbers of tasks that are done, each
/// once, ascending within a block, one call at a time. `bytes(i)` predicts a task's memory, where there is a
/// limit: a task waits until it fits, or until nothing else runs. An exception of work() or finished() stops
/// everything and comes through, after what is finished has been handed over, as far as that succeeds.
void run_tasks(std::size_t count, const std::function<bool(std::size_t)>& work,
               const std::function<void(const std::vector<std::size_t>&)>& finished,
               const std::function<std::int64_t(std::size_t)>& bytes, const TaskQueueOptions& options);

}  // namespace ricci
