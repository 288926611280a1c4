// Death at every step, torn and damaged files, full disks, two runs at once.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "io/store/durable.h"
#include "io/store/journal.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;
namespace fs = std::filesystem;

// Runs `work` in a child process and returns its wait status; an exception is exit status 9.
int in_child(const std::function<void()>& work) {
    const pid_t child = ::fork();
    if (child == 0) {
        try {
            work();
        } catch (const std::exception&) {
            ::_exit(9);
        }
        ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
}

bool killed_at(const std::string& path, const std::string& fault, bool resume) {
    const int status = in_child([&] {
        ::setenv("RICCI_FAULT", fault.c_str(), 1);
        write_sample_run(path, resume);
    });
    const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    EXPECT_TRUE(killed || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) << fault << ": status " << status;
    return killed;
}

void flip_bit(const std::string& path, std::size_t byte) {
    std::string bytes = read_text(path);
    bytes.at(byte) = static_cast<char>(bytes.at(byte) ^ 0x10);
    std::ofstream(path, std::ios::binary) << bytes;
}

class StoreCrash : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(StoreCrash, ResumedRunEqualsUndisturbedOne) {
    const TemporaryFolder folder;
    write_sample_run(folder.file("reference.h5"), false);
    const auto reference = digests(folder.file("reference.h5"));
    const auto [point, passes] = GetParam();
    for (int count = 1; count <= passes; ++count) {
        const std::string path = folder.file(std::string(point) + std::to_string(count) + ".h5");
        const std::string fault = std::string(point) + ":" + std::to_string(count);
        ASSERT_TRUE(killed_at(path, fault, false)) << fault;
        write_sample_run(path, true);
        EXPECT_EQ(digests(path), reference) << fault;
        EXPECT_EQ(verify_structure(path), std::vector<std::string>()) << fault;
        EXPECT_FALSE(fs::exists(path + ".parts")) << fault;
    }
    EXPECT_FALSE(
        killed_at(folder.file("last.h5"), std::string(point) + ":" + std::to_string(passes + 1), false));
}

// Eight segments, nine journal lines after the first.
INSTANTIATE_TEST_SUITE_P(Points, StoreCrash,
                         ::testing::Values(std::pair("segment_filled", 8), std::pair("segment_written", 8),
                                           std::pair("segment_renamed", 8), std::pair("journal_before", 9),
                                           std::pair("journal_half", 9), std::pair("journal_written", 9),
                                           std::pair("segment_journalled", 8), std::pair("assembled", 1),
                                           std::pair("assembled_renamed", 1), std::pair("parts_unproved", 2)),
                         [](const auto& tested) { return std::string(tested.param.first); });

TEST(StoreCrashes, KilledAgainAndAgain) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(folder.file("reference.h5"), false);
    int deaths = 0;
    while (killed_at(path, "segment_journalled:1", true)) ++deaths;
    EXPECT_EQ(deaths, 8);  // each attempt finishes one segment, the ninth has none left
    EXPECT_EQ(digests(path), digests(folder.file("reference.h5")));
}

TEST(StoreCrashes, FinishedIsExactlyWhatTheJournalProves) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    ASSERT_TRUE(killed_at(path, "segment_journalled:3", false));
    {
        const RunStore store(path, sample_info(), true);
        EXPECT_EQ(store.finished_vertices("a@32"), range(0, 16));
        EXPECT_EQ(store.finished_rows("a@32").at(3).flips, 9);
        EXPECT_FALSE(store.has_item("b@18"));
        EXPECT_TRUE(store.notes().empty());
    }
    fs::remove_all(path + ".parts");
    ASSERT_TRUE(killed_at(path, "segment_renamed:3", false));  // the file is there, its line is not
    const RunStore store(path, sample_info(), true);
    EXPECT_EQ(store.finished_vertices("a@32"), range(0, 8));
    EXPECT_EQ(std::distance(fs::directory_iterator(path + ".parts"), {}), 3);  // journal, mesh, one block
}

TEST(StoreCrashes, TornJournalLineIsIgnored) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    ASSERT_TRUE(killed_at(path, "segment_journalled:3", false));
    const std::string journal = journal_path(path + ".parts");
    const std::string text = read_text(journal);
    const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
    for (const std::size_t size : {last + 1, last + 40, text.size() - 1}) {
        fs::resize_file(journal, size);
        {
            const RunStore store(path, sample_info(), true);
            EXPECT_EQ(store.finished_vertices("a@32"), range(0, 8));
            ASSERT_EQ(store.notes().size(), 1U);
            EXPECT_NE(store.notes()[0].find("torn"), std::string::npos);
        }
        EXPECT_EQ(fs::file_size(journal), last);  // the next line starts a line
        std::ofstream(journal, std::ios::binary) << text;
        ASSERT_TRUE(fs::remove_all(path + ".parts") > 0);
        ASSERT_TRUE(killed_at(path, "segment_journalled:3", false));
    }
}

TEST(StoreCrashes, DamagedJournalLines) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    ASSERT_TRUE(killed_at(path, "segment_journalled:3", false));
    const std::string journal = journal_path(path + ".parts");
    const std::string text = read_text(journal);
    const std::size_t first = text.find('\n') + 1;
    const std::size_t second = text.find('\n', first) + 1;
    flip_bit(journal, second + 20);
    EXPECT_EQ(verify_structure(path).size(), 2U);  // not assembled, and the damaged line
    {
        const RunStore store(path, sample_info(), true);
        EXPECT_EQ(store.finished_vertices("a@32"), range(8, 16));
        ASSERT_EQ(store.notes().size(), 1U);
        EXPECT_NE(store.notes()[0].find("line 3 is damaged"), std::string::npos) << store.notes()[0];
    }
    flip_bit(journal, 5);  // the first line: whose run is it?
    EXPECT_THROW(RunStore(path, sample_info(), true), FileError);
    EXPECT_TRUE(fs::exists(journal));  // and nothing is thrown away
}

// Lines with a right checksum that no run has written: names that lead out of the folder, vertices by the
// billion.
TEST(Journal, RefusesWhatNoRunWrites) {
    const TemporaryFolder folder;
    const std::string parts = folder.file("run.h5.parts");
    fs::create_directory(parts);
    const auto refused = [&](const std::string& entry) {
        const JournalHeader header{"f", {"converged"}};
        Journal::create(parts, header);
        const std::string line = entry.substr(0, entry.size() - 1);
        std::ofstream(journal_path(parts), std::ios::app)
            << line << ",\"line\":\"" << hex16(checksum_of(std::string_view(line))) << "\"}\n";
        try {
            read_journal(parts);
            ADD_FAILURE() << entry;
        } catch (const FileError& error) {
            EXPECT_NE(std::string(error.what()).find("not a journal of this program"), std::string::npos);
        }
    };
    for (const char* name : {"../run.h5", "/etc/passwd", "..", "."})
        refused(std::string(R"({"kind":"item","item":"a","checksum":"0","name":")") + name + "\"}");
    for (const char* runs :
         {"[[0,2147483647],[2147483647,1]]", "[[-1,2]]", "[[5,1],[4,1]]", "[[0,0]]", "[[0]]", "7"})
        refused(std::string(R"({"kind":"sweep","item":"a","checksum":"0","name":"s.h5","vertices":)") + runs +
                "}");
    refused(R"({"kind":"item","item":"a","checksum":"zz","name":"s.h5"})");
}

TEST(StoreCrashes, DamagedSegmentIsDroppedAndRedone) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(folder.file("reference.h5"), false);
    ASSERT_TRUE(killed_at(path, "segment_journalled:3", false));
    const std::string segment = path + ".parts/sweep-000002.h5";
    flip_bit(segment, fs::file_size(segment) / 2);
    EXPECT_EQ(verify_structure(path).size(), 2U);
    {
        const RunStore store(path, sample_info(), true);
        EXPECT_EQ(store.finished_vertices("a@32"), range(8, 16));
        ASSERT_EQ(store.notes().size(), 1U);
        EXPECT_NE(store.notes()[0].find("8 vertices from 0 to 7"), std::string::npos) << store.notes()[0];
    }
    fs::remove(path + ".parts/item-000001.h5");
    {
        const RunStore store(path, sample_info(), true);
        EXPECT_FALSE(store.has_item("a@32"));
        EXPECT_EQ(store.finished_vertices("a@32"), range(8, 16));
        ASSERT_EQ(store.notes().size(), 1U);  // of the mesh; the block was reported and dropped before
        EXPECT_NE(store.notes()[0].find("does not exist"), std::string::npos) << store.notes()[0];
    }
    write_sample_run(path, true);
    EXPECT_EQ(digests(path), digests(folder.file("reference.h5")));
}

TEST(StoreCrashes, DamagedResultIsDroppedAndRedone) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(folder.file("reference.h5"), false);
    ASSERT_TRUE(killed_at(path, "segment_journalled:8", false));
    const std::string segment = path + ".parts/layout-000008.h5";
    flip_bit(segment, fs::file_size(segment) / 2);
    const std::vector<std::string> complaints = verify_structure(path);
    ASSERT_EQ(complaints.size(), 2U);  // not assembled, and the segment
    EXPECT_EQ(complaints[1], segment + ": segment does not match its checksum");
    {
        const RunStore store(path, sample_info(), true);
        EXPECT_FALSE(store.has_result("a@32", "layout"));
        EXPECT_TRUE(store.has_flow("a@32"));
        ASSERT_EQ(store.notes().size(), 1U);
        EXPECT_NE(store.notes()[0].find("layout of a@32 counts as unfinished"), std::string::npos)
            << store.notes()[0];
    }
    write_sample_run(path, true);
    EXPECT_EQ(digests(path), digests(folder.file("reference.h5")));
}

TEST(StoreCrashes, TwoRunsAtOnce) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    std::optional<RunStore> store(std::in_place, path, sample_info(), false);
    store->write_item(sample_item("a@32", 4));
    for (const bool resume : {false, true}) {
        try {
            const RunStore second(path, sample_info(), resume);
            FAIL();
        } catch (const FileError& error) {
            EXPECT_NE(std::string(error.what()).find("another run"), std::string::npos) << error.what();
        }
    }
    const int status = in_child([&] { const RunStore second(path, sample_info(), false); });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 9);
    store->write_sweep_block(sample_block(sample_item("a@32", 4), {1}));  // unharmed
    store.reset();
    EXPECT_TRUE(RunStore(path, sample_info(), true).has_item("a@32"));
}

TEST(StoreCrashes, ManyThreadsWriteAtOnce) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    const ItemRecord item = sample_item("a@128", 8);
    RunStore store(path, sample_info(), false);
    store.write_item(item);
    std::vector<std::thread> threads;
    threads.reserve(4);
    for (Index t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (Index k = 0; k < 4; ++k) {
                const Index first = 16 * t + 4 * k;
                store.write_sweep_block(sample_block(item, range(first, first + 4)));
                EXPECT_GE(store.finished_rows(item.name).size(), 4U);
            }
        });
    for (std::thread& thread : threads) thread.join();
    store.assemble({item.name}, kSampleKeep);
    EXPECT_EQ(read_run(path).items.at(0).sweep->rows.size(), 64U);
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
}

// Stands in for a full disk: writes beyond so many bytes of a file fail.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  private:
    rlimit before_{};
    void (*handler_)(int);
};

template <class Work>
void expect_full_disk(const std::string& path, rlim_t bytes, Work work) {
    std::string message;
    try {
        const FileSizeLimit limit(bytes);
        work();
    } catch (const FileError& error) {
        message = error.what();
    }
    EXPECT_NE(message.find("File too large"), std::string::npos) << bytes << ": " << message;
    EXPECT_EQ(message.find(path), 0U) << message;
}

TEST(StoreCrashes, FullDiskLosesNothing) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    const ItemRecord item = sample_item("a@2048", 32);
    RunStore store(path, sample_info(), false);
    store.write_item(item);
    store.write_sweep_block(sample_block(item, range(0, 30)));
    const SweepBlock block = sample_block(item, range(30, 60));  // 24 factors of 1024 vertices: 190 kB
    for (const rlim_t bytes : {rlim_t{0}, rlim_t{100}, rlim_t{3000}, rlim_t{50000}, rlim_t{100000}})
        expect_full_disk(path, bytes, [&] { store.write_sweep_block(block); });
    EXPECT_EQ(store.finished_vertices(item.name), range(0, 30));
    const rlim_t journal_end = fs::file_size(journal_path(path + ".parts")) + 20;
    expect_full_disk(path, journal_end, [&] { store.write_failure({"b", "load", "stalled", "message"}); });
    store.write_sweep_block(block);  // there is room again
    for (const rlim_t bytes : {rlim_t{0}, rlim_t{3000}, rlim_t{60000}})
        expect_full_disk(path, bytes, [&] { store.assemble({item.name}, {true, true, -1}); });
    EXPECT_FALSE(fs::exists(path));
    EXPECT_EQ(verify_structure(path).size(), 1U);  // not assembled; the parts are sound
    store.assemble({item.name}, {true, true, -1});
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
    const StoredRun run = read_run(path);
    EXPECT_EQ(run.items.at(0).sweep->rows.size(), 60U);
    EXPECT_EQ(run.items.at(0).sweep->kept.size(), 48U);
    EXPECT_TRUE(run.failures.empty());
}

// A limit on file sizes also fails ftruncate; a full disk fails writes only.
TEST(StoreCrashes, FullDeviceIsNamed) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    const hdf5::Session session;
    hdf5::OutputFile file("/dev/full");
    hdf5::write_scalar<Index>(file.root(), "x", 1);
    try {
        file.close();
        FAIL();
    } catch (const FileError& error) {
        EXPECT_STREQ(error.what(), "/dev/full: cannot write: No space left on device");
    }
}

}  // namespace
}  // namespace ricci
