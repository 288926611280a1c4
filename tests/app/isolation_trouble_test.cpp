// Isolated runs among signals, suspended jobs, scarce memory, and files that come and go: nobody is blamed
// for what he has not done, and what is finished stays.
#include <zlib.h>

#include <csignal>

#include "tests/support/isolated_sweeps.h"

namespace ricci {
namespace {

namespace fs = std::filesystem;

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

TEST_F(Isolation, ASignalToAllProcessesIsNobodysFault) {
    const Words words = sweep("abcdefgh", "plain.h5", {"--vertices", "sample:60"});
    ASSERT_EQ(run(words).status, 0);
    const auto expected = digests(folder / "plain.h5");
    int stopped = 0;
    for (int round = 0; round < 8; ++round) {
        MarkedRun marked(folder, sweep("abcdefgh", "out.h5", {"--vertices", "sample:60", "--isolate"}, "3"));
        if (marked.has_processes(2)) {
            std::this_thread::sleep_for(std::chrono::milliseconds(15 * round));
            marked.signal_all(SIGTERM, round % 2 == 0);
        }
        const ProgramResult r = marked.result();
        EXPECT_TRUE(r.status == 0 || r.status == 128 + SIGTERM) << r.err;
        stopped += r.status == 0 ? 0 : 1;
        const ProgramResult resumed =
            run(sweep("abcdefgh", "out.h5", {"--vertices", "sample:60", "--resume"}));
        EXPECT_EQ(resumed.status, 0) << round << ": " << resumed.err;
        EXPECT_EQ(digests(folder / "out.h5"), expected) << round;
        EXPECT_FALSE(fs::exists(folder / "out.h5.failures"));
        fs::remove(folder / "out.h5");
    }
    EXPECT_GT(stopped, 0);
}

TEST_F(Isolation, AChildThatIsToldToEndIsStartedAgain) {
    ASSERT_EQ(run(sweep("ab", "plain.h5", {"--vertices", "sample:100"})).status, 0);
    MarkedRun marked(folder, sweep("ab", "out.h5", {"--vertices", "sample:100", "--isolate"}, "1"));
    for (int k = 0; k < 2; ++k) {
        if (marked.has_processes(2)) marked.signal_youngest(k == 0 ? SIGTERM : SIGINT);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    const ProgramResult r = marked.result();
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(digests(folder / "out.h5"), digests(folder / "plain.h5"));
}

TEST_F(Isolation, ASuspendedRunDoesNotHang) {
    MarkedRun marked(
        folder, sweep("ab", "out.h5", {"--vertices", "sample:150", "--isolate", "--hang-timeout", "5"}, "1"));
    ASSERT_TRUE(marked.has_processes(2));
    marked.signal_all(SIGSTOP, true);
    std::this_thread::sleep_for(std::chrono::seconds(7));
    marked.signal_all(SIGCONT, true);
    const ProgramResult r = marked.result();
    EXPECT_EQ(r.status, 0) << r.err;
}

TEST_F(Isolation, AHangIsNoticedWhileOthersWaitForMemory) {
    // A solve of this surface needs more than half of what is allowed, so that the second thread waits.
    fs::copy_file(make(folder, "eight", 12000), folder / "x.off");
    const ProgramResult dry =
        run({"sweep", folder / "x.off", "--vertices", "sample:40", "--dry-run", "--json", "--threads", "1"});
    const double megabytes = objects(dry.out).at(0)["estimated_megabytes"];
    const std::string item = objects(dry.out).at(0)["item"];
    const Environment hanging = fault("solve@" + item + ":1:hang");
    const ProgramResult r =
        run(sweep("x", "out.h5",
                  {"--vertices", "sample:40", "--isolate", "--hang-timeout", "6", "--max-memory",
                   std::to_string(static_cast<int>(1.3 * megabytes)) + "M"}));
    EXPECT_EQ(r.status, 1) << r.err;
    EXPECT_EQ(failures("out.h5").at(item).status, "timeout") << r.err;
}

TEST_F(Isolation, TheLimitOnUnpackedFilesIsThatOfTheRun) {
    const std::string packed = folder / "packed.off.gz";
    const std::string text = read_text(folder / "a.off");
    gzFile file = gzopen(packed.c_str(), "wb");
    ASSERT_EQ(gzwrite(file, text.data(), static_cast<unsigned>(text.size())), static_cast<int>(text.size()));
    gzclose(file);
    const auto with = [&](const std::string& output, const Words& more) {
        Words words{"sweep", packed, "--vertices", "sample:4", "-o", folder / output};
        words.insert(words.end(), more.begin(), more.end());
        return run(words).status;
    };
    EXPECT_EQ(with("plain.h5", {"--max-unpacked", "1K"}), 1);
    EXPECT_EQ(with("isolated.h5", {"--max-unpacked", "1K", "--isolate"}), 1);
    EXPECT_EQ(failures("isolated.h5").at("packed").message, failures("plain.h5").at("packed").message);
    EXPECT_EQ(with("plain.h5", {"--max-unpacked", "1M"}), 0);
    EXPECT_EQ(with("isolated.h5", {"--max-unpacked", "1M", "--isolate"}), 0);
    EXPECT_EQ(digests(folder / "isolated.h5"), digests(folder / "plain.h5"));
    const Environment environment = fault("load@packed:1:abort");
    EXPECT_EQ(with("crash.h5", {"--max-unpacked", "1M", "--isolate"}), 1);
    EXPECT_NE(read_text(folder / "crash.h5.failures/packed/reproduce.sh").find("--max-unpacked=1048576"),
              std::string::npos);
}

TEST_F(Isolation, FilesWithTheSameBytesFailTogether) {
    const std::string broken = "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n";
    write_text(folder / "x.off", broken);
    write_text(folder / "y.off", broken);
    const auto build = [&](const std::string& output, const Words& more) {
        Words words{"index",        "build", folder / "x.off",   folder / "y.off", folder / "a.off",
                    "--max-length", "2",     "--no-coordinates", "--json",         "-o",
                    folder / output};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    };
    const ProgramResult plain = build("plain.h5", {}), isolated = build("isolated.h5", {"--isolate"});
    EXPECT_EQ(plain.status, 1);
    EXPECT_EQ(isolated.status, 1);
    EXPECT_EQ(digests(folder / "isolated.h5"), digests(folder / "plain.h5"));
    ASSERT_EQ(objects(isolated.out).size(), 3U);
    for (std::size_t k = 0; k < 3; ++k)
        for (const char* key : {"status", "message"})
            EXPECT_EQ(objects(isolated.out)[k][key], objects(plain.out)[k][key]) << k;
}

TEST_F(Isolation, AFileThatIsGoneKeepsItsItem) {
    ASSERT_EQ(run(sweep("abc", "plain.h5")).status, 0);
    const auto all = digests(folder / "plain.h5");
    for (const bool isolate : {false, true}) {
        {
            // Items and some rows of a and b.
            const Environment killed = fault("segment_journalled:5");
            EXPECT_EQ(run(sweep("abc", "out.h5", {}, "1")).status, 128 + SIGKILL);
        }
        fs::rename(folder / "a.off", folder / "elsewhere.off");
        Words words = sweep("abc", "out.h5", {"--resume"});
        if (isolate) words.emplace_back("--isolate");
        const ProgramResult r = run(words);
        fs::rename(folder / "elsewhere.off", folder / "a.off");
        EXPECT_EQ(r.status, 1) << r.err;
        EXPECT_EQ(failures("out.h5").at("a").stage, "load");
        std::vector<std::string> names;
        for (const StoredItem& item : read_run(folder / "out.h5").items) names.push_back(item.item.name);
        EXPECT_EQ(names, (std::vector<std::string>{"a" + suffix, "b" + suffix, "c" + suffix}));
        for (const auto& [path, digest] : digests(folder / "out.h5")) {
            if (path.starts_with("/items/")) {
                EXPECT_EQ(digest, all.at(path)) << path;
            }
        }
        // With the file back the rest is done.
        EXPECT_EQ(run(sweep("abc", "out.h5", {"--resume"})).status, 0);
        EXPECT_EQ(digests(folder / "out.h5"), all);
        fs::remove(folder / "out.h5");
    }
}

}  // namespace
}  // namespace ricci
