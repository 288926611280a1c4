// RunStore: what goes in comes out, whatever the order, the partition and the number of attempts.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "io/store/durable.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;
namespace fs = std::filesystem;

TEST(StoreRunStore, RoundTripOfEverything) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    const RunInfo info = sample_info();
    ItemRecord large = sample_item("large@20000", 100);  // large enough for chunked, filtered datasets
    ItemRecord intrinsic = sample_item("one \xC3\xA9@18", 3);
    intrinsic.points.clear();
    intrinsic.twin = sample_flow(intrinsic).twin;
    intrinsic.edge_length = sample_flow(intrinsic).edge_length;
    FlowRecord flow = sample_flow(large);
    {
        RunStore store(path, info, false);
        store.write_item(large);
        store.write_item(intrinsic);
        store.write_sweep_block(sample_block(intrinsic, {3, 1, 4}));
        store.write_flow(flow);
        store.write_failure({"z", "sweep", "timeout", "a message\nof two lines, \"quoted\""});
        EXPECT_TRUE(fs::exists(path + ".parts"));
        store.assemble({intrinsic.name, large.name}, {true, true, -1});
    }
    EXPECT_FALSE(fs::exists(path + ".parts"));
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());

    StoredRun expected;
    expected.info = info;
    expected.complete = true;
    StoredSweep sweep;
    sweep.rows = {sample_row(1), sample_row(3), sample_row(4)};
    sweep.best = 1;  // sin(1) = 0.84, sin(2) = 0.91; vertex 4 failed
    sweep.worst = 3;
    sweep.kept = {sample_factor(1, 9), sample_factor(3, 9)};
    expected.items.push_back({intrinsic, sweep, std::nullopt});
    expected.items.push_back({large, std::nullopt, flow});
    expected.failures.push_back({"z", "sweep", "timeout", "a message\nof two lines, \"quoted\""});
    const StoredRun run = read_run(path);
    EXPECT_EQ(describe(run), describe(expected));
    EXPECT_EQ(run.items[0].sweep->rows[0].seconds, 0.25F);
    EXPECT_EQ(run.items[1].flow->log_seconds, flow.log_seconds);
    EXPECT_EQ(run.info.created.size(), std::string("2000-01-01T00:00:00Z").size());
    EXPECT_EQ(run.info.created.back(), 'Z');
}

TEST(StoreRunStore, OrderAndPartitionOfBlocksDoNotMatter) {
    const TemporaryFolder folder;
    const ItemRecord a = sample_item("a@98", 7);
    const ItemRecord b = sample_item("b@98", 7);
    std::map<std::string, std::uint64_t> reference;
    for (const Index block_size : {49, 1, 5, 13}) {
        const std::string path = folder.file("run.h5");
        RunStore store(path, sample_info(), false);
        const bool backwards = block_size % 2 == 0 || block_size == 13;
        store.write_item(backwards ? b : a);
        store.write_item(backwards ? a : b);
        store.write_failure({backwards ? "y" : "x", "load", "invalid_input", "no"});
        store.write_failure({backwards ? "x" : "y", "load", "invalid_input", "no"});
        std::vector<std::vector<Index>> blocks;
        for (Index v = 0; v < 49; v += block_size) blocks.push_back(range(v, std::min(49, v + block_size)));
        if (backwards) {
            std::reverse(blocks.begin(), blocks.end());
            for (auto& block : blocks) std::reverse(block.begin(), block.end());
        }
        for (const auto& block : blocks) store.write_sweep_block(sample_block(a, block));
        store.assemble({"a@98", "b@98"}, {true, true, 6});
        const auto found = digests(path);
        EXPECT_GT(found.size(), 15U);
        if (reference.empty()) reference = found;
        EXPECT_EQ(found, reference) << "block size " << block_size;
    }
}

TEST(StoreRunStore, BestAndWorstAreConvergedAndLowest) {
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@98", 7);
    const auto sweep_with = [&](const KeepPolicy& keep) {
        const std::string path = folder.file("run.h5");
        RunStore store(path, sample_info(), false);
        store.write_item(item);
        SweepBlock block = sample_block(item, {9, 3, 8, 2, 4, 6, 7});
        store.write_sweep_block(block);
        store.assemble({item.name}, keep);
        EXPECT_EQ(verify_structure(path), std::vector<std::string>());
        return *read_run(path).items.at(0).sweep;
    };
    // Pairs (2,3), (6,7) and vertex 8 have |sin| of 2, 4 and 5; 4 and 9 did not converge.
    StoredSweep sweep = sweep_with({true, true, 0});
    EXPECT_EQ(sweep.best, 6);
    EXPECT_EQ(sweep.worst, 8);
    EXPECT_EQ(sweep.kept.size(), 2U);
    sweep = sweep_with({true, true, -1});
    std::vector<Index> kept;
    for (const KeptFactor& factor : sweep.kept) {
        kept.push_back(factor.vertex);
        EXPECT_EQ(factor.conformal_factor, sample_factor(factor.vertex, 49).conformal_factor);
    }
    EXPECT_EQ(kept, (std::vector<Index>{6, 8, 7, 2, 3}));  // best, worst, the others best first
    sweep = sweep_with({true, true, 2});
    EXPECT_EQ(sweep.kept.size(), 4U);
    EXPECT_EQ(sweep.kept.back().vertex, 2);
    sweep = sweep_with({false, false, 0});
    EXPECT_FALSE(sweep.best || sweep.worst);
    EXPECT_TRUE(sweep.kept.empty());
}

TEST(StoreRunStore, NothingConvergedHasNoBest) {
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@98", 7);
    RunStore store(folder.file("run.h5"), sample_info(), false);
    store.write_item(item);
    store.write_sweep_block(sample_block(item, {4, 9}));
    store.assemble({item.name}, kSampleKeep);
    EXPECT_EQ(verify_structure(folder.file("run.h5")), std::vector<std::string>());
    const StoredSweep sweep = *read_run(folder.file("run.h5")).items.at(0).sweep;
    EXPECT_FALSE(sweep.best || sweep.worst);
    EXPECT_EQ(sweep.rows.size(), 2U);
    EXPECT_TRUE(std::isnan(sweep.rows[0].area_distortion));
}

TEST(StoreRunStore, RefusesRecordsThatDoNotFit) {
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@32", 4);
    RunStore store(folder.file("run.h5"), sample_info(), false);
    EXPECT_THROW(store.write_sweep_block(sample_block(item, {1})), std::invalid_argument);  // no mesh yet
    store.write_item(item);
    EXPECT_THROW(store.write_item(item), std::invalid_argument);
    ItemRecord bad = sample_item("b/c", 4);
    EXPECT_THROW(store.write_item(bad), std::invalid_argument);
    bad.name = "b";
    bad.triangles[3][1] = 16;
    EXPECT_THROW(store.write_item(bad), std::invalid_argument);
    store.write_sweep_block(sample_block(item, {1, 2}));
    EXPECT_THROW(store.write_sweep_block(sample_block(item, {2, 3})), std::invalid_argument);
    EXPECT_THROW(store.write_sweep_block(sample_block(item, {5, 5})), std::invalid_argument);
    SweepBlock block = sample_block(item, {6});
    block.rows[0].status = 12;
    EXPECT_THROW(store.write_sweep_block(block), std::invalid_argument);
    block = sample_block(item, {6});
    block.kept[0].conformal_factor.pop_back();
    EXPECT_THROW(store.write_sweep_block(block), std::invalid_argument);
    block = sample_block(item, {6});
    block.rows[0].area_distortion = std::numeric_limits<double>::infinity();
    EXPECT_THROW(store.write_sweep_block(block), std::invalid_argument);
    FlowRecord flow = sample_flow(item);
    flow.curvature.pop_back();
    EXPECT_THROW(store.write_flow(flow), std::invalid_argument);
    EXPECT_THROW(store.assemble({}, kSampleKeep), std::invalid_argument);
    EXPECT_THROW(store.assemble({"a@32", "b"}, kSampleKeep), std::invalid_argument);
    EXPECT_EQ(store.finished_vertices(item.name), (std::vector<Index>{1, 2}));
    store.assemble({"a@32"}, kSampleKeep);
    EXPECT_THROW(store.write_item(sample_item("c", 4)), std::logic_error);
    EXPECT_EQ(store.read_item(item.name).points, item.points);
}

TEST(StoreRunStore, MissingCandidateIsNamed) {
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@32", 4);
    RunStore store(folder.file("run.h5"), sample_info(), false);
    store.write_item(item);
    SweepBlock block = sample_block(item, {6});
    block.kept.clear();
    store.write_sweep_block(block);
    try {
        store.assemble({item.name}, kSampleKeep);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("vertex 6"), std::string::npos) << error.what();
    }
    store.assemble({item.name}, {false, false, 0});  // still possible
}

TEST(StoreRunStore, TextThatIsNotUtf8IsEscaped) {
    const TemporaryFolder folder;
    ItemRecord item = sample_item("caf\xE9@18", 3);
    item.source = "m\xF0\x9F\x90\xA2/\xC0\x80.off";
    RunStore store(folder.file("run.h5"), sample_info(), false);
    store.write_item(item);
    EXPECT_TRUE(store.has_item("caf\xE9@18"));
    store.write_failure({"caf\xE9@18", "flow", "stalled", "\xFF"});
    EXPECT_TRUE(store.has_failure({"caf\xE9@18", "flow", "", ""}));
    EXPECT_FALSE(store.has_failure({"caf\xE9@18", "load", "", ""}));
    store.assemble({"caf\xE9@18"}, kSampleKeep);
    const StoredRun run = read_run(folder.file("run.h5"));
    EXPECT_EQ(run.items.at(0).item.name, "caf\\xe9@18");
    EXPECT_EQ(run.items.at(0).item.source, "m\xF0\x9F\x90\xA2/\\xc0\\x80.off");
    EXPECT_EQ(run.failures.at(0).message, "\\xff");
}

TEST(StoreRunStore, FailuresAreReplacedAndRetracted) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    {
        RunStore store(path, sample_info(), false);
        store.write_failure({"a", "load", "timeout", "slow"});
        store.write_failure({"a", "load", "stalled", "slower"});
        store.write_failure({"b", "load", "timeout", "slow"});
        store.retract_failure({"b", "load", "", ""});
    }
    RunStore store(path, sample_info(), true);
    ASSERT_EQ(store.failures().size(), 1U);
    EXPECT_EQ(store.failures()[0].message, "slower");
}

TEST(StoreRunStore, ResumeAfterCompletionIsFinished) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(path, false);
    const auto reference = digests(path);
    {
        const RunStore store(path, sample_info(), true);
        EXPECT_TRUE(store.has_item("a@32") && store.has_item("b@18") && store.has_flow("a@32"));
        EXPECT_FALSE(store.has_flow("b@18"));
        EXPECT_EQ(store.finished_vertices("a@32"), range(0, 16));
        EXPECT_EQ(store.failures().size(), 1U);
        EXPECT_TRUE(store.notes().empty());
    }
    EXPECT_FALSE(fs::exists(path + ".parts"));  // nothing was written
    write_sample_run(path, true);               // writes nothing but assembles
    EXPECT_EQ(digests(path), reference);
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
}

TEST(StoreRunStore, ResumeAfterCompletionTakesMore) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(path, false);
    {
        RunStore store(path, sample_info(), true);
        store.retract_failure({"c", "load", "", ""});
        store.write_item(sample_item("c@18", 3));
    }
    RunStore store(path, sample_info(), true);  // a second attempt: output and journal together
    EXPECT_TRUE(store.has_item("c@18") && store.has_item("a@32"));
    EXPECT_TRUE(store.failures().empty());
    store.assemble({"a@32", "b@18", "c@18"}, kSampleKeep);
    EXPECT_EQ(read_run(path).items.size(), 3U);
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
}

TEST(StoreRunStore, AnotherConfigurationIsNotResumed) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    RunInfo other = sample_info();
    other.fingerprint = "tolerance=1e-6";
    {
        RunStore store(path, sample_info(), false);
        store.write_item(sample_item("a@32", 4));
    }
    EXPECT_THROW(RunStore(path, other, true), std::invalid_argument);
    EXPECT_TRUE(RunStore(path, sample_info(), true).has_item("a@32"));  // nothing was lost
    write_sample_run(path, true);
    EXPECT_THROW(RunStore(path, other, true), std::invalid_argument);
    EXPECT_FALSE(fs::exists(path + ".parts"));
    EXPECT_FALSE(RunStore(path, other, false).has_item("a@32"));
}

TEST(StoreRunStore, OldOutputStaysUntilTheNewOneIsWhole) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(path, false);
    const std::uint64_t before = checksum_of_file(path);
    RunStore store(path, sample_info(), false);
    EXPECT_FALSE(store.has_item("a@32"));
    store.write_item(sample_item("new@18", 3));
    EXPECT_EQ(checksum_of_file(path), before);
    store.assemble({"new@18"}, kSampleKeep);
    EXPECT_EQ(read_run(path).items.at(0).item.name, "new@18");
}

TEST(StoreRunStore, UnusableFolderIsAFileError) {
    EXPECT_THROW(RunStore("/no/such/folder/run.h5", sample_info(), false), FileError);
    EXPECT_THROW(read_run("/no/such/file.h5"), FileError);
}

// A row of a failed solve gives way to a later one, in the parts, across a resume, and over a complete file.
TEST(StoreRunStore, FailedRowsAreReplacedAndOnlyThose) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    const ItemRecord item = sample_item("a@18", 3);
    const auto mended = [&](Index vertex) {
        SweepBlock block{item.name, {sample_row(vertex)}, {}};
        block.rows[0].status = 0;
        block.rows[0].area_distortion = 0.5;
        block.kept = {{vertex, 0.5, sample_factor(vertex, item.vertices).conformal_factor}};
        return block;
    };
    {
        RunStore store(path, sample_info(), false);
        store.write_item(item);
        store.write_sweep_block(sample_block(item, range(0, 5)));  // vertex 4 failed
        store.write_failure({item.name, "sweep vertex 4", "max_iterations", ""});
        EXPECT_THROW(store.write_sweep_block(mended(3)), std::invalid_argument);
        SweepBlock twice = mended(4);
        twice.rows.push_back(twice.rows[0]);
        EXPECT_THROW(store.write_sweep_block(twice), std::invalid_argument);
        SweepBlock failed_again = sample_block(item, {4});
        failed_again.rows[0].flips = 77;
        store.write_sweep_block(failed_again);
        EXPECT_EQ(store.finished_rows(item.name).at(4).flips, 77);
    }
    {
        RunStore store(path, sample_info(), true);
        EXPECT_TRUE(store.notes().empty());
        EXPECT_EQ(store.finished_rows(item.name).at(4).flips, 77);
        ASSERT_TRUE(store.failure_of(item.name, "sweep vertex 4").has_value());
        EXPECT_EQ(store.failure_of(item.name, "sweep vertex 4")->status, "max_iterations");
        EXPECT_FALSE(store.failure_of(item.name, "sweep vertex 3").has_value());
        EXPECT_EQ(store.source_of(item.name)->source_hash, item.source_hash);
        EXPECT_FALSE(store.source_of("b").has_value());
        store.assemble({item.name}, kSampleKeep);
    }
    {
        RunStore store(path, sample_info(), true);
        store.write_sweep_block(mended(4));
        store.retract_failure({item.name, "sweep vertex 4", "", ""});
        EXPECT_THROW(store.write_sweep_block(mended(4)), std::invalid_argument);
    }
    RunStore store(path, sample_info(), true);  // base and parts
    EXPECT_EQ(store.finished_rows(item.name).at(4).area_distortion, 0.5);
    store.assemble({item.name}, kSampleKeep);
    const StoredRun run = read_run(path);
    EXPECT_TRUE(run.failures.empty());
    EXPECT_EQ(run.items[0].sweep->best, 4);
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
}

TEST(StoreRunStore, WhatIsDamagedDuringTheRunIsNotAssembled) {
    const ItemRecord item = sample_item("a@98", 7);
    for (const std::string kind : {"sweep", "item"}) {
        const TemporaryFolder folder;
        const std::string path = folder.file("run.h5");
        std::string segment;
        {
            RunStore store(path, sample_info(), false);
            store.write_item(item);
            store.write_sweep_block(sample_block(item, {1, 2, 3}));
            store.release(item.name);
            for (const auto& entry : fs::directory_iterator(path + ".parts"))
                if (entry.path().filename().string().starts_with(kind)) segment = entry.path();
            std::fstream file(segment, std::ios::in | std::ios::out | std::ios::binary);
            file.seekg(0, std::ios::end);
            const auto middle = static_cast<std::streamoff>(file.tellg()) / 2;
            file.seekg(middle);
            const char byte = static_cast<char>(file.get() ^ 4);
            file.seekp(middle);
            file.put(byte);
            file.close();
            try {
                store.assemble({item.name}, {true, true, -1});
                ADD_FAILURE() << "assembled from a damaged " << kind;
            } catch (const FileError& e) {
                EXPECT_NE(std::string(e.what()).find(segment), std::string::npos) << e.what();
                EXPECT_NE(std::string(e.what()).find("--resume"), std::string::npos) << e.what();
            }
            EXPECT_FALSE(fs::exists(path));
        }
        RunStore resumed(path, sample_info(), true);
        ASSERT_FALSE(resumed.notes().empty());
        EXPECT_NE(resumed.notes()[0].find(segment), std::string::npos) << resumed.notes()[0];
        EXPECT_EQ(resumed.has_item(item.name), kind == "sweep");
        EXPECT_EQ(resumed.finished_vertices(item.name).empty(), kind == "sweep");
    }
}

TEST(StoreRunStore, RowsThatAreReleasedAreStillThere) {
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@32", 4);
    const auto write = [&](const std::string& path, bool release) {
        RunStore store(path, sample_info(), false);
        store.release("none");
        store.write_item(item);
        store.write_sweep_block(sample_block(item, range(0, 5)));  // vertex 4 failed
        if (release) store.release(item.name);
        EXPECT_EQ(store.finished_vertices(item.name), range(0, 5));
        EXPECT_THROW(store.write_sweep_block(sample_block(item, {3})), std::invalid_argument);
        if (release) store.release(item.name);
        SweepBlock again = sample_block(item, {4, 5, 6});
        again.rows[0].flips = 77;
        store.write_sweep_block(again);
        if (release) store.release(item.name);
        EXPECT_EQ(store.finished_rows(item.name).at(4).flips, 77);
        store.assemble({item.name}, kSampleKeep);
        EXPECT_EQ(store.finished_vertices(item.name), range(0, 7));
    };
    write(folder.file("held.h5"), false);
    write(folder.file("released.h5"), true);
    EXPECT_EQ(digests(folder.file("released.h5")), digests(folder.file("held.h5")));
}

}  // namespace
}  // namespace ricci
