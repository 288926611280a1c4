#include "engine/sweep/task_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace ricci {
namespace {

using Tasks = std::vector<std::size_t>;

std::int64_t no_bytes(std::size_t /*task*/) {
    return 0;
}

TEST(TaskQueue, HandsEveryTaskOverOnceInBlocks) {
    for (const int threads : {1, 3}) {
        TaskQueueOptions options;
        options.threads = threads;
        options.block_tasks = 10;
        options.block_seconds = 1e9;
        std::vector<int> worked(205, 0), handed(205, 0);
        std::size_t blocks = 0;
        std::atomic<int> inside = 0;
        run_tasks(
            205,
            [&](std::size_t task) {
                ++worked[task];
                return true;
            },
            [&](const Tasks& tasks) {
                EXPECT_EQ(++inside, 1) << "one hand-over at a time";
                EXPECT_TRUE(std::is_sorted(tasks.begin(), tasks.end()));
                ++blocks;
                for (const std::size_t task : tasks) {
                    EXPECT_EQ(worked[task], 1);
                    ++handed[task];
                }
                --inside;
            },
            no_bytes, options);
        EXPECT_EQ(handed, std::vector<int>(205, 1));
        EXPECT_LE(blocks, 21U);
        if (threads == 1) {
            EXPECT_EQ(blocks, 21U);
        }
    }
}

TEST(TaskQueue, BlocksAreHandedOverAfterATimeToo) {
    TaskQueueOptions options;
    options.block_seconds = 0.0;
    std::size_t blocks = 0;
    run_tasks(
        7, [](std::size_t) { return true; }, [&](const Tasks& tasks) { blocks += tasks.size() == 1 ? 1 : 0; },
        no_bytes, options);
    EXPECT_EQ(blocks, 7U);
}

TEST(TaskQueue, AStopKeepsWhatIsFinishedAndDropsWhatWasCancelled) {
    TaskQueueOptions options;
    bool stop = false;
    options.stop = [&] { return stop; };
    Tasks handed;
    run_tasks(
        100,
        [&](std::size_t task) {
            stop = task == 5;
            return task != 5;
        },
        [&](const Tasks& tasks) { handed.insert(handed.end(), tasks.begin(), tasks.end()); }, no_bytes,
        options);
    EXPECT_EQ(handed, (Tasks{0, 1, 2, 3, 4}));
}

TEST(TaskQueue, AnExceptionComesThroughAfterFinishedTasksAreHandedOver) {
    for (const int threads : {1, 3}) {
        TaskQueueOptions options;
        options.threads = threads;
        std::atomic<int> done = 0;
        std::size_t handed = 0;
        EXPECT_THROW(run_tasks(
                         1000,
                         [&](std::size_t task) -> bool {
                             if (task == 20) throw std::runtime_error("lost");
                             ++done;
                             return true;
                         },
                         [&](const Tasks& tasks) { handed += tasks.size(); }, no_bytes, options),
                     std::runtime_error);
        EXPECT_EQ(handed, static_cast<std::size_t>(done));
        EXPECT_LT(done, 1000);
    }
    const auto full = [](const Tasks&) { throw std::runtime_error("disk full"); };
    TaskQueueOptions options;
    options.block_tasks = 4;
    std::size_t worked = 0;
    EXPECT_THROW(run_tasks(
                     1000, [&](std::size_t) { return ++worked > 0; }, full, no_bytes, options),
                 std::runtime_error);
    EXPECT_EQ(worked, 4U) << "nothing is started when results are lost";
}

TEST(TaskQueue, TasksThatDoNotFitWaitAndALargeOneRunsAlone) {
    TaskQueueOptions options;
    options.threads = 4;
    options.max_memory = 100;
    std::atomic<std::int64_t> used = 0, most = 0;
    const auto bytes = [](std::size_t task) -> std::int64_t { return task == 6 ? 500 : 40; };
    std::atomic<int> running = 0;
    std::size_t handed = 0;
    run_tasks(
        20,
        [&](std::size_t task) {
            used += bytes(task);
            const int others = running++;
            if (task == 6)
                EXPECT_EQ(others, 0);
            else
                most = std::max<std::int64_t>(most, used);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            used -= bytes(task);
            --running;
            return true;
        },
        [&](const Tasks& tasks) { handed += tasks.size(); }, bytes, options);
    EXPECT_EQ(handed, 20U);
    EXPECT_LE(most, 100);
}

}  // namespace
}  // namespace ricci
