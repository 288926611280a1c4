// The program as a whole: exit status, what it writes, determinism, resuming, verification.
#include "tests/support/program.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"
#include "tests/support/random_targets.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using ricci::testing::make;
using ricci::testing::objects;
using ricci::testing::ProgramResult;
using ricci::testing::read_text;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;
using ricci::testing::write_text;
using Words = std::vector<std::string>;

bool same_bits(double a, double b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Everything but seconds, bit for bit.
void expect_same(const StoredRun& a, const StoredRun& b) {
    ASSERT_EQ(a.items.size(), b.items.size());
    for (std::size_t i = 0; i < a.items.size(); ++i) {
        EXPECT_EQ(a.items[i].item.name, b.items[i].item.name);
        EXPECT_EQ(a.items[i].item.points, b.items[i].item.points);
        ASSERT_EQ(a.items[i].sweep.has_value(), b.items[i].sweep.has_value());
        if (!a.items[i].sweep) continue;
        const StoredSweep &x = *a.items[i].sweep, &y = *b.items[i].sweep;
        ASSERT_EQ(x.rows.size(), y.rows.size());
        for (std::size_t k = 0; k < x.rows.size(); ++k) {
            EXPECT_EQ(x.rows[k].vertex, y.rows[k].vertex);
            EXPECT_EQ(x.rows[k].status, y.rows[k].status);
            EXPECT_EQ(x.rows[k].flips, y.rows[k].flips);
            EXPECT_EQ(x.rows[k].newton_iterations, y.rows[k].newton_iterations);
            EXPECT_TRUE(same_bits(x.rows[k].area_distortion, y.rows[k].area_distortion))
                << "vertex " << x.rows[k].vertex;
            EXPECT_TRUE(same_bits(x.rows[k].residual_max, y.rows[k].residual_max))
                << "vertex " << x.rows[k].vertex;
        }
        EXPECT_EQ(x.best, y.best);
        EXPECT_EQ(x.worst, y.worst);
        ASSERT_EQ(x.kept.size(), y.kept.size());
        for (std::size_t k = 0; k < x.kept.size(); ++k)
            EXPECT_EQ(x.kept[k].conformal_factor, y.kept[k].conformal_factor);
    }
    EXPECT_EQ(a.failures.size(), b.failures.size());
}

TEST(Program, ExitStatusTellsUsageFromEnvironment) {
    const TemporaryFolder folder;
    EXPECT_EQ(run_ricci(folder, {}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"--help"}).status, 0);
    EXPECT_EQ(run_ricci(folder, {"--version"}).status, 0);
    EXPECT_EQ(run_ricci(folder, {"flow"}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"info", folder / "none.obj"}).status, 3);
    EXPECT_EQ(run_ricci(folder, {"sweep", "--config", folder / "none.toml"}).status, 3);
    const std::string mesh = make(folder, "eight", 400);
    EXPECT_EQ(run_ricci(folder, {"flow", mesh, "--cone=999999:-4pi"}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"flow", mesh, "--scheme", "nonsense"}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"sweep", mesh, "--vertices", "sample:2", "-o", "/proc/none/x.h5"}).status,
              3);
    for (const char* command : {"info", "generate", "flow", "sweep", "verify", "export"}) {
        const ProgramResult help = run_ricci(folder, {command, "--help"});
        EXPECT_EQ(help.status, 0) << command;
        EXPECT_NE(help.out.find("Example:"), std::string::npos) << command;
    }
}

TEST(Program, SweepIsTheSameForAnyThreadsAndVerifies) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 1500);
    const auto sweep = [&](const std::string& out, const char* threads) {
        const ProgramResult r =
            run_ricci(folder, {"sweep", mesh, "--vertices", "sample:60:4", "--resolutions", "input,1000",
                               "--keep", "4", "--threads", threads, "-o", folder / out});
        EXPECT_EQ(r.status, 0) << r.err;
    };
    sweep("one.h5", "1");
    sweep("two.h5", "2");
    sweep("three.h5", "3");
    sweep("eight.h5", "8");
    const StoredRun one = read_run(folder / "one.h5");
    ASSERT_EQ(one.items.size(), 2U);
    EXPECT_EQ(one.items[0].sweep->rows.size(), 60U);
    expect_same(one, read_run(folder / "two.h5"));
    expect_same(one, read_run(folder / "three.h5"));
    expect_same(one, read_run(folder / "eight.h5"));
    const ProgramResult verified = run_ricci(folder, {"verify", folder / "one.h5", "--recompute", "--json"});
    EXPECT_EQ(verified.status, 0) << verified.err;
    EXPECT_EQ(objects(verified.out).at(0)["recomputed"].size(), 12U)
        << "best, worst and four others of two items";
    EXPECT_EQ(run_ricci(folder, {"export", folder / "one.h5", "-o", folder / "one.csv"}).status, 0);
    EXPECT_EQ(run_ricci(folder, {"export", folder / "one.h5", "-o", folder / "one.vtu"}).status, 0);
    EXPECT_NE(read_text(folder / "one.csv").find("area_distortion"), std::string::npos);
}

TEST(Program, KilledAtRandomMomentsAndResumedEqualsUndisturbed) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 1500), other = make(folder, "torus", 300);
    const Words words{"sweep", mesh, other, "--vertices", "sample:150:2", "--threads", "2", "-o"};
    Words plain = words, killed = words;
    plain.push_back(folder / "plain.h5");
    killed.push_back(folder / "killed.h5");
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(run_ricci(folder, plain).status, 1) << "the torus admits no single cone";
    const auto whole =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start)
            .count();
    killed.emplace_back("--resume");
    std::mt19937 random(7);
    int kills = 0;
    for (int k = 0; k < 12; ++k) {
        const int after = static_cast<int>(random() % static_cast<unsigned>(std::max<long>(whole, 2)));
        kills += run_ricci(folder, killed, after).status == 128 + SIGKILL ? 1 : 0;
    }
    EXPECT_GE(kills, 1);
    EXPECT_EQ(run_ricci(folder, killed).status, 1);
    expect_same(read_run(folder / "plain.h5"), read_run(folder / "killed.h5"));
    EXPECT_FALSE(std::filesystem::exists(folder / "killed.h5.parts"));
    // Everything is finished: a further resume solves nothing and changes nothing.
    const ProgramResult again = run_ricci(folder, killed);
    EXPECT_EQ(again.status, 1);
    expect_same(read_run(folder / "plain.h5"), read_run(folder / "killed.h5"));
}

TEST(Program, InterruptLeavesAResumableRun) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 20000);
    const Words words{"sweep", mesh, "--threads", "1", "-o", folder / "out.h5", "--resume"};
    const ProgramResult stopped = run_ricci(folder, words, 700, SIGINT);
    ASSERT_EQ(stopped.status, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("--resume"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(folder / "out.h5.parts"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
    Words changed = words;
    changed.insert(changed.end(), {"--tolerance", "1e-9"});
    EXPECT_EQ(run_ricci(folder, changed).status, 2) << "another configuration must not continue this run";
}

TEST(Program, AResumeMayChangeTheLanesButNotTheSolver) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 3000);
    const Words words{"sweep", mesh, "--vertices", "sample:600", "--threads", "2"};
    const auto with = [&](const char* out, const Words& more) {
        Words all = words;
        all.insert(all.end(), {"-o", folder / out});
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    ASSERT_EQ(run_ricci(folder, with("plain.h5", {})).status, 0);
    const ProgramResult stopped = run_ricci(folder, with("out.h5", {"--lanes", "1"}), 400, SIGINT);
    ASSERT_EQ(stopped.status, 130) << stopped.err;
    EXPECT_EQ(run_ricci(folder, with("out.h5", {"--resume", "--solver", "newton"})).status, 2);
    EXPECT_EQ(run_ricci(folder, with("out.h5", {"--resume", "--lanes", "5"})).status, 0);
    expect_same(read_run(folder / "plain.h5"), read_run(folder / "out.h5"));
    EXPECT_NE(read_run(folder / "out.h5").info.config.find("lanes = 5"), std::string::npos);
    EXPECT_EQ(run_ricci(folder, with("out.h5", {"--lanes", "17"})).status, 2);
    EXPECT_EQ(run_ricci(folder, with("out.h5", {"--solver", "none"})).status, 2);
}

TEST(Program, BothSolversGiveTheSameSweep) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 1000);
    for (const char* solver : {"lanes", "newton"})
        ASSERT_EQ(run_ricci(folder, {"sweep", mesh, "--vertices", "sample:20", "--solver", solver, "-o",
                                     folder / (std::string(solver) + ".h5")})
                      .status,
                  0);
    const StoredRun lanes = read_run(folder / "lanes.h5"), newton = read_run(folder / "newton.h5");
    const StoredSweep &x = *lanes.items.at(0).sweep, &y = *newton.items.at(0).sweep;
    EXPECT_EQ(x.best, y.best);
    EXPECT_EQ(x.worst, y.worst);
    for (std::size_t k = 0; k < x.rows.size(); ++k)
        EXPECT_NEAR(x.rows[k].area_distortion, y.rows[k].area_distortion, 1e-6 * y.rows[k].area_distortion);
}

TEST(Program, ABadItemDoesNotStopTheBatch) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 400);
    write_text(folder / "broken.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n");
    // Two components: each an item; a sphere admits no cone, which is recorded.
    const std::string sphere = make(folder, "sphere", 80);
    const ProgramResult r =
        run_ricci(folder, {"sweep", folder / "broken.off", mesh, folder / "missing.obj", sphere, mesh,
                           "--vertices", "sample:3", "--json", "-o", folder / "out.h5"});
    EXPECT_EQ(r.status, 1);
    const auto lines = objects(r.out);
    ASSERT_EQ(lines.size(), 5U);
    EXPECT_EQ(lines[0]["status"], "invalid_input");
    EXPECT_EQ(lines[1]["solved"], 3);
    EXPECT_EQ(lines[2]["status"], "invalid_input");
    EXPECT_EQ(lines[3]["status"], "inadmissible_target");
    EXPECT_EQ(lines[4]["item"].get<std::string>(), lines[1]["item"].get<std::string>() + "~2");
    const StoredRun run = read_run(folder / "out.h5");
    EXPECT_EQ(run.items.size(), 3U);
    EXPECT_EQ(run.failures.size(), 3U);
    EXPECT_NE(r.err.find("broken"), std::string::npos);
}

TEST(Program, ComponentsBecomeItems) {
    const TemporaryFolder folder;
    // Two tetrahedra, the second listed first by its faces: items are ordered by lowest vertex.
    write_text(folder / "two.off",
               "OFF\n8 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n5 0 0\n6 0 0\n5 1 0\n5 0 2\n"
               "3 4 6 5\n3 4 5 7\n3 5 6 7\n3 6 4 7\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    const ProgramResult r = run_ricci(
        folder, {"flow", folder / "two.off", "--target", "uniform", "--json", "-o", folder / "o.h5"});
    EXPECT_EQ(r.status, 0) << r.err;
    const auto lines = objects(r.out);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[0]["item"], "two.c0@4");
    const StoredRun run = read_run(folder / "o.h5");
    EXPECT_EQ(run.items.at(0).item.source_vertex, (std::vector<Index>{0, 1, 2, 3}));
    EXPECT_EQ(run.items.at(1).item.source_vertex, (std::vector<Index>{4, 5, 6, 7}));
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "o.h5", "--recompute"}).status, 0);
}

/// A stored solution that is not one is found out, whatever residual it claims.
TEST(Program, RecomputeFindsAFalseSolution) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 400);
    ASSERT_EQ(run_ricci(folder, {"sweep", mesh, "--vertices", "sample:4", "-o", folder / "good.h5"}).status,
              0);
    StoredRun run = read_run(folder / "good.h5");
    run.info.fingerprint = "forged";
    StoredItem& item = run.items.at(0);
    const auto forge = [&](const std::string& name, double shift, double distortion) {
        RunStore store(folder / name, run.info, false);
        store.write_item(item.item);
        SweepBlock block{item.item.name, item.sweep->rows, item.sweep->kept};
        for (KeptFactor& kept : block.kept) {
            kept.conformal_factor[5] += shift;
            kept.area_distortion += distortion;
        }
        for (SweepRow& row : block.rows) row.area_distortion += distortion;
        store.write_sweep_block(block);
        store.assemble({item.item.name}, {});
    };
    forge("same.h5", 0.0, 0.0);
    forge("shifted.h5", 1e-6, 0.0);
    forge("flattered.h5", 0.0, 1e-5);
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "same.h5", "--recompute"}).status, 0);
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "shifted.h5"}).status, 0) << "the form is sound";
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "shifted.h5", "--recompute"}).status, 1);
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "flattered.h5", "--recompute"}).status, 1);
}

TEST(Program, FlowRecordsVerifyForEveryGeometrySchemeAndBoundary) {
    const TemporaryFolder folder;
    const std::string eight = make(folder, "eight", 400), torus = make(folder, "torus", 300),
                      disk = make(folder, "disk", 200), pants = make(folder, "pants", 400);
    const SurfaceMesh surface = load_mesh(pants).components.at(0);
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(surface.connectivity);
    const auto interior =
        std::find(on_boundary.begin(), on_boundary.end(), std::uint8_t{0}) - on_boundary.begin();
    const std::vector<Words> runs{{eight},
                                  {eight, "--target", "uniform"},
                                  {eight, "--cone=3:-4pi"},
                                  {eight, "--cone=3:-4pi", "--delaunay", "none"},
                                  {eight, "--scheme", "thurston"},
                                  {eight, "--scheme", "inversive-distance", "--target", "uniform"},
                                  {eight, "--scheme", "tangential", "--cone=3:-4pi", "--densify"},
                                  {torus},
                                  {torus, "--scheme", "virtual-radius"},
                                  {disk, "--target", "boundary"},
                                  {disk, "--geometry", "euclidean", "--boundary", "free"},
                                  {pants},
                                  {pants, "--geometry", "hyperbolic", "--scheme", "tangential"},
                                  {pants, "--cone=" + std::to_string(interior) + ":-2pi"}};
    for (const Words& words : runs) {
        Words flow{"flow", "--tolerance", "1e-10", "-o", folder / "f.h5"};
        flow.insert(flow.end(), words.begin(), words.end());
        const ProgramResult r = run_ricci(folder, flow);
        std::string line;
        for (const std::string& w : words) line += w + " ";
        EXPECT_EQ(r.status, 0) << line << r.err;
        const ProgramResult verified = run_ricci(folder, {"verify", folder / "f.h5", "--recompute"});
        EXPECT_EQ(verified.status, 0) << line << verified.out << verified.err;
    }
}

TEST(Program, DryRunWritesNothing) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 400);
    const ProgramResult r =
        run_ricci(folder, {"sweep", mesh, "--dry-run", "--json", "-o", folder / "out.h5"});
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_GT(objects(r.out).at(0)["estimated_megabytes"].get<double>(), 0.0);
    EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
    EXPECT_FALSE(std::filesystem::exists(folder / "out.h5.parts"));
}

TEST(Program, MoreDigitsAreStoredAndVerified) {
    const TemporaryFolder folder;
    const std::string mesh = folder / "sphere.off";
    ASSERT_EQ(run_ricci(folder, {"generate", "sphere", "--faces", "2000", "--jitter", "0.3", "--seed", "1",
                                 "-o", mesh, "-q"})
                  .status,
              0);
    std::string lines;
    for (const double k :
         testing::random_target(load_mesh(mesh).components.front(), testing::TargetDraw::random, 3))
        lines += fmt::format("{}\n", k);
    write_text(folder / "target.txt", lines);
    const Words flow = {"flow", mesh, "--target", folder / "target.txt", "--json"};
    const auto with = [&](Words more) {
        Words words = flow;
        words.insert(words.end(), more.begin(), more.end());
        return run_ricci(folder, words);
    };
    const ProgramResult plain = with({"--precision", "double"});
    EXPECT_EQ(plain.status, 1);
    EXPECT_EQ(objects(plain.out).at(0)["status"], "stalled");
    EXPECT_EQ(objects(plain.out).at(0)["precision_digits"], 16);
    const ProgramResult solved = with({"-o", folder / "f.h5"});
    EXPECT_EQ(solved.status, 0) << solved.err;
    const auto object = objects(solved.out).at(0);
    EXPECT_EQ(object["status"], "converged");
    EXPECT_GT(object["precision_digits"], 16);
    EXPECT_EQ(object["extended_precision"], true);
    EXPECT_LE(object["residual_max"], 1e-10);
    const ProgramResult verified = run_ricci(folder, {"verify", folder / "f.h5", "--recompute", "--json"});
    EXPECT_EQ(verified.status, 0) << verified.out;
    const auto again = objects(verified.out).at(0)["recomputed"].at(0);
    EXPECT_EQ(again["digits"], 50);
    EXPECT_LE(again["residual_recomputed"], 1.1e-10);
    EXPECT_LE(again["gauss_bonnet_error_recomputed"], 1e-10);
    // Without its low part the stored factor is another one.
    const StoredRun run = read_run(folder / "f.h5");
    FlowRecord record = *run.items.at(0).flow;
    ASSERT_FALSE(record.conformal_factor_low.empty());
    record.conformal_factor_low.clear();
    {
        RunStore store(folder / "rounded.h5", run.info, false);
        store.write_item(run.items.at(0).item);
        store.write_flow(record);
        store.assemble({run.items.at(0).item.name}, {});
    }
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "rounded.h5", "--recompute"}).status, 1);
    EXPECT_EQ(with({"--precision", "quadruple"}).status, 2);
}

}  // namespace
}  // namespace ricci
