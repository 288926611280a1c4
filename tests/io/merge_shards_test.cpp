// Shards of a made-up run: joined, and refused where they are not the whole of one run.
#include "io/store/merge_shards.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "io/store/shard_table.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;
namespace fs = std::filesystem;

/// The whole run: items "a@18", "a@18~2" and "a@18~3" of three inputs, each with `kRows` rows, and an input
/// that cannot be read.
constexpr Index kRows = 6;

std::vector<Index> all_rows() {
    std::vector<Index> vertices;
    for (Index v = 0; v < kRows; ++v) vertices.push_back(v);
    return vertices;
}

/// What one shard has of an item.
struct Part {
    std::int32_t input = 0;
    std::vector<Index> vertices;
};

struct ShardSample {
    RunInfo info = sample_info();
    ShardTable table;
    std::vector<Part> parts;
    bool unreadable = false;  // input 3
    double raise = 0.0;       // of the first point: another mesh
    std::string hash;         // of the input files
    std::string given_up;     // an item that failed as a whole, by its name in the shard

    void write(const std::string& path) const;
};

void ShardSample::write(const std::string& path) const {
    RunStore store(path, info, false);
    ShardTable own = table;
    std::vector<std::string> names;
    for (const Part& part : parts) {
        ItemRecord item = sample_item(names.empty() ? "a@18" : "a@18~" + std::to_string(names.size() + 1), 3);
        item.source = "input" + std::to_string(part.input);
        item.points[0][0] += raise;
        if (!hash.empty()) item.source_hash = hash;
        store.write_item(item);
        names.push_back(item.name);
        const bool failed = item.name == given_up;
        if (!failed) store.write_sweep_block(sample_block(item, part.vertices));
        if (failed) store.write_failure({item.name, "sweep", "out_of_memory", "too big"});
        own.items.push_back({item.name, "a@18", part.input, 0, 0, kRows,
                             failed ? -1 : static_cast<std::int32_t>(part.vertices.size()),
                             digest_of_vertices(all_rows()), 1});
    }
    if (unreadable) {
        store.write_failure({"b", "load", "invalid_input", "cut off"});
        own.items.push_back({"b", "b", 3, -1, -1, -1, -1, 0, 0});
    }
    store.assemble(names, own.keep, &own);
}

ShardSample sample_shard(std::int32_t index, std::vector<Part> parts, bool unreadable) {
    ShardSample sample;
    sample.table.index = index;
    sample.table.count = 3;
    sample.table.inputs = 4;
    sample.table.plan = "0123456789abcdef";
    sample.table.config = "[run]\n";
    sample.table.fingerprint = "whole";
    sample.table.keep = kSampleKeep;
    sample.info.fingerprint = "shard " + std::to_string(index);
    sample.parts = std::move(parts);
    sample.unreadable = unreadable;
    return sample;
}

class MergeShards : public ::testing::Test {
  protected:
    MergeShards() {
        samples_ = {sample_shard(0, {{0, {0, 2}}, {2, {0, 1, 2, 3, 4, 5}}}, true),
                    sample_shard(1, {{0, {1, 3, 4, 5}}, {1, {5, 0}}}, false),
                    sample_shard(2, {{1, {1, 2, 3, 4}}}, true)};
    }

    std::vector<std::string> write() const {
        std::vector<std::string> paths;
        for (const ShardSample& sample : samples_) {
            paths.push_back(folder_.file("s" + std::to_string(paths.size()) + ".h5"));
            sample.write(paths.back());
        }
        return paths;
    }
    std::vector<std::string> complaints(const std::vector<std::string>& paths) const {
        try {
            merge_shards(paths, output(), sample_info());
        } catch (const ShardError& error) {
            EXPECT_FALSE(fs::exists(output()));
            EXPECT_FALSE(fs::exists(output() + ".parts"));
            return error.complaints();
        }
        return {};
    }
    /// The only complaint, empty unless there is one.
    std::string complaint() const {
        const std::vector<std::string> all = complaints(write());
        return all.size() == 1 ? all[0] : std::string();
    }
    std::string output() const { return folder_.file("whole.h5"); }

    TemporaryFolder folder_;
    std::vector<ShardSample> samples_;
};

void expect_word(const std::string& text, const std::string& word) {
    EXPECT_NE(text.find(word), std::string::npos) << '"' << text << "\" lacks \"" << word << '"';
}

TEST_F(MergeShards, EqualTheRunOnOneMachine) {
    const MergedRun merged = merge_shards(write(), output(), sample_info());
    EXPECT_EQ(merged.shards, 3U);
    EXPECT_EQ(merged.items, 3U);
    EXPECT_EQ(merged.rows, 3U * kRows);
    EXPECT_EQ(merged.failures, 1U) << "both shards that met the unreadable input say so";
    {
        RunStore store(folder_.file("undivided.h5"), sample_info(), false);
        std::vector<std::string> names{"a@18", "a@18~2", "a@18~3"};
        for (std::size_t i = 0; i < names.size(); ++i) {
            ItemRecord item = sample_item(names[i], 3);
            item.source = "input" + std::to_string(i);
            store.write_item(item);
            store.write_sweep_block(sample_block(item, all_rows()));
        }
        store.write_failure({"b", "load", "invalid_input", "cut off"});
        store.assemble(names, kSampleKeep);
    }
    EXPECT_EQ(digests(output()), digests(folder_.file("undivided.h5")));
    EXPECT_EQ(verify_structure(output()), std::vector<std::string>());
    const StoredRun run = read_run(output());
    EXPECT_EQ(run.info.fingerprint, "whole");
    EXPECT_EQ(run.items.at(1).item.source, "input1") << "named ~2 in one shard, a@18 in another";
    EXPECT_FALSE(fs::exists(output() + ".parts"));
}

TEST_F(MergeShards, MissingAndDoubledShardsAreNamed) {
    const std::vector<std::string> paths = write();
    EXPECT_EQ(complaints({paths[2]}), (std::vector<std::string>{"missing shards 0/3 to 1/3"}));
    const std::vector<std::string> doubled = complaints({paths[0], paths[1], paths[1], paths[2]});
    ASSERT_EQ(doubled.size(), 1U);
    expect_word(doubled[0], "shard 1/3 comes twice");
    EXPECT_EQ(complaints({}).size(), 1U);
}

TEST_F(MergeShards, UnfinishedShardsAreNamed) {
    const std::vector<std::string> paths = write();
    fs::remove(paths[1]);
    {
        RunStore store(paths[1], samples_[1].info, false);
        store.write_item(sample_item("a@18", 3));
    }
    const std::vector<std::string> all = complaints(paths);
    ASSERT_EQ(all.size(), 2U);
    expect_word(all[0], paths[1] + ": unfinished");
    EXPECT_EQ(all[1], "missing shard 1/3");
}

TEST_F(MergeShards, DamagedAndForeignFilesAreNamed) {
    std::vector<std::string> paths = write();
    fs::resize_file(paths[0], fs::file_size(paths[0]) / 2);
    write_sample_run(paths[1], false);
    paths.push_back(folder_.file("none.h5"));
    const std::vector<std::string> all = complaints(paths);
    ASSERT_EQ(all.size(), 4U);
    expect_word(all[0], paths[0]);
    expect_word(all[1], paths[1] + ": not made with --shard");
    expect_word(all[2], "none.h5: no such file");
    EXPECT_EQ(all[3], "missing shards 0/3 to 1/3");
}

TEST_F(MergeShards, ShardsOfAnotherRunAreRefused) {
    const std::vector<ShardSample> good = samples_;
    samples_[1].table.fingerprint = "other";
    expect_word(complaint(), "s1.h5 differ in the configuration");
    samples_ = good;
    samples_[2].info.git = "other";
    expect_word(complaint(), "the version of the program");
    samples_ = good;
    samples_[1].table.count = 4;
    expect_word(complaint(), "the number of shards");
    samples_ = good;
    samples_[2].table.plan = "other";
    expect_word(complaint(), "the input files were not the same");
}

TEST_F(MergeShards, EveryChosenVertexComesOnce) {
    const std::vector<ShardSample> good = samples_;
    samples_[2].parts[0].vertices.pop_back();
    expect_word(complaint(), "a@18~2: 5 of its 6 chosen vertices are in shards 1/3, 2/3");
    samples_ = good;
    samples_[2].parts[0].vertices = {0, 2, 3, 4};
    expect_word(complaint(), "a@18~2: vertex 0 is in shard 2/3 and in another one");
    samples_ = good;
    samples_[2].parts[0].vertices = {1, 2, 3, 6};
    expect_word(complaint(), "not those of the chosen vertices");
    samples_ = good;
    samples_[0].parts.pop_back();
    expect_word(complaint(), "input 2 is in no shard");
    samples_ = good;
    samples_[1].raise = 1e-3;
    EXPECT_FALSE(complaint().empty()) << "another mesh";
}

TEST_F(MergeShards, OtherContentsOfAnInputAreNamed) {
    samples_[2].hash = "00000000000000aa";
    expect_word(complaint(), "input1: shards 1/3 and 2/3 read different contents of this file");
}

TEST_F(MergeShards, OtherProcessorsAreNamed) {
    for (ShardSample& sample : samples_) sample.table.processors = "lanes avx512";
    EXPECT_TRUE(merge_shards(write(), output(), sample_info()).warnings.empty());
    samples_[1].table.processors = "lanes avx2";
    const MergedRun mixed = merge_shards(write(), output(), sample_info());
    ASSERT_EQ(mixed.warnings.size(), 1U);
    expect_word(mixed.warnings[0], "lanes avx2 (shards 1/3), lanes avx512 (shards 0/3, 2/3)");
    for (ShardSample& sample : samples_) sample.table.processors = "lanes avx2; lanes avx512";
    EXPECT_EQ(merge_shards(write(), output(), sample_info()).warnings.size(), 1U) << "mixed within each";
}

// An item that one shard gave up on is a failure in the whole run, with the rows there are.
TEST_F(MergeShards, AnItemGivenUpStaysAFailure) {
    samples_[2].given_up = "a@18";
    const MergedRun merged = merge_shards(write(), output(), sample_info());
    EXPECT_EQ(merged.failures, 2U);
    const StoredRun run = read_run(output());
    EXPECT_EQ(run.items.at(1).sweep->rows.size(), 2U);
    EXPECT_EQ(run.failures.at(0).item, "a@18~2");
    ASSERT_EQ(merged.warnings.size(), 1U);
    expect_word(merged.warnings[0], "a@18~2: without the rows of shards 2/3");
}

TEST_F(MergeShards, TheOldFileStaysUntilTheNewOneIsWhole) {
    const std::vector<std::string> paths = write();
    merge_shards(paths, output(), sample_info());
    const auto before = digests(output());
    EXPECT_THROW(merge_shards({paths[0]}, output(), sample_info()), ShardError);
    EXPECT_EQ(digests(output()), before);
    {
        RunStore store(output(), sample_info(), false);
        store.write_item(sample_item("a@18", 3));
    }
    EXPECT_THROW(merge_shards(paths, output(), sample_info()), ShardError) << "a run is under way there";
    EXPECT_TRUE(fs::exists(output() + ".parts/journal"));
}

}  // namespace
}  // namespace ricci
