// Sweeps of several surfaces at a time: the same rows whatever the threads, and every way to end early.
#include "engine/sweep/scheduler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "engine/surfaces/generate.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

struct Row {
    Status status;
    double area_distortion, residual_max;
    std::int32_t iterations;
    std::int64_t flips;
    std::vector<double> factor;
    bool operator==(const Row&) const = default;
};

/// Keeps everything it is told.
class Recorder : public SweepSink {
  public:
    void block_finished(std::size_t item, std::vector<SweepSolve> solves) override {
        const std::lock_guard lock(mutex_);
        ++blocks;
        EXPECT_TRUE(std::is_sorted(solves.begin(), solves.end(),
                                   [](const auto& a, const auto& b) { return a.vertex < b.vertex; }));
        for (SweepSolve& s : solves) {
            EXPECT_FALSE(finished.contains(item)) << "a block after the end of its item";
            // NaN is not equal to itself.
            const double distortion = std::isnan(s.area_distortion) ? -1.0 : s.area_distortion;
            const bool fresh = rows.emplace(std::pair(item, s.vertex),
                                            Row{s.status, distortion, s.residual_max, s.newton_iterations,
                                                s.flips, std::move(s.conformal_factor)})
                                   .second;
            EXPECT_TRUE(fresh) << "vertex " << s.vertex << " twice";
        }
        after_block();
    }
    void item_finished(std::size_t item, double seconds) override {
        const std::lock_guard lock(mutex_);
        EXPECT_GE(seconds, 0.0);
        EXPECT_TRUE(finished.insert(item).second);
    }
    void item_failed(std::size_t item, Status status, const std::string& message) override {
        const std::lock_guard lock(mutex_);
        failed[item] = {status, message};
    }
    void progress(const SchedulerProgress& p) override {
        const std::lock_guard lock(progress_mutex_);
        EXPECT_LE(p.solves_done, p.solves_known);
        EXPECT_LE(p.sources_opened, p.sources);
        last = p;
    }
    virtual void after_block() {}

    std::map<std::pair<std::size_t, Index>, Row> rows;
    std::set<std::size_t> finished;
    std::map<std::size_t, std::pair<Status, std::string>> failed;
    SchedulerProgress last;
    int blocks = 0;

  private:
    std::mutex mutex_, progress_mutex_;
};

std::shared_ptr<const SweepSurface> eight(Index faces, std::uint64_t seed,
                                          const SweepOptions& sweep = SweepOptions{}) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = 0.2;
    options.seed = seed;
    return std::make_shared<SweepSurface>(generate("eight", options), sweep);
}

/// Three sources: one surface, two surfaces (the second too small for lanes), one surface.
std::vector<SweepTask> open_sample_with(std::size_t source, const SweepOptions& options) {
    const auto task = [&](std::size_t item, Index faces, std::int64_t count) {
        auto surface = eight(faces, item, options);
        return SweepTask{item, surface, sample_vertices(surface->candidates(), count, item)};
    };
    if (source == 0) return {task(0, 1000, 30)};
    if (source == 1) return {task(1, 1300, 17), task(2, 300, 1)};
    return {task(3, 1600, 12)};
}

std::vector<SweepTask> open_sample(std::size_t source) {
    return open_sample_with(source, {});
}

TEST(Scheduler, RowsDoNotDependOnThreadsOrBlocks) {
    Recorder reference;
    run_sweeps(3, open_sample, reference, {});
    EXPECT_EQ(reference.rows.size(), 60U);
    EXPECT_EQ(reference.finished, (std::set<std::size_t>{0, 1, 2, 3}));
    EXPECT_EQ(reference.last.solves_done, 60);
    EXPECT_EQ(reference.last.sources_opened, 3U);
    for (const auto& [key, row] : reference.rows) EXPECT_EQ(row.status, Status::converged);
    for (const int threads : {1, 2, 3})
        for (const double block_seconds : {1e-6, 0.05, 100.0}) {
            SchedulerOptions options;
            options.threads = threads;
            options.block_seconds = block_seconds;
            Recorder recorder;
            run_sweeps(3, open_sample, recorder, options);
            EXPECT_TRUE(recorder.rows == reference.rows)
                << threads << " threads, blocks of " << block_seconds;
            EXPECT_EQ(recorder.finished, reference.finished);
        }
}

TEST(Scheduler, ThreadsMayBeAddedOnTheWay) {
    Recorder reference;
    run_sweeps(3, open_sample, reference, {});
    /// Keeps the threads that solve, and the starts of solves.
    class Threads : public Recorder {
      public:
        void solve_started(std::size_t item, Index vertex) override {
            std::unique_lock lock(mutex_);
            ids.insert(std::this_thread::get_id());
            EXPECT_TRUE(started.emplace(item, vertex).second);
            changed_.notify_all();
            // The first thread leaves work for those that are still to come.
            if (started.size() == 20)
                changed_.wait_for(lock, std::chrono::minutes(1), [&] { return ids.size() > 1; });
        }
        std::set<std::thread::id> ids;
        std::set<std::pair<std::size_t, Index>> started;

      private:
        std::mutex mutex_;
        std::condition_variable changed_;
    };
    Threads recorder;
    SchedulerOptions options;
    std::atomic<int> asked = 0;
    options.grant = [&] { return ++asked < 10 ? 1 : 3; };
    run_sweeps(3, open_sample, recorder, options);
    EXPECT_TRUE(recorder.rows == reference.rows);
    EXPECT_EQ(recorder.finished, reference.finished);
    EXPECT_EQ(recorder.started.size(), recorder.rows.size());
    EXPECT_GT(recorder.ids.size(), 1U);
    EXPECT_LE(recorder.ids.size(), 3U);
}

TEST(Scheduler, RowsDoNotDependOnLanes) {
    Recorder reference;
    run_sweeps(3, open_sample, reference, {});
    SweepOptions sweep;
    for (const int lanes : {1, 3, 7})
        for (const int threads : {1, 2, 3}) {
            sweep.lanes = lanes;
            SchedulerOptions options;
            options.threads = threads;
            Recorder recorder;
            run_sweeps(
                3, [&](std::size_t source) { return open_sample_with(source, sweep); }, recorder, options);
            EXPECT_TRUE(recorder.rows == reference.rows) << lanes << " lanes, " << threads << " threads";
        }
}

TEST(Scheduler, TheNewtonSolverGivesTheSameRowsForAnyThreads) {
    SweepOptions sweep;
    sweep.solver = SweepSolverKind::newton;
    const auto open = [&](std::size_t source) { return open_sample_with(source, sweep); };
    Recorder reference;
    run_sweeps(3, open, reference, {});
    EXPECT_EQ(reference.rows.size(), 60U);
    SchedulerOptions options;
    options.threads = 3;
    options.block_seconds = 1e-6;
    Recorder recorder;
    run_sweeps(3, open, recorder, options);
    EXPECT_TRUE(recorder.rows == reference.rows);
}

TEST(Scheduler, UsesFewerLanesWhereMemoryIsShort) {
    const auto surface = eight(1000, 0);
    ASSERT_GT(surface->lanes(), 1);
    ASSERT_LT(surface->worker_bytes(1), surface->worker_bytes(2));
    const auto open = [&](std::size_t) {
        return std::vector<SweepTask>{{0, surface, sample_vertices(surface->candidates(), 40, 1)}};
    };
    Recorder reference;
    run_sweeps(1, open, reference, {});
    for (const int lanes : {1, 2, 5}) {
        SchedulerOptions options;
        options.threads = 2;
        options.max_memory = surface->shared_bytes() + surface->worker_bytes(lanes);
        Recorder recorder;
        run_sweeps(1, open, recorder, options);
        EXPECT_TRUE(recorder.rows == reference.rows) << lanes;
        --options.max_memory;
        Recorder less;
        run_sweeps(1, open, less, options);
        EXPECT_EQ(less.failed.size(), lanes == 1 ? 1U : 0U);
    }
}

TEST(Scheduler, SourcesAreOpenedInOrderOneAtATime) {
    std::vector<std::size_t> opened;
    std::atomic<int> inside = 0;
    Recorder recorder;
    SchedulerOptions options;
    options.threads = 3;
    run_sweeps(
        3,
        [&](std::size_t source) {
            EXPECT_EQ(++inside, 1);
            opened.push_back(source);
            auto tasks = open_sample(source);
            --inside;
            return tasks;
        },
        recorder, options);
    EXPECT_EQ(opened, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(Scheduler, ItemsWithoutVerticesAreFinishedAtOnce) {
    Recorder recorder;
    run_sweeps(2,
               [](std::size_t source) {
                   return std::vector<SweepTask>{{source, eight(300, 1), {}}};
               },
               recorder, {});
    EXPECT_EQ(recorder.finished, (std::set<std::size_t>{0, 1}));
    EXPECT_TRUE(recorder.rows.empty());
}

TEST(Scheduler, RefusesWhatDoesNotFitIntoMemory) {
    SchedulerOptions options;
    const auto small = eight(400, 0);
    options.max_memory = 2 * (small->shared_bytes() + small->worker_bytes());
    ASSERT_LT(options.max_memory, eight(8000, 1)->worker_bytes());
    const auto open = [&](std::size_t source) {
        return std::vector<SweepTask>{{source, source == 1 ? eight(8000, 1) : small, {3, 4, 5, 6}}};
    };
    for (const int threads : {1, 3}) {
        options.threads = threads;
        Recorder recorder;
        run_sweeps(3, open, recorder, options);
        EXPECT_EQ(recorder.finished, (std::set<std::size_t>{0, 2}));
        ASSERT_EQ(recorder.failed.size(), 1U);
        EXPECT_EQ(recorder.failed[1].first, Status::out_of_memory);
        EXPECT_NE(recorder.failed[1].second.find("--max-memory"), std::string::npos);
        EXPECT_EQ(recorder.rows.size(), 8U);
    }
}

TEST(Scheduler, TimeoutsConcernOneSolve) {
    SchedulerOptions options;
    options.timeout_seconds = 1e-9;
    Recorder recorder;
    run_sweeps(3, open_sample, recorder, options);
    EXPECT_EQ(recorder.rows.size(), 60U);
    EXPECT_EQ(recorder.finished.size(), 4U);
    for (const auto& [key, row] : recorder.rows) {
        EXPECT_EQ(row.status, Status::timeout);
        EXPECT_EQ(row.area_distortion, -1.0);
    }
}

TEST(Scheduler, CancellationHandsOverWhatIsFinished) {
    Recorder reference;
    run_sweeps(3, open_sample, reference, {});
    for (const int threads : {1, 2}) {
        std::atomic<bool> stop = false;
        class Stopper : public Recorder {
          public:
            explicit Stopper(std::atomic<bool>& stop_flag) : stop_(&stop_flag) {}
            void after_block() override {
                if (blocks == 3) *stop_ = true;
            }

          private:
            std::atomic<bool>* stop_;
        } recorder(stop);
        SchedulerOptions options;
        options.threads = threads;
        options.block_seconds = 1e-6;
        options.stop = [&] { return stop.load(); };
        run_sweeps(3, open_sample, recorder, options);
        EXPECT_GE(recorder.rows.size(), 3U);
        EXPECT_LT(recorder.rows.size(), 60U);
        for (const auto& [key, row] : recorder.rows) EXPECT_TRUE(row == reference.rows.at(key));
    }
    // Stopped before it began.
    SchedulerOptions options;
    options.stop = [] { return true; };
    Recorder recorder;
    run_sweeps(3, open_sample, recorder, options);
    EXPECT_TRUE(recorder.rows.empty());
    EXPECT_TRUE(recorder.finished.empty());
}

TEST(Scheduler, ExceptionsOfTheSinkAndOfOpenComeThrough) {
    class Full : public Recorder {
      public:
        void after_block() override {
            if (blocks == 2) throw std::runtime_error("disk full");
        }
    };
    for (const int threads : {1, 2, 3}) {
        SchedulerOptions options;
        options.threads = threads;
        options.block_seconds = 1e-6;
        Full sink;
        try {
            run_sweeps(3, open_sample, sink, options);
            ADD_FAILURE() << "no exception";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "disk full");
        }
        EXPECT_LT(sink.rows.size(), 60U);
        Recorder recorder;
        EXPECT_THROW(run_sweeps(
                         3,
                         [](std::size_t source) {
                             if (source == 1) throw std::logic_error("open");
                             return open_sample(source);
                         },
                         recorder, options),
                     std::logic_error);
    }
}

/// SplitMix64 as its authors publish it, for the draws below.
std::uint64_t split_mix(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
}

TEST(SampleVertices, FollowsSplitMix64) {
    std::uint64_t state = 0;
    const std::uint64_t known[] = {0xe220a8397b1dcdaf, 0x6e789e6aa1b965f4, 0x06c45d188009454f};
    std::vector<Index> drawn(1000);
    for (Index v = 0; v < 1000; ++v) drawn[static_cast<std::size_t>(v)] = v;
    std::vector<Index> candidates = drawn;
    // Fisher-Yates by hand with the published outputs (none is near 2^64, so that rejection plays no part).
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(split_mix(state), known[k]);
        std::swap(drawn[k], drawn[k + known[k] % (1000 - k)]);
    }
    drawn.resize(3);
    std::sort(drawn.begin(), drawn.end());
    EXPECT_EQ(sample_vertices(candidates, 3, 0), drawn);
}

TEST(SampleVertices, DrawsWithoutReplacementAscendingAndSmallerSamplesAreParts) {
    std::vector<Index> candidates;
    candidates.reserve(500);
    for (Index v = 0; v < 500; ++v) candidates.push_back(3 * v + 1);
    for (const std::uint64_t seed : {0U, 1U, 77U}) {
        std::vector<Index> previous;
        for (const std::int64_t count : {0, 1, 10, 100, 499, 500}) {
            const auto sample = sample_vertices(candidates, count, seed);
            EXPECT_EQ(sample.size(), static_cast<std::size_t>(count));
            EXPECT_TRUE(std::is_sorted(sample.begin(), sample.end()));
            EXPECT_EQ(std::adjacent_find(sample.begin(), sample.end()), sample.end());
            EXPECT_TRUE(std::includes(candidates.begin(), candidates.end(), sample.begin(), sample.end()));
            EXPECT_TRUE(std::includes(sample.begin(), sample.end(), previous.begin(), previous.end()));
            previous = sample;
        }
    }
    EXPECT_NE(sample_vertices(candidates, 20, 0), sample_vertices(candidates, 20, 1));
    EXPECT_EQ(sample_vertices(candidates, 501, 5), candidates);
    EXPECT_EQ(sample_vertices(candidates, 1'000'000, 5), candidates);
    EXPECT_TRUE(sample_vertices({}, 5, 0).empty());
}

}  // namespace
}  // namespace ricci
