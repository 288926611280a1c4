// One bad item cannot hurt: crashes, hangs and memory blow-ups in child processes, what they leave behind,
// and how it is mended. Faults come from RICCI_FAULT (io/store/fault_point.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

#include "io/store/run_store.h"
#include "tests/support/isolated_sweeps.h"

namespace ricci {
namespace {

namespace fs = std::filesystem;

using ricci::testing::all_gone;
using ricci::testing::digests;
using ricci::testing::Environment;
using ricci::testing::fault;
using ricci::testing::Isolation;
using ricci::testing::make;
using ricci::testing::MarkedRun;
using ricci::testing::objects;
using ricci::testing::ProgramResult;
using ricci::testing::read_text;
using ricci::testing::run_ricci;
using ricci::testing::Words;
using ricci::testing::write_text;

TEST_F(Isolation, ChangesNoBitForAnyThreads) {
    // Two components; the same stem twice; no mesh; no cone; several resolutions; a file twice.
    fs::create_directory(folder / "more");
    fs::copy_file(folder / "b.off", folder / "more/a.off");
    write_text(folder / "two.off",
               "OFF\n8 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n5 0 0\n6 0 0\n5 1 0\n5 0 2\n"
               "3 4 6 5\n3 4 5 7\n3 5 6 7\n3 6 4 7\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    write_text(folder / "broken.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n");
    const auto with = [&](const std::string& output, const Words& more) {
        Words words{"sweep",
                    folder / "a.off",
                    folder / "two.off",
                    folder / "broken.off",
                    folder / "b.off",
                    folder / "more/a.off",
                    folder / "missing.off",
                    folder / "b.off",
                    "--vertices",
                    "sample:20:3",
                    "--resolutions",
                    "input,300",
                    "--keep",
                    "3",
                    "--json",
                    "-o",
                    folder / output};
        words.insert(words.end(), more.begin(), more.end());
        return run_ricci(folder, words);
    };
    const ProgramResult plain = with("plain.h5", {"--threads", "2"});
    ASSERT_EQ(plain.status, 1) << plain.err;
    const auto expected = digests(folder / "plain.h5");
    const auto names = [](const ProgramResult& r) {
        std::vector<std::string> items;
        for (const auto& line : objects(r.out))
            items.push_back(line["item"].get<std::string>() + line["status"].get<std::string>() +
                            line["solved"].dump() + line["vertices"].dump());
        return items;
    };
    for (const char* threads : {"1", "2", "3"}) {
        const ProgramResult r = with("isolated.h5", {"--isolate", "--threads", threads});
        EXPECT_EQ(r.status, 1) << r.err;
        EXPECT_EQ(digests(folder / "isolated.h5"), expected) << threads << " threads";
        EXPECT_EQ(names(r), names(plain));
        EXPECT_FALSE(fs::exists(folder / "isolated.h5.failures")) << "nothing crashed";
    }
}

TEST_F(Isolation, CrashAbortHangAndBlowUpHurtNobodyElseAndAreMended) {
    ASSERT_EQ(run(sweep("abcdefgh", "plain.h5")).status, 0);
    const std::string faults = "solve@b" + suffix + ":9:segv;solve@c" + suffix + ":5:abort;solve@e" + suffix +
                               ":1:hang;solve@f" + suffix + ":3:allocate;solve@g" + suffix + ":3:reserve";
    const Words isolated =
        sweep("abcdefgh", "out.h5", {"--isolate", "--hang-timeout", "6", "--max-memory", "600M"});
    {
        const Environment environment = fault(faults);
        const Environment mark("RICCI_TEST_MARK", folder / "mark");
        const ProgramResult r = run(isolated);
        ASSERT_EQ(r.status, 1) << r.err;
        EXPECT_TRUE(all_gone(folder / "mark"));
    }
    EXPECT_EQ(digests_of("out.h5", "adh"), digests_of("plain.h5", "adh"));
    const auto failed = failures("out.h5");
    ASSERT_EQ(failed.size(), 5U);
    const auto expect = [&](const std::string& item, const char* status, const char* words) {
        const FailureRecord& f = failed.at(item + suffix);
        EXPECT_EQ(f.stage, "sweep");
        EXPECT_EQ(f.status, status);
        EXPECT_NE(f.message.find(words), std::string::npos) << f.message;
        EXPECT_NE(f.message.find(folder / ("out.h5.failures/" + item + suffix)), std::string::npos)
            << f.message;
    };
    expect("b", "internal_error", "SIGSEGV");
    expect("c", "internal_error", "SIGABRT");
    expect("e", "timeout", "no sign of life");
    expect("f", "out_of_memory", "600 allowed");
    expect("g", "out_of_memory", "memory ran out");
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "out.h5", "--recompute"}).status, 0);
    const auto bundle = [&](const std::string& name) {
        return nlohmann::json::parse(read_text(folder / ("out.h5.failures/b" + suffix + "/" + name)));
    };
    EXPECT_EQ(bundle("failure.json")["signal"], "SIGSEGV");
    EXPECT_EQ(bundle("failure.json")["status"], "internal_error");
    EXPECT_EQ(read_text(folder / ("out.h5.failures/b" + suffix + "/b.off")), read_text(folder / "b.off"));

    // A plain resume leaves what failed alone; trying again mends it, with or without isolation.
    EXPECT_EQ(run(sweep("abcdefgh", "out.h5", {"--resume"})).status, 1);
    EXPECT_EQ(failures("out.h5").size(), 5U);
    const ProgramResult mended = run(sweep("abcdefgh", "out.h5", {"--retry-failed", "--isolate"}));
    EXPECT_EQ(mended.status, 0) << mended.err;
    EXPECT_EQ(digests(folder / "out.h5"), digests(folder / "plain.h5"));
    EXPECT_FALSE(fs::exists(folder / "out.h5.failures"));
}

TEST_F(Isolation, FinishedRowsOfABadItemAreKept) {
    ASSERT_EQ(run(sweep("a", "plain.h5")).status, 0);
    {
        const Environment environment = fault("solve@a" + suffix + ":24:segv");
        EXPECT_EQ(run(sweep("a", "out.h5", {"--isolate", "--lanes", "1"}, "1")).status, 1);
    }
    const StoredRun run_before = read_run(folder / "out.h5");
    ASSERT_TRUE(run_before.items.at(0).sweep.has_value());
    EXPECT_EQ(run_before.items[0].sweep->rows.size(), 23U) << "all but the one that began as the 24th";
    EXPECT_EQ(run(sweep("a", "out.h5", {"--retry-failed"})).status, 0);
    EXPECT_EQ(digests(folder / "out.h5"), digests(folder / "plain.h5"));
}

TEST_F(Isolation, TheReproducerReproduces) {
    const std::string faults = "solve@a" + suffix + ":1:segv;load@b:1:abort;prepare@c" + suffix + ":1:throw";
    const Environment environment = fault(faults);
    ASSERT_EQ(run(sweep("abc", "out.h5", {"--isolate"})).status, 1);
    EXPECT_EQ(reproduce("out.h5", "a" + suffix).status, 128 + SIGSEGV);
    EXPECT_EQ(reproduce("out.h5", "b").status, 128 + SIGABRT);
    const auto failed = failures("out.h5");
    EXPECT_EQ(failed.at("b").stage, "load");
    EXPECT_NE(failed.at("b").message.find("SIGABRT"), std::string::npos);
    EXPECT_EQ(failed.at("c" + suffix).status, "internal_error");
    EXPECT_NE(failed.at("c" + suffix).message.find("thrown by"), std::string::npos);
    // Without the fault it does what the whole run would have done, for the vertices under way.
    ::unsetenv("RICCI_FAULT");
    EXPECT_EQ(reproduce("out.h5", "a" + suffix).status, 0);
    const StoredRun again = read_run(folder / ("out.h5.failures/a" + suffix + "/reproduced.h5"));
    ASSERT_EQ(run(sweep("a", "plain.h5")).status, 0);
    const StoredRun whole = read_run(folder / "plain.h5");
    ASSERT_EQ(again.items.size(), 1U);
    EXPECT_EQ(again.items[0].item.name, "a" + suffix);
    ASSERT_FALSE(again.items[0].sweep->rows.empty());
    for (const SweepRow& row : again.items[0].sweep->rows) {
        const auto& rows = whole.items[0].sweep->rows;
        const auto same = std::find_if(rows.begin(), rows.end(),
                                       [&](const SweepRow& other) { return other.vertex == row.vertex; });
        ASSERT_NE(same, rows.end());
        EXPECT_EQ(same->area_distortion, row.area_distortion);
    }
}

TEST_F(Isolation, OneBadResolutionLeavesTheOthersOfItsFile) {
    const Words more{"--resolutions", "input,300,200"};
    ASSERT_EQ(run(sweep("ab", "plain.h5", more)).status, 0);
    const auto all = digests(folder / "plain.h5");
    Words isolated = more;
    isolated.insert(isolated.end(), {"--isolate", "--hang-timeout", "6"});
    {
        const Environment environment =
            fault("resample@a@300:1:hang;solve@b" + suffix + ":1:segv;prepare@b@200:1:kill");
        EXPECT_EQ(run(sweep("ab", "out.h5", isolated)).status, 1);
    }
    const auto failed = failures("out.h5");
    ASSERT_EQ(failed.size(), 3U);
    EXPECT_EQ(failed.at("a@300").stage, "resample");
    EXPECT_EQ(failed.at("a@300").status, "timeout");
    EXPECT_EQ(failed.at("b" + suffix).status, "internal_error");
    EXPECT_EQ(failed.at("b@200").status, "out_of_memory") << "a SIGKILL that was not ours";
    const auto some = digests(folder / "out.h5");
    std::set<std::string> swept;
    for (const auto& [path, digest] : some) {
        if (!path.starts_with("/items/")) continue;
        EXPECT_EQ(digest, all.at(path)) << path;
        if (path.find("/sweep/vertex") != std::string::npos) swept.insert(path);
    }
    EXPECT_EQ(swept.size(), 3U) << "a and a@200, b@300";
    isolated.emplace_back("--retry-failed");
    EXPECT_EQ(run(sweep("ab", "out.h5", isolated)).status, 0);
    EXPECT_EQ(digests(folder / "out.h5"), all);
}

TEST_F(Isolation, ADeadParentLosesNothingAndLeavesNoChild) {
    ASSERT_EQ(run(sweep("abcd", "plain.h5")).status, 0);
    const auto expected = digests(folder / "plain.h5");
    const std::string mark = folder / "mark";
    for (const bool isolate_again : {true, false}) {
        {
            // Meshes and rows of some items are in the journal by then, and a child hangs.
            const Environment killed = fault("segment_journalled:4;solve@d" + suffix + ":1:hang");
            const Environment marked("RICCI_TEST_MARK", mark);
            const ProgramResult r = run(sweep("dabc", "out.h5", {"--isolate"}));
            EXPECT_EQ(r.status, 128 + SIGKILL) << r.err;
            EXPECT_TRUE(all_gone(mark));
        }
        EXPECT_TRUE(fs::exists(folder / "out.h5.parts/journal"));
        Words resumed = sweep("dabc", "out.h5", {"--resume"});
        if (isolate_again) resumed.emplace_back("--isolate");
        const ProgramResult r = run(resumed);
        EXPECT_EQ(r.status, 0) << r.err;
        EXPECT_EQ(digests(folder / "out.h5"), expected);
        fs::remove(folder / "out.h5");
    }
}

TEST_F(Isolation, ASignalReachesTheChildren) {
    const Words more{"--vertices", "sample:150"};
    ASSERT_EQ(run(sweep("abc", "plain.h5", more)).status, 0);
    Words isolated = more;
    isolated.emplace_back("--isolate");
    {
        MarkedRun marked(folder, sweep("abc", "out.h5", isolated));
        ASSERT_TRUE(marked.has_processes(3));
        marked.signal_parent(SIGTERM);
        const ProgramResult r = marked.result();
        EXPECT_EQ(r.status, 128 + SIGTERM) << r.err;
        EXPECT_NE(r.err.find("--resume"), std::string::npos);
        EXPECT_TRUE(marked.all_gone());
    }
    {
        // One that does not listen is killed, and not blamed.
        const Environment hanging = fault("solve@b" + suffix + ":1:hang");
        Words resumed = isolated;
        resumed.emplace_back("--resume");
        MarkedRun marked(folder, sweep("abc", "out.h5", resumed));
        ASSERT_TRUE(marked.has_processes(3));
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        marked.signal_parent(SIGTERM);
        EXPECT_EQ(marked.result().status, 128 + SIGTERM);
        EXPECT_TRUE(marked.all_gone());
    }
    Words resumed = more;
    resumed.emplace_back("--resume");
    EXPECT_EQ(run(sweep("abc", "out.h5", resumed)).status, 0);
    EXPECT_EQ(digests(folder / "out.h5"), digests(folder / "plain.h5"));
}

TEST_F(Isolation, FailedVerticesAreTriedAgainAndOnlyThose) {
    ASSERT_EQ(run(sweep("ab", "plain.h5", {"--keep", "all"})).status, 0);
    // The same run with two failed solves in b, one of them that of the best vertex.
    const StoredRun good = read_run(folder / "plain.h5");
    const StoredSweep& sweep_of_b = *good.items.at(1).sweep;
    const std::set<Index> bad{*sweep_of_b.best, sweep_of_b.rows.at(3).vertex};
    {
        RunStore store(folder / "out.h5", good.info, false);
        for (const StoredItem& item : good.items) {
            const bool hit = &item == &good.items[1];
            store.write_item(item.item);
            SweepBlock block{item.item.name, item.sweep->rows, item.sweep->kept};
            for (SweepRow& row : block.rows) {
                row.seconds = 1.0F;
                if (!hit || !bad.contains(row.vertex)) continue;
                row.status = 5;  // stalled
                row.area_distortion = std::numeric_limits<double>::quiet_NaN();
                store.write_failure(
                    {block.item, "sweep vertex " + std::to_string(row.vertex), "stalled", "x"});
            }
            if (hit) std::erase_if(block.kept, [&](const KeptFactor& k) { return bad.contains(k.vertex); });
            store.write_sweep_block(block);
        }
        store.write_failure({"gone@1", "sweep", "internal_error", "of a file that is in order by now"});
        store.assemble({good.items[0].item.name, good.items[1].item.name}, {true, true, -1});
    }
    ASSERT_NE(digests(folder / "out.h5"), digests(folder / "plain.h5"));
    const ProgramResult resumed = run(sweep("ab", "out.h5", {"--keep", "all", "--resume"}));
    EXPECT_EQ(resumed.status, 1) << "a plain resume does not try them: " << resumed.err;
    for (const bool isolate : {true, false}) {
        fs::copy_file(folder / "out.h5", folder / "again.h5", fs::copy_options::overwrite_existing);
        Words words = sweep("ab", "again.h5", {"--keep", "all", "--retry-failed"});
        if (isolate) words.emplace_back("--isolate");
        const ProgramResult r = run(words);
        EXPECT_EQ(r.status, 0) << r.err;
        EXPECT_EQ(digests(folder / "again.h5"), digests(folder / "plain.h5"));
        std::size_t solved_anew = 0;
        for (const StoredItem& item : read_run(folder / "again.h5").items)
            for (const SweepRow& row : item.sweep->rows) solved_anew += row.seconds != 1.0F ? 1 : 0;
        EXPECT_EQ(solved_anew, bad.size());
    }
}

TEST_F(Isolation, ItemsKeepTheirNamesWhenAnEarlierFileIsMended) {
    fs::create_directory(folder / "more");
    fs::copy_file(folder / "b.off", folder / "more/a.off");
    const Words words{"sweep", folder / "more/a.off", folder / "a.off", "--vertices", "sample:8", "--isolate",
                      "-o",    folder / "out.h5"};
    {
        const Environment environment = fault("load@a:1:segv");
        EXPECT_EQ(run(words).status, 1);
    }
    const auto swept = [&] {
        std::map<std::string, std::string> source;
        for (const StoredItem& item : read_run(folder / "out.h5").items)
            source[item.item.source] = item.item.name;
        return source;
    };
    EXPECT_EQ(swept().at(folder / "a.off"), "a" + suffix);
    Words retry = words;
    retry.emplace_back("--retry-failed");
    EXPECT_EQ(run(retry).status, 0);
    EXPECT_EQ(swept().at(folder / "a.off"), "a" + suffix) << "its rows are its own";
    EXPECT_EQ(swept().at(folder / "more/a.off"), "a" + suffix + "~2");
    // A file that has changed under a stored item is not mixed with it.
    fs::copy_file(make(folder, "eight", 800), folder / "a.off", fs::copy_options::overwrite_existing);
    write_text(folder / "a.off", read_text(folder / "b.off") + "# changed\n");
    const ProgramResult changed = run(retry);
    EXPECT_EQ(changed.status, 2);
    EXPECT_NE(changed.err.find("has changed"), std::string::npos) << changed.err;
}

TEST_F(Isolation, AnIndexBuildGoesOnToo) {
    const auto build = [&](const std::string& output, const Words& more) {
        Words words{"index",
                    "build",
                    folder / "a.off",
                    folder / "eight.off",
                    folder / "torus.off",
                    "--max-length",
                    "2",
                    "--threads",
                    "2",
                    "--json",
                    "-o",
                    folder / output};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    };
    ASSERT_FALSE(make(folder, "torus", 300).empty());
    ASSERT_EQ(build("plain.h5", {}).status, 0);
    ASSERT_EQ(build("isolated.h5", {"--isolate"}).status, 0);
    EXPECT_EQ(digests(folder / "isolated.h5"), digests(folder / "plain.h5"));
    const std::string torus = folder / "torus.off";
    {
        // a.off and eight.off are the same bytes: described once.
        const Environment environment = fault("describe@" + torus + ":1:segv");
        const ProgramResult r = build("out.h5", {"--isolate"});
        EXPECT_EQ(r.status, 1) << r.err;
        const auto lines = objects(r.out);
        ASSERT_EQ(lines.size(), 3U);
        EXPECT_EQ(lines[2]["status"], "internal_error");
        EXPECT_NE(lines[2]["message"].get<std::string>().find("SIGSEGV"), std::string::npos);
        ASSERT_TRUE(fs::exists(folder / "out.h5.failures"));
        const fs::path bundle = fs::directory_iterator(folder / "out.h5.failures")->path();
        ::setenv("RICCI_FAULT", "describe@torus.off:1:segv", 1);  // the copy's name
        EXPECT_EQ(ricci::testing::run_program(folder, {"/bin/sh", bundle / "reproduce.sh"}).status,
                  128 + SIGSEGV);
    }
    EXPECT_EQ(build("out.h5", {"--isolate"}).status, 0) << "a later build tries again";
    EXPECT_EQ(digests(folder / "out.h5"), digests(folder / "plain.h5"));
    EXPECT_FALSE(fs::exists(folder / "out.h5.failures"));
}

}  // namespace
}  // namespace ricci
