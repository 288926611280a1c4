// What `ricci submit` accepts and writes, and its array script with a stand-in for the sweep and for Slurm.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "engine/app/console.h"
#include "engine/app/slurm_scripts.h"
#include "tests/support/program.h"

namespace ricci {
namespace {

using ricci::testing::make;
using ricci::testing::ProgramResult;
using ricci::testing::read_text;
using ricci::testing::run_program;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;
using ricci::testing::write_text;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

ProgramResult dry_submit(const TemporaryFolder& folder, const Words& more) {
    Words words{"submit", "--slurm", "--shards", "2", "--dry-run", "-o", folder / "out.h5"};
    words.insert(words.end(), more.begin(), more.end());
    return run_ricci(folder, words);
}

TEST(Submit, RefusesWhatEveryShardWouldRefuse) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 300), config = folder / "sweep.toml";
    for (const char* text :
         {"[run]\nthreads = -1\n", "[input]\ncomponent = 0\n", "[run]\nmax_memory = \"much\"\n"}) {
        write_text(config, text);
        for (const Words& words : {Words{"sweep", "--shard", "0/2", "-o", folder / "s.h5"}, Words{}}) {
            Words all = words;
            all.insert(all.end(), {mesh, "--config", config});
            const ProgramResult result = words.empty() ? dry_submit(folder, all) : run_ricci(folder, all);
            EXPECT_EQ(result.status, 2) << text << result.err;
        }
    }
    EXPECT_FALSE(fs::exists(folder / "out.h5.shards"));
    EXPECT_EQ(dry_submit(folder, {mesh}).status, 0);
}

TEST(Submit, TheTimeLimitExceedsTheGrace) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 300);
    const ProgramResult refused = dry_submit(folder, {mesh, "--time", "2", "--grace", "120"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("--time 2 is 120 s: not larger than --grace"), std::string::npos)
        << refused.err;
    EXPECT_EQ(dry_submit(folder, {mesh, "--time", "soon"}).status, 2);
    EXPECT_EQ(dry_submit(folder, {mesh, "--time", "0:02:01", "--grace", "120"}).status, 0);
}

TEST(Submit, ReadsTimeLimitsAsSbatchDoes) {
    using app::seconds_of_time_limit;
    EXPECT_EQ(seconds_of_time_limit("90"), 5400);
    EXPECT_EQ(seconds_of_time_limit("1:30"), 120) << "minutes:seconds, up to a minute";
    EXPECT_EQ(seconds_of_time_limit("4:00:00"), 14400);
    EXPECT_EQ(seconds_of_time_limit("1-12"), 129600);
    EXPECT_EQ(seconds_of_time_limit("1-0:30"), 88200);
    EXPECT_EQ(seconds_of_time_limit("2-01:00:10"), 176460);
    for (const char* none : {"0", "UNLIMITED", "infinite"}) EXPECT_FALSE(seconds_of_time_limit(none)) << none;
    for (const char* wrong : {"", "x", "1:2:3:4", "1-", "1-2-3", "-5", "4h", "1:"})
        EXPECT_THROW(seconds_of_time_limit(wrong), app::UsageError) << wrong;
}

TEST(Submit, HandsTheChoiceOfProcessorOn) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 300), script = folder / "out.h5.shards/array.sh";
    // The machine's own choice, where it has made one, is none of this test's.
    ::unsetenv("RICCI_INSTRUCTION_SET");
    ::unsetenv("OPENBLAS_CORETYPE");
    ASSERT_EQ(dry_submit(folder, {mesh}).status, 0);
    EXPECT_EQ(read_text(script).find("export "), std::string::npos);
    ::setenv("RICCI_INSTRUCTION_SET", "avx2", 1);
    ::setenv("OPENBLAS_CORETYPE", "Haswell", 1);
    const ProgramResult result = dry_submit(folder, {mesh});
    ::unsetenv("RICCI_INSTRUCTION_SET");
    ::unsetenv("OPENBLAS_CORETYPE");
    EXPECT_EQ(result.status, 0) << result.err;
    const std::string text = read_text(script);
    EXPECT_NE(text.find("\nexport RICCI_INSTRUCTION_SET='avx2'\nexport OPENBLAS_CORETYPE='Haswell'\n"),
              std::string::npos)
        << text;
}

/// Runs a task's script, its time limit near after a second. `sweep` stands in for the program: $4 is where
/// its journal is.
ProgramResult near_the_limit(const TemporaryFolder& folder, const std::string& sweep, int restarts) {
    app::SlurmJob job;
    job.program = folder / "sweep";
    job.folder = folder / "shards";
    fs::create_directories(job.folder + "/shard-0000-of-0001.h5.parts");
    const std::string journal = job.folder + "/shard-0000-of-0001.h5.parts/journal";
    write_text(journal, "begun\n");
    write_text(job.program, "#!/bin/bash\njournal=" + journal + "\n" + sweep);
    write_text(folder / "scontrol", "#!/bin/bash\necho \"asked: $*\"\nkill -TERM $PPID\n");
    for (const std::string& program : {job.program, folder / "scontrol"})
        fs::permissions(program, fs::perms::owner_all);
    write_text(folder / "array.sh", app::array_script(job));
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", (folder / "" + ":" + path).c_str(), 1);
    ::setenv("SLURM_ARRAY_JOB_ID", "7", 1);
    ::setenv("SLURM_ARRAY_TASK_ID", "0", 1);
    ::setenv("SLURM_RESTART_COUNT", std::to_string(restarts).c_str(), 1);
    ProgramResult result = run_program(folder, {"/bin/bash", folder / "array.sh"}, 1000, SIGUSR1);
    for (const char* name : {"SLURM_ARRAY_JOB_ID", "SLURM_ARRAY_TASK_ID", "SLURM_RESTART_COUNT"})
        ::unsetenv(name);
    ::setenv("PATH", path.c_str(), 1);
    return result;
}

constexpr const char* kStuck = "trap 'exit 143' TERM\nfor ((k = 0; k < 200; ++k)); do sleep 0.1; done\n";
constexpr const char* kWorking =
    "echo line >> $journal\ntrap 'exit 143' TERM\nfor ((k = 0; k < 200; ++k)); do sleep 0.1; done\n";
constexpr const char* kWorkingAtLast =
    "trap 'echo line >> $journal; exit 143' TERM\nfor ((k = 0; k < 200; ++k)); do sleep 0.1; done\n";

TEST(Submit, ATaskWithoutProgressIsNotQueuedForEver) {
    const TemporaryFolder folder;
    const std::string asked = "asked: requeue 7_0";
    const ProgramResult stuck = near_the_limit(folder, kStuck, 2);
    EXPECT_EQ(stuck.status, 1) << stuck.out;
    EXPECT_NE(stuck.out.find("no progress in one time limit: give more --time"), std::string::npos)
        << stuck.out;
    EXPECT_EQ(stuck.out.find(asked), std::string::npos) << stuck.out;
    for (const auto& [sweep, restarts] :
         {std::pair(kStuck, 1), std::pair(kWorking, 5), std::pair(kWorkingAtLast, 5)}) {
        const ProgramResult queued = near_the_limit(folder, sweep, restarts);
        EXPECT_EQ(queued.status, 143) << queued.out;
        EXPECT_NE(queued.out.find(asked), std::string::npos) << sweep << queued.out;
    }
}

}  // namespace
}  // namespace ricci
