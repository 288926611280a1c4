// A sweep in several parts: planned, killed, resumed, joined; equal to the whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "engine/app/sweep_plan.h"
#include "io/store/run_store.h"
#include "kernels/instruction_set.h"
#include "tests/support/digests.h"
#include "tests/support/program.h"

namespace ricci {
namespace {

using ricci::testing::digests;
using ricci::testing::make;
using ricci::testing::objects;
using ricci::testing::ProgramResult;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;
using ricci::testing::write_text;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

/// The program with a fault of io/store/durable.h.
ProgramResult run_with_fault(const TemporaryFolder& folder, const Words& words, const std::string& fault) {
    ::setenv("RICCI_FAULT", fault.c_str(), 1);
    ProgramResult result = run_ricci(folder, words);
    ::unsetenv("RICCI_FAULT");
    return result;
}

/// Everything that makes joining hard: equal names in several folders, several components, a file that is
/// broken, surfaces that admit no cone, one that cannot have a resolution, and one far larger than the rest.
Words hard_data_set(const TemporaryFolder& folder) {
    for (const char* sub : {"a", "b", "c"}) fs::create_directory(folder / sub);
    const auto put = [&](const std::string& surface, int faces, const std::string& where) {
        fs::rename(make(folder, surface, faces), folder / where);
    };
    put("eight", 2500, "a/x.off");
    put("eight", 700, "b/x.off");
    fs::copy_file(folder / "b/x.off", folder / "c/x.off");
    put("torus", 300, "a/torus.off");
    put("pants", 500, "b/pants.off");
    write_text(folder / "c/broken.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n");
    EXPECT_EQ(run_ricci(folder, {"generate", "bolza", "--faces", "256", "-o", folder / "c/bolza.len"}).status,
              0);
    // Two tetrahedra: two items of genus 0.
    write_text(folder / "b/two.off",
               "OFF\n8 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n5 0 0\n6 0 0\n5 1 0\n5 0 2\n"
               "3 4 6 5\n3 4 5 7\n3 5 6 7\n3 6 4 7\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    return {"sweep",      folder / "a",    folder / "b",   folder / "missing.off",
            folder / "c", "--vertices",    "sample:100:3", "--keep",
            "2",          "--resolutions", "input,600",    "--threads",
            "2"};
}

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

std::string shard_file(const TemporaryFolder& folder, int i, int count) {
    return folder / ("s" + std::to_string(i) + "of" + std::to_string(count) + ".h5");
}

/// Runs shard i and returns the words that make it.
Words run_shard(const TemporaryFolder& folder, const Words& sweep, int i, int count) {
    const Words words = with(sweep, {"--shard", std::to_string(i) + "/" + std::to_string(count), "-o",
                                     shard_file(folder, i, count), "--resume"});
    const ProgramResult result = run_ricci(folder, words);
    EXPECT_LE(result.status, 1) << result.err;
    return words;
}

std::vector<std::string> item_names(const std::string& path) {
    std::vector<std::string> names;
    for (const StoredItem& item : read_run(path).items) names.push_back(item.item.name);
    return names;
}

TEST(Shards, MergedEqualTheUndividedRun) {
    const TemporaryFolder folder;
    const Words sweep = hard_data_set(folder);
    const Words whole = with(sweep, {"-o", folder / "whole.h5"});
    ASSERT_EQ(run_ricci(folder, whole).status, 1);
    const auto expected = digests(folder / "whole.h5");
    const std::vector<std::string> names = item_names(folder / "whole.h5");
    EXPECT_EQ(std::count(names.begin(), names.end(), "x@600~3"), 1) << "three files, one name";
    for (const int count : {1, 5}) {
        Words merge{"merge", "-o", folder / "merged.h5", "--json"};
        for (int i = 0; i < count; ++i) {
            run_shard(folder, sweep, i, count);
            merge.push_back(shard_file(folder, i, count));
        }
        std::reverse(merge.end() - count, merge.end());
        const ProgramResult merged = run_ricci(folder, merge);
        ASSERT_EQ(merged.status, 1) << merged.err;
        EXPECT_EQ(objects(merged.out).at(0)["shards"], count);
        EXPECT_EQ(digests(folder / "merged.h5"), expected) << count << " shards";
        EXPECT_EQ(item_names(folder / "merged.h5"), names);
        EXPECT_EQ(run_ricci(folder, {"verify", folder / "merged.h5"}).status, 0);
    }
    // In child processes, some of the shards and all.
    for (const int isolated : {1, 3}) {
        Words merge{"merge", "-o", folder / "merged.h5"};
        for (int i = 0; i < 3; ++i) {
            fs::remove(shard_file(folder, i, 3));
            run_shard(folder, i < isolated ? with(sweep, {"--isolate"}) : sweep, i, 3);
            merge.push_back(shard_file(folder, i, 3));
        }
        const ProgramResult merged = run_ricci(folder, merge);
        ASSERT_EQ(merged.status, 1) << merged.err;
        EXPECT_EQ(digests(folder / "merged.h5"), expected) << isolated << " of 3 shards isolated";
        EXPECT_EQ(item_names(folder / "merged.h5"), names);
    }
    // The joined file is a finished run like any other.
    EXPECT_EQ(read_run(folder / "merged.h5").info.fingerprint,
              read_run(folder / "whole.h5").info.fingerprint);
    const ProgramResult again = run_ricci(folder, with(sweep, {"-o", folder / "merged.h5", "--resume"}));
    EXPECT_EQ(again.status, 1) << again.err;
    EXPECT_EQ(digests(folder / "merged.h5"), expected);
}

TEST(Shards, KilledShardsResumeAndKilledMergesLeaveNothingHalf) {
    const TemporaryFolder folder;
    const Words sweep{"sweep", make(folder, "eight", 1500), "--vertices", "sample:200", "--threads", "2"};
    ASSERT_EQ(run_ricci(folder, with(sweep, {"-o", folder / "whole.h5"})).status, 0);
    const Words first = with(sweep, {"--shard", "0/2", "-o", shard_file(folder, 0, 2), "--resume"});
    const Words merge{"merge", shard_file(folder, 0, 2), shard_file(folder, 1, 2), "-o",
                      folder / "merged.h5"};
    for (const char* fault : {"segment_written:2", "journal_half:1", "assembled:1"}) {
        EXPECT_EQ(run_with_fault(folder, first, fault).status, 128 + SIGKILL) << fault;
        EXPECT_TRUE(fs::exists(shard_file(folder, 0, 2) + ".parts/journal")) << fault;
    }
    run_shard(folder, sweep, 1, 2);
    const ProgramResult refused = run_ricci(folder, merge);
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find(shard_file(folder, 0, 2) + ": unfinished"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("missing shard 0/2"), std::string::npos) << refused.err;
    EXPECT_FALSE(fs::exists(folder / "merged.h5"));
    EXPECT_EQ(run_ricci(folder, first).status, 0);

    EXPECT_EQ(run_with_fault(folder, merge, "assembled:1").status, 128 + SIGKILL);
    EXPECT_FALSE(fs::exists(folder / "merged.h5"));
    EXPECT_EQ(run_ricci(folder, merge).status, 0);
    EXPECT_EQ(digests(folder / "merged.h5"), digests(folder / "whole.h5"));
    EXPECT_FALSE(fs::exists(folder / "merged.h5.parts"));
}

TEST(Shards, AFolderOfShardsIsJoinedAndTheMissingNamed) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "shards");
    const Words sweep{"sweep", make(folder, "eight", 600), "--vertices", "sample:40", "-q"};
    for (const char* i : {"0", "2"})
        ASSERT_EQ(run_ricci(folder, with(sweep, {"--shard", i + std::string("/3"), "-o",
                                                 folder / ("shards/" + std::string(i) + ".h5")}))
                      .status,
                  0);
    const ProgramResult r = run_ricci(folder, {"merge", folder / "shards", "-o", folder / "whole.h5"});
    EXPECT_EQ(r.status, 2);
    EXPECT_NE(r.err.find("missing shard 1/3"), std::string::npos) << r.err;
    ASSERT_EQ(run_ricci(folder, with(sweep, {"--shard", "1/3", "-o", folder / "shards/1.h5"})).status, 0);
    EXPECT_EQ(run_ricci(folder, {"merge", folder / "shards", "-o", folder / "whole.h5"}).status, 0);
    EXPECT_EQ(run_ricci(folder, {"merge", folder / "shards/0.h5", "-o", folder / "shards/0.h5"}).status, 2)
        << "a shard is not overwritten by the whole";
}

TEST(Shards, InputsThatChangedAreNoticed) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 600), other = make(folder, "pants", 500);
    const Words sweep{"sweep", mesh, other, "--vertices", "sample:40", "-q"};
    const Words first = with(sweep, {"--shard", "0/2", "-o", folder / "0.h5", "--resume"});
    EXPECT_EQ(run_with_fault(folder, first, "assembled:1").status, 128 + SIGKILL);
    fs::rename(make(folder, "genus-g-one-boundary", 900), mesh);
    const ProgramResult resumed = run_ricci(folder, first);
    EXPECT_EQ(resumed.status, 2) << "another surface is no continuation of this run";
    fs::remove_all(folder / "0.h5.parts");
    EXPECT_EQ(run_ricci(folder, first).status, 0);
    fs::rename(make(folder, "punctured-torus", 400), mesh);
    EXPECT_EQ(run_ricci(folder, with(sweep, {"--shard", "1/2", "-o", folder / "1.h5"})).status, 0);
    const ProgramResult merged =
        run_ricci(folder, {"merge", folder / "0.h5", folder / "1.h5", "-o", folder / "whole.h5"});
    EXPECT_EQ(merged.status, 2);
    EXPECT_NE(merged.err.find("input files were not the same"), std::string::npos) << merged.err;
}

/// Runs `count` shards, merges them, and returns what the merge said.
ProgramResult merged_shards(const TemporaryFolder& folder, const Words& sweep, int count) {
    Words merge{"merge", "-o", folder / "merged.h5"};
    for (int i = 0; i < count; ++i) {
        run_shard(folder, sweep, i, count);
        merge.push_back(shard_file(folder, i, count));
    }
    return run_ricci(folder, merge);
}

/// A surface that cannot be resampled would have had the name that another file's item has.
TEST(Shards, AFailureDoesNotTakeTheNameOfAnotherFilesItem) {
    const TemporaryFolder folder;
    for (const char* sub : {"a", "b", "c"}) fs::create_directory(folder / sub);
    ASSERT_EQ(run_ricci(folder, {"generate", "bolza", "--faces", "256", "-o", folder / "a/scan.len"}).status,
              0);
    fs::rename(make(folder, "eight", 700), folder / "b/scan.off");
    fs::copy_file(folder / "b/scan.off", folder / "c/scan.off");
    const std::string a = folder / "a/scan.len", b = folder / "b/scan.off", c = folder / "c/scan.off";
    for (const Words& order : {Words{a, b, c}, Words{b, a, c}, Words{b, c, a}}) {
        for (const char* name : {"whole.h5", "s0of2.h5", "s1of2.h5"}) fs::remove(folder / name);
        const Words sweep = with(with({"sweep"}, order),
                                 {"--vertices", "sample:20", "--resolutions", "300", "--threads", "1"});
        ASSERT_EQ(run_ricci(folder, with(sweep, {"-o", folder / "whole.h5"})).status, 1);
        const ProgramResult merged = merged_shards(folder, sweep, 2);
        ASSERT_EQ(merged.status, 1) << merged.err;
        EXPECT_NE(merged.out.find("2 items, 40 rows"), std::string::npos) << merged.out;
        EXPECT_EQ(digests(folder / "merged.h5"), digests(folder / "whole.h5"));
        const FailureRecord failure = read_run(folder / "merged.h5").failures.at(0);
        EXPECT_EQ(failure.item, read_run(folder / "whole.h5").failures.at(0).item);
        EXPECT_EQ(failure.stage, "resample");
    }
}

TEST(Shards, OtherContentsOfTheSameSizeAreNoticed) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 800);
    // Too little to be cut: each shard has one resolution, and no mesh of the other's.
    const Words sweep{"sweep", mesh, "--vertices", "sample:10", "--resolutions", "input,700", "-q"};
    run_shard(folder, sweep, 0, 2);
    std::string text = testing::read_text(mesh);
    const std::size_t digit = text.find('.') + 3;
    text[digit] = text[digit] == '5' ? '4' : '5';
    write_text(mesh, text);
    run_shard(folder, sweep, 1, 2);
    for (const int i : {0, 1}) EXPECT_EQ(item_names(shard_file(folder, i, 2)).size(), 1U);
    const ProgramResult merged = run_ricci(
        folder, {"merge", shard_file(folder, 0, 2), shard_file(folder, 1, 2), "-o", folder / "merged.h5"});
    EXPECT_EQ(merged.status, 2);
    EXPECT_NE(merged.err.find(mesh + ": shards 1/2 and 0/2 read different contents"), std::string::npos)
        << merged.err;
    EXPECT_FALSE(fs::exists(folder / "merged.h5.parts"));
}

TEST(Shards, ThePlanDependsOnTheListOfVertices) {
    const TemporaryFolder folder;
    const std::string list = folder / "vertices.txt";
    const std::vector<std::string> files{make(folder, "eight", 600)};
    app::SweepConfig config;
    config.vertices = list;
    config.shard = "0/2";
    std::vector<std::string> plans;
    for (const char* vertices : {"5\n7\n9\n", "9\n5\n7\n", "5\n7\n8\n"}) {
        write_text(list, vertices);
        plans.push_back(app::SweepPlan(config, files, 1).digest());
    }
    EXPECT_EQ(plans[0], plans[1]);
    EXPECT_NE(plans[0], plans[2]);
}

/// A shard that dies of an item before it knows its vertices does not hold the others up.
TEST(Shards, AnItemThatOneShardCouldNotPrepareIsAFailureAndCanBeTriedAgain) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 800);
    const Words sweep{"sweep", mesh, "--vertices", "sample:60", "--threads", "1"};
    ASSERT_EQ(run_ricci(folder, with(sweep, {"-o", folder / "whole.h5"})).status, 0);
    const Words second = with(sweep, {"--shard", "1/2", "-o", shard_file(folder, 1, 2)});
    EXPECT_EQ(run_with_fault(folder, second, "prepare:1:throw").status, 1);
    const ProgramResult merged = merged_shards(folder, sweep, 2);
    ASSERT_EQ(merged.status, 1) << merged.err;
    EXPECT_NE(merged.err.find("without the rows of shards 1/2"), std::string::npos) << merged.err;
    const StoredRun run = read_run(folder / "merged.h5");
    ASSERT_EQ(run.failures.size(), 1U);
    EXPECT_EQ(run.failures[0].status, "internal_error");
    EXPECT_GT(run.items.at(0).sweep->rows.size(), 0U);
    EXPECT_LT(run.items.at(0).sweep->rows.size(), 60U);

    EXPECT_EQ(run_ricci(folder, with(second, {"--retry-failed"})).status, 0);
    EXPECT_EQ(merged_shards(folder, sweep, 2).status, 0);
    EXPECT_EQ(digests(folder / "merged.h5"), digests(folder / "whole.h5"));
}

/// A file that cannot be loaded for the plan counts by its size, and so does one that is too large for that.
TEST(Shards, ThePlanSurvivesWhatItCannotLoad) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 800);
    const Words sweep{"sweep", mesh, "--vertices", "sample:60", "--threads", "1"};
    ASSERT_EQ(run_ricci(folder, with(sweep, {"-o", folder / "whole.h5"})).status, 0);
    Words merge{"merge", "-o", folder / "merged.h5"};
    for (int i = 0; i < 2; ++i) {
        merge.push_back(shard_file(folder, i, 2));
        const ProgramResult shard = run_with_fault(
            folder, with(sweep, {"--shard", std::to_string(i) + "/2", "-o", merge.back()}), "plan:1:throw");
        EXPECT_EQ(shard.status, 0) << shard.err;
        EXPECT_NE(shard.err.find("topology of 0 files and the size of 1"), std::string::npos) << shard.err;
    }
    EXPECT_EQ(run_ricci(folder, merge).status, 0);
    EXPECT_EQ(digests(folder / "merged.h5"), digests(folder / "whole.h5"));

    write_text(folder / "large.off", "OFF\n");
    fs::resize_file(folder / "large.off", 400'000'000);  // no bytes on disk
    app::SweepConfig config;
    config.shard = "0/2";
    const app::SweepPlan plan(config, {mesh, folder / "large.off"}, 64);
    EXPECT_NE(plan.division().find("topology of 1 files and the size of 1"), std::string::npos)
        << plan.division();
}

TEST(Shards, OtherKindsOfProcessorsAreNamed) {
    if (best_instruction_set() == InstructionSet::baseline) GTEST_SKIP() << "there is but one set";
    const TemporaryFolder folder;
    const Words sweep{"sweep", make(folder, "eight", 800), "--vertices", "sample:60", "--threads", "1"};
    const Words first = with(sweep, {"--shard", "0/2", "-o", shard_file(folder, 0, 2), "--resume"});
    ASSERT_EQ(merged_shards(folder, sweep, 2).err.find("kind of processor"), std::string::npos);

    fs::remove(shard_file(folder, 0, 2));
    ::setenv("RICCI_INSTRUCTION_SET", "baseline", 1);
    const ProgramResult stopped = run_with_fault(folder, first, "segment_written:2");
    ::unsetenv("RICCI_INSTRUCTION_SET");
    EXPECT_EQ(stopped.status, 128 + SIGKILL);
    const ProgramResult resumed = run_ricci(folder, first);
    EXPECT_EQ(resumed.status, 0);
    EXPECT_NE(resumed.err.find("begun on another kind of processor (lanes baseline"), std::string::npos)
        << resumed.err;
    const ProgramResult merged = merged_shards(folder, sweep, 2);
    EXPECT_EQ(merged.status, 0) << merged.err;
    EXPECT_NE(merged.err.find("not all on one kind of processor: lanes "), std::string::npos) << merged.err;
    EXPECT_NE(merged.err.find("; lanes baseline"), std::string::npos) << merged.err;
}

/// How much of each unit the shards have, and what their plans say of themselves.
void expect_cover(const app::SweepConfig& config, const std::vector<std::string>& files, int shards) {
    const std::size_t resolutions = config.resolutions.size();
    std::vector<std::uint32_t> covered(files.size() * resolutions, 0);
    std::set<std::string> plans;
    for (int i = 0; i < shards; ++i) {
        app::SweepConfig own = config;
        own.shard = std::to_string(i) + "/" + std::to_string(shards);
        const app::SweepPlan plan(own, files, 2);
        plans.insert(plan.digest());
        std::size_t files_with_parts = 0;
        for (std::size_t f = 0; f < files.size(); ++f) {
            bool any = false;
            for (std::size_t r = 0; r < resolutions; ++r) {
                const WorkPart* part = plan.part(f, r);
                if (part == nullptr) continue;
                any = true;
                covered[f * resolutions + r] += part->last - part->first;
            }
            files_with_parts += any ? 1 : 0;
        }
        EXPECT_EQ(plan.files().size(), files_with_parts) << "a shard opens no file that it has no part of";
    }
    EXPECT_EQ(plans.size(), 1U) << "all shards have the same plan";
    for (const std::uint32_t parts : covered) EXPECT_EQ(parts, kWholeUnit);
}

TEST(Shards, ThePlanCoversTheWorkOnce) {
    const TemporaryFolder folder;
    app::SweepConfig config;
    config.resolutions = {"input", "400"};
    std::vector<std::string> files{make(folder, "eight", 4000), make(folder, "sphere", 200),
                                   folder / "missing.off"};
    expect_cover(config, files, 5);
    config.vertices = "sample:10";
    expect_cover(config, files, 5);
    // More files than are loaded for a plan.
    const std::string small = make(folder, "genus-g", 300);
    for (int k = 0; k < 1200; ++k) {
        files.push_back(folder / ("copy" + std::to_string(k) + ".off"));
        fs::create_hard_link(small, files.back());
    }
    config.vertices = "all";
    expect_cover(config, files, 2);
}

/// Closed spheres take no time, however large: the plan knows their topology.
TEST(Shards, ThePlanKnowsWhatCannotBeSwept) {
    const TemporaryFolder folder;
    const std::vector<std::string> files{make(folder, "sphere", 20000), make(folder, "eight", 1000)};
    app::SweepConfig config;
    std::vector<double> whole;
    for (const char* shard : {"0/2", "1/2"}) {
        config.shard = shard;
        const app::SweepPlan plan(config, files, 1);
        const WorkPart* part = plan.part(1, 0);
        ASSERT_NE(part, nullptr) << "the only work is shared";
        whole.push_back(static_cast<double>(part->last - part->first) / kWholeUnit);
    }
    EXPECT_NEAR(whole[0] + whole[1], 1.0, 1e-12);
    EXPECT_LT(std::max(whole[0], whole[1]), 0.8);
}

TEST(Shards, DryRunTellsTheShare) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 1000);
    const ProgramResult r = run_ricci(folder, {"sweep", mesh, "--shard", "1/4", "--dry-run"});
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_NE(r.err.find("shard 1/4: 1 of 1 files, 1 in part"), std::string::npos) << r.err;
    EXPECT_EQ(run_ricci(folder, {"sweep", mesh, "--shard", "4/4"}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"sweep", mesh, "--shard", "x"}).status, 2);
}

/// More shards than work: some have nothing to do, and say so in a file of their own.
TEST(Shards, MoreShardsThanWork) {
    const TemporaryFolder folder;
    const Words sweep{"sweep", make(folder, "eight", 400), "--vertices", "sample:20"};
    ASSERT_EQ(run_ricci(folder, with(sweep, {"-o", folder / "whole.h5"})).status, 0);
    Words merge{"merge", "-o", folder / "merged.h5"};
    std::size_t idle = 0;
    for (int i = 0; i < 6; ++i) {
        run_shard(folder, sweep, i, 6);
        merge.push_back(shard_file(folder, i, 6));
        idle += item_names(merge.back()).empty() ? 1 : 0;
    }
    EXPECT_GT(idle, 0U);
    EXPECT_EQ(run_ricci(folder, merge).status, 0);
    EXPECT_EQ(digests(folder / "merged.h5"), digests(folder / "whole.h5"));
}

}  // namespace
}  // namespace ricci
