// A sweep without a file holds what the file of the same sweep holds.
#include "engine/app/sweep_job.h"

#include <gtest/gtest.h>

#include "engine/surfaces/generate.h"
#include "tests/support/program.h"

namespace ricci::app {
namespace {

using ricci::testing::TemporaryFolder;

std::vector<SweepSource> files_of(const TemporaryFolder& folder) {
    std::vector<std::string> files;
    for (const char* name : {"eight", "torus"}) {
        GenerateOptions options;
        options.faces = 600;
        files.push_back(folder / (std::string(name) + ".off"));
        save_mesh(files.back(), generate(name, options));
    }
    files.push_back(folder / "missing.off");
    return sweep_sources(files);
}

void expect_equal(const SweepRow& a, const SweepRow& b) {
    EXPECT_EQ(a.vertex, b.vertex);
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.area_distortion, b.area_distortion);
    EXPECT_EQ(a.residual_max, b.residual_max);
    EXPECT_EQ(a.flips, b.flips);
}

void expect_equal(const StoredSweep& a, const StoredSweep& b) {
    ASSERT_EQ(a.rows.size(), b.rows.size());
    for (std::size_t k = 0; k < a.rows.size(); ++k) expect_equal(a.rows[k], b.rows[k]);
    EXPECT_EQ(a.best, b.best);
    EXPECT_EQ(a.worst, b.worst);
    ASSERT_EQ(a.kept.size(), b.kept.size());
    for (std::size_t k = 0; k < a.kept.size(); ++k) {
        EXPECT_EQ(a.kept[k].vertex, b.kept[k].vertex);
        EXPECT_EQ(a.kept[k].conformal_factor, b.kept[k].conformal_factor);
    }
}

class Keeping : public ::testing::TestWithParam<const char*> {};

TEST_P(Keeping, MemoryAndFileAgree) {
    const TemporaryFolder folder;
    SweepConfig config;
    config.vertices = "sample:40";
    config.resolutions = {"400", "input"};
    config.keep = GetParam();
    config.threads = 2;
    config.output = folder / "out.h5";
    const std::vector<SweepSource> sources = files_of(folder);
    ProgressLine quiet(true);
    const auto never = [] { return false; };
    const SweepPlan plan(sources.size(), config.resolutions.size());
    const SweepJob job = sweep_to_file(config, sources, plan, quiet, never);
    EXPECT_TRUE(job.any_failure);
    const StoredRun file = read_run(config.output), memory = sweep_in_memory(config, sources, quiet, never);
    ASSERT_EQ(file.items.size(), memory.items.size());
    for (std::size_t i = 0; i < file.items.size(); ++i) {
        EXPECT_EQ(file.items[i].item.name, memory.items[i].item.name);
        EXPECT_EQ(file.items[i].item.points, memory.items[i].item.points);
        ASSERT_EQ(file.items[i].sweep.has_value(), memory.items[i].sweep.has_value());
        if (file.items[i].sweep) expect_equal(*file.items[i].sweep, *memory.items[i].sweep);
    }
    ASSERT_EQ(file.failures.size(), memory.failures.size());
    for (std::size_t k = 0; k < file.failures.size(); ++k) {
        EXPECT_EQ(file.failures[k].item, memory.failures[k].item);
        EXPECT_EQ(file.failures[k].stage, memory.failures[k].stage);
        EXPECT_EQ(file.failures[k].message, memory.failures[k].message);
    }
}

INSTANTIATE_TEST_SUITE_P(SweepJob, Keeping,
                         ::testing::Values("none", "best", "worst", "best,worst", "3", "all"));

TEST(SweepJob, WhatIsStoppedIsNotAssembled) {
    const TemporaryFolder folder;
    SweepConfig config;
    config.threads = 1;
    config.output = folder / "out.h5";
    ProgressLine quiet(true);
    const std::vector<SweepSource> sources = files_of(folder);
    const SweepJob job =
        sweep_to_file(config, sources, SweepPlan(sources.size(), 1), quiet, [] { return true; });
    EXPECT_TRUE(job.stopped);
    EXPECT_FALSE(std::filesystem::exists(config.output));
}

TEST(SweepJob, MeshesInMemoryAreNamedAsFilesAre) {
    GenerateOptions options;
    options.faces = 400;
    auto loaded = std::make_shared<LoadedMesh>();
    loaded->stem = "shape";
    loaded->components.push_back(generate("eight", options));
    std::vector<SweepSource> sources{{"", "", loaded}, {"folder/shape.off.gz", ""}, {"", "", loaded}};
    name_sources(sources);
    EXPECT_EQ(sources[0].name, "shape");
    EXPECT_EQ(sources[1].name, "shape~2");
    EXPECT_EQ(sources[2].name, "shape~3");
    EXPECT_EQ(sources[2].suffix(), "~3");
}

}  // namespace
}  // namespace ricci::app
