// Sweeps on a real Slurm: started by the test, two nodes on this machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <iostream>
#include <memory>

#include "io/store/run_store.h"
#include "tests/support/digests.h"
#include "tests/support/program.h"
#include "tests/support/slurm_cluster.h"

namespace ricci {
namespace {

using namespace ricci::testing;
using Words = std::vector<std::string>;
using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class Slurm : public ::testing::Test {
  protected:
    void SetUp() override {
        if (const std::string lacking = no_slurm(); !lacking.empty()) GTEST_SKIP() << lacking;
        cluster_ = std::make_unique<SlurmCluster>();
    }

    /// Submits a sweep to `output` and returns what `ricci submit --json` says.
    nlohmann::json submit(const Words& sweep, const std::string& output, int shards) {
        Words words{"submit", "--slurm", "--json", "-q", "--shards", std::to_string(shards), "-o", output};
        words.insert(words.end(), sweep.begin(), sweep.end());
        const ProgramResult result = run_ricci(folder_, words);
        EXPECT_EQ(result.status, 0) << result.err;
        return objects(result.out).at(0);
    }

    static std::string logs_of(const std::string& folder) {
        std::string text;
        std::set<std::string> paths;
        for (const auto& entry : fs::directory_iterator(folder + "/logs"))
            paths.insert(entry.path().string());
        for (const std::string& path : paths) text += path + ":\n" + read_text(path);
        return text;
    }

    int run_here(const Words& sweep, const std::string& output) {
        Words words{"sweep", "-q", "-o", output};
        words.insert(words.end(), sweep.begin(), sweep.end());
        return run_ricci(folder_, words).status;
    }

    TemporaryFolder folder_;
    std::unique_ptr<SlurmCluster> cluster_;
};

TEST_F(Slurm, AnArrayJobOverTwoNodesEqualsTheRunHere) {
    write_text(folder_ / "broken.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n");
    const Words sweep{make(folder_, "eight", 1500),
                      make(folder_, "pants", 600),
                      folder_ / "broken.off",
                      make(folder_, "sphere", 200),
                      "--vertices",
                      "sample:60",
                      "--resolutions",
                      "input,500"};
    const auto start = Clock::now();
    const nlohmann::json job = submit(sweep, folder_ / "cluster.h5", 4);
    const std::string shards = job["folder"];
    ASSERT_EQ(cluster_->wait_for_job(job["merge_job"]), "COMPLETED") << logs_of(shards);
    std::cout << "array of 4 tasks and merge: " << seconds_since(start) << " s\n";
    const std::string logs = logs_of(shards);
    for (const char* words : {"shard 0/4, start 1, 1 CPUs", "shard 3/4, start 1", " on n1: ", " on n2: "})
        EXPECT_NE(logs.find(words), std::string::npos) << words << " is not in\n" << logs;
    ASSERT_EQ(run_here(sweep, folder_ / "here.h5"), 1) << "two of the files cannot be swept";
    EXPECT_EQ(digests(folder_ / "cluster.h5"), digests(folder_ / "here.h5"));
    EXPECT_EQ(read_run(folder_ / "cluster.h5").info.config.find("shard = \"0"), std::string::npos);

    // Once more: nothing is done twice. Another configuration: refused.
    const nlohmann::json again = submit(sweep, folder_ / "cluster.h5", 4);
    ASSERT_EQ(cluster_->wait_for_job(again["merge_job"]), "COMPLETED");
    EXPECT_NE(logs_of(shards).find("finished before"), std::string::npos);
    Words retrying = sweep;
    retrying.emplace_back("--retry-failed");
    const nlohmann::json retry = submit(retrying, folder_ / "cluster.h5", 4);
    ASSERT_EQ(cluster_->wait_for_job(retry["merge_job"]), "COMPLETED") << logs_of(shards);
    const std::string log = read_text(shards + "/logs/" + retry["array_job"].get<std::string>() + "_0.log");
    EXPECT_EQ(log.find("finished before"), std::string::npos) << log;
    EXPECT_EQ(digests(folder_ / "cluster.h5"), digests(folder_ / "here.h5"));
    EXPECT_EQ(
        run_ricci(folder_, {"submit", "--slurm", "--shards", "5", "-o", folder_ / "cluster.h5", sweep[0]})
            .status,
        2);
}

/// The file of a shard, and what its journal says so far.
std::string shard_path(const std::string& folder, int shard, int shards) {
    const std::string numbers =
        std::to_string(10000 + shard).substr(1) + "-of-" + std::to_string(10000 + shards).substr(1);
    return folder + "/shard-" + numbers + ".h5";
}
bool journal_has(const std::string& shard, const std::string& kind) {
    return read_text(shard + ".parts/journal").find("\"kind\":\"" + kind + "\"") != std::string::npos;
}

TEST_F(Slurm, ADeadNodesTaskGoesOnOnTheOther) {
    // Some ten seconds of work for each of the two tasks.
    const Words sweep{make(folder_, "eight", 20000), "--vertices", "sample:6000"};
    const nlohmann::json job = submit(sweep, folder_ / "cluster.h5", 2);
    const std::string shards = job["folder"], array = job["array_job"];
    // Which task runs on n1 is Slurm's choice.
    std::string task;
    cluster_->wait_until([&] {
        task = SlurmCluster::output("squeue -h -t RUNNING -w n1 -o %K -j " + array);
        return !task.empty();
    });
    const std::string shard = shard_path(shards, std::atoi(task.c_str()), 2);
    // In the middle of the task: once it has stored rows, or some time after its mesh.
    cluster_->wait_until([&] { return journal_has(shard, "item"); });
    const auto stored = Clock::now();
    cluster_->wait_until([&] { return journal_has(shard, "sweep") || seconds_since(stored) > 8.0; });
    ASSERT_FALSE(fs::exists(shard)) << "the task was over before its node could die";
    const auto killed = Clock::now();
    cluster_->kill_node("n1");
    auto here = std::async(std::launch::async, [&] { return run_here(sweep, folder_ / "here.h5"); });
    cluster_->wait_until(
        [&] { return SlurmCluster::output("sinfo -h -n n1 -o %T").find("down") != std::string::npos; });
    const double noticed = seconds_since(killed);
    const std::string log =
        shards + "/logs/" + array + "_" + std::to_string(std::atoi(task.c_str())) + ".log";
    cluster_->wait_until([&] { return read_text(log).find(", start 2, ") != std::string::npos; });
    const double restarted = seconds_since(killed);
    ASSERT_EQ(cluster_->wait_for_job(job["merge_job"]), "COMPLETED") << logs_of(shards);
    std::cout << "node down after " << noticed << " s, its task again after " << restarted
              << " s, merged after " << seconds_since(killed) << " s\n";
    EXPECT_NE(read_text(log).find(" on n2: shard"), std::string::npos) << read_text(log);
    ASSERT_EQ(here.get(), 0);
    EXPECT_EQ(digests(folder_ / "cluster.h5"), digests(folder_ / "here.h5"));
}

}  // namespace
}  // namespace ricci
