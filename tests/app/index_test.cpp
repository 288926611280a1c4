// `ricci index`: what it describes and what it does not describe again, answers, death and resumption.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include "io/mesh/mesh_file.h"
#include "io/store/shape_index.h"
#include "tests/support/program.h"

namespace ricci {
namespace {

namespace fs = std::filesystem;
using ricci::testing::make;
using ricci::testing::objects;
using ricci::testing::ProgramResult;
using ricci::testing::read_text;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;
using ricci::testing::write_text;
using Words = std::vector<std::string>;

/// Surfaces of one topology: the generated one, bent by a few smooth waves that depend on `k`.
std::string make_bent(const TemporaryFolder& folder, const std::string& base, int k,
                      const std::string& name) {
    SurfaceMesh mesh = load_mesh(base).components.at(0);
    for (Point& p : mesh.points)
        p = {p[0] * (1.0 + 0.05 * k), p[1] + 0.04 * k * std::sin(2.0 * p[0]), p[2] + 0.03 * k * p[0] * p[1]};
    save_mesh(folder / name, mesh);
    return folder / name;
}

/// Five bent eights, three bent tori, in a folder.
struct Collection {
    TemporaryFolder folder;
    std::vector<std::string> eights, tori;

    Collection() {
        fs::create_directory(folder / "set");
        fs::create_directory(folder / "set/deeper");
        const std::string eight = make(folder, "eight", 500), torus = make(folder, "torus", 300);
        for (int k = 0; k < 5; ++k)
            eights.push_back(make_bent(folder, eight, k, "set/eight" + std::to_string(k) + ".off"));
        for (int k = 0; k < 3; ++k)
            tori.push_back(make_bent(folder, torus, k, "set/deeper/torus" + std::to_string(k) + ".obj"));
    }
    [[nodiscard]] ProgramResult run(Words words) const {
        words.insert(words.begin(), "index");
        return run_ricci(folder, words);
    }
};

/// Everything but seconds, bit for bit.
void expect_same(const std::string& path_a, const std::string& path_b) {
    const ShapeIndex a = read_shape_index(path_a), b = read_shape_index(path_b);
    ASSERT_EQ(a.entries.size(), b.entries.size());
    for (std::size_t i = 0; i < a.entries.size(); ++i) {
        const ShapeRecord &x = a.entries[i].shape, &y = b.entries[i].shape;
        EXPECT_EQ(a.entries[i].file, b.entries[i].file);
        EXPECT_EQ(x.hash, y.hash);
        EXPECT_EQ(x.component, y.component);
        EXPECT_EQ(x.fingerprint, y.fingerprint);
        EXPECT_EQ(x.coordinates, y.coordinates);
        EXPECT_EQ(x.lengths, y.lengths);
        EXPECT_EQ(x.primitive, y.primitive);
        EXPECT_EQ(x.complete_up_to, y.complete_up_to);
        EXPECT_EQ(x.marking_gap, y.marking_gap);
        EXPECT_EQ(x.message, y.message);
    }
    ASSERT_EQ(a.failures.size(), b.failures.size());
    for (std::size_t i = 0; i < a.failures.size(); ++i) {
        EXPECT_EQ(a.failures[i].item, b.failures[i].item);
        EXPECT_EQ(a.failures[i].message, b.failures[i].message);
    }
}

std::size_t reused(const ProgramResult& result) {
    std::size_t count = 0;
    for (const nlohmann::json& o : objects(result.out)) count += o["reused"].get<bool>() ? 1 : 0;
    return count;
}

TEST(IndexCommand, FoldersAndGlobsGiveTheSameIndexForAnyThreads) {
    const Collection c;
    const std::string one = c.folder / "one.h5", three = c.folder / "three.h5";
    const ProgramResult built = c.run({"build", c.folder / "set", "-o", one, "--threads", "1"});
    ASSERT_EQ(built.status, 0) << built.err;
    const ProgramResult globbed = c.run(
        {"build", c.folder / "set/deeper/*.obj", c.folder / "set/eight?.off", "-o", three, "--threads", "3"});
    ASSERT_EQ(globbed.status, 0) << globbed.err;
    expect_same(one, three);
    EXPECT_EQ(read_shape_index(one).entries.size(), 8U);
    EXPECT_EQ(run_ricci(c.folder, {"verify", one}).status, 0);
    EXPECT_FALSE(fs::exists(one + ".parts"));
}

TEST(IndexCommand, UnchangedFilesAreNotDescribedAgain) {
    const Collection c;
    const std::string index = c.folder / "index.h5";
    const Words build{"build", c.folder / "set", "-o", index, "--json"};
    EXPECT_EQ(reused(c.run(build)), 0U);
    EXPECT_EQ(reused(c.run(build)), 8U);
    // New contents, a touched file, a moved file.
    fs::copy_file(c.eights[1], c.eights[0], fs::copy_options::overwrite_existing);
    make_bent(c.folder, c.eights[1], 7, "set/eight2.off");
    fs::last_write_time(c.eights[3], fs::file_time_type::clock::now());
    fs::rename(c.eights[4], c.folder / "set/moved.off");
    const ProgramResult again = c.run(build);
    ASSERT_EQ(again.status, 0) << again.err;
    std::set<std::string> described;
    for (const nlohmann::json& o : objects(again.out))
        if (!o["reused"].get<bool>()) described.insert(o["file"]);
    EXPECT_EQ(described, std::set<std::string>{c.eights[2]}) << "the only bytes never seen before";
    const std::string fresh = c.folder / "fresh.h5";
    ASSERT_EQ(c.run({"build", c.folder / "set", "-o", fresh}).status, 0);
    expect_same(index, fresh);
    Words changed = build;
    changed.insert(changed.end(), {"--max-length", "3.5"});
    EXPECT_EQ(reused(c.run(changed)), 0U) << "other options, other shapes";
}

TEST(IndexCommand, AddAndRemoveEqualBuildingFromTheStart) {
    const Collection c;
    const std::string grown = c.folder / "grown.h5", whole = c.folder / "whole.h5";
    ASSERT_EQ(c.run({"build", c.folder / "set/eight*", "-o", grown, "--max-length", "3"}).status, 0);
    const ProgramResult added = c.run({"add", grown, c.folder / "set/deeper", c.eights[0], "--json"});
    ASSERT_EQ(added.status, 0) << added.err;
    EXPECT_EQ(objects(added.out).size(), 4U) << "what stays is not looked at";
    EXPECT_EQ(reused(added), 1U);
    ASSERT_EQ(
        c.run({"build", c.folder / "set/eight*", c.folder / "set/deeper", "-o", whole, "--max-length", "3"})
            .status,
        0);
    expect_same(grown, whole);
    EXPECT_NE(read_shape_index(grown).info.fingerprint.find("max_length = 3"), std::string::npos);
    const ProgramResult removed =
        c.run({"remove", grown, c.folder / "set/deeper/", c.eights[1], c.folder / "set/*4.off", "--json"});
    ASSERT_EQ(removed.status, 0) << removed.err;
    EXPECT_EQ(objects(removed.out).at(0)["removed"], 5);
    EXPECT_EQ(objects(removed.out).at(0)["left"], 3);
    ASSERT_EQ(
        c.run({"build", c.eights[0], c.eights[2], c.eights[3], "-o", whole, "--max-length", "3"}).status, 0);
    expect_same(grown, whole);
    EXPECT_EQ(c.run({"remove", grown, "nobody.off"}).status, 1);
    expect_same(grown, whole);
}

TEST(IndexCommand, QueryFindsTheShapeItselfThenTheOthersByDistance) {
    const Collection c;
    const std::string index = c.folder / "index.h5";
    ASSERT_EQ(c.run({"build", c.folder / "set", "-o", index}).status, 0);
    for (const std::string metric : {"spectrum", "coordinates"}) {
        const ProgramResult known =
            c.run({"query", index, c.eights[2], "-k", "9", "--metric", metric, "--json"});
        ASSERT_EQ(known.status, 0) << known.err;
        const nlohmann::json o = objects(known.out).at(0);
        ASSERT_EQ(o["neighbours"].size(), 5U) << "all of its type";
        EXPECT_EQ(o["neighbours"][0]["file"], c.eights[2]);
        EXPECT_EQ(o["neighbours"][0]["distance"], 0.0);
        for (std::size_t i = 1; i < 5; ++i)
            EXPECT_GE(o["neighbours"][i]["distance"].get<double>(),
                      o["neighbours"][i - 1]["distance"].get<double>());
        // A copy in another format has to be described, and comes out the same.
        save_mesh(c.folder / "copy.ply", load_mesh(c.eights[2]).components.at(0));
        const ProgramResult copy =
            c.run({"query", index, c.folder / "copy.ply", "-k", "9", "--metric", metric, "--json"});
        EXPECT_EQ(objects(copy.out).at(0)["neighbours"], o["neighbours"]);
        const ProgramResult others = c.run(
            {"query", index, c.eights[2], c.tori[0], "-k", "1", "--others", "--metric", metric, "--json"});
        const auto lines = objects(others.out);
        ASSERT_EQ(lines.size(), 2U);
        EXPECT_EQ(lines[0]["neighbours"][0], o["neighbours"][1]);
        EXPECT_NE(lines[1]["neighbours"][0]["file"], c.tori[0]);
    }
    const ProgramResult none = c.run({"query", index, make(c.folder, "annulus", 300), "--json"});
    EXPECT_EQ(none.status, 0) << none.err;
    EXPECT_TRUE(objects(none.out).at(0)["neighbours"].empty()) << "no shape of this type";
    EXPECT_EQ(c.run({"query", index, c.eights[0], "--metric", "taxi"}).status, 2);
    EXPECT_EQ(c.run({"query", index, c.folder / "none.off"}).status, 3);
    EXPECT_EQ(c.run({"query", c.folder / "none.h5", c.eights[0]}).status, 3);
}

TEST(IndexCommand, BadFilesAreRecordedAndDoNotStopTheRest) {
    const Collection c;
    write_text(c.folder / "set/broken.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n");
    const std::string index = c.folder / "index.h5";
    const ProgramResult built =
        c.run({"build", c.folder / "set", c.folder / "missing.obj", "-o", index, "--json"});
    EXPECT_EQ(built.status, 1);
    EXPECT_NE(built.err.find("broken.off"), std::string::npos);
    const ShapeIndex stored = read_shape_index(index);
    EXPECT_EQ(stored.entries.size(), 8U);
    ASSERT_EQ(stored.failures.size(), 2U);
    EXPECT_EQ(stored.failures[0].item, c.folder / "set/broken.off");
    EXPECT_EQ(stored.failures[0].stage, "load");
    EXPECT_EQ(stored.failures[1].item, c.folder / "missing.obj");
    std::size_t failed = 0;
    for (const nlohmann::json& o : objects(built.out)) failed += o["status"] == "converged" ? 0 : 1;
    EXPECT_EQ(failed, 2U);
    // Mended: the failure goes, the other stays.
    fs::copy_file(c.eights[0], c.folder / "set/broken.off", fs::copy_options::overwrite_existing);
    EXPECT_EQ(c.run({"add", index, c.folder / "set/broken.off"}).status, 0);
    EXPECT_EQ(read_shape_index(index).failures.size(), 1U);
    EXPECT_EQ(read_shape_index(index).entries.size(), 9U);
    EXPECT_EQ(c.run({"remove", index, c.folder / "missing.obj"}).status, 0);
    EXPECT_TRUE(read_shape_index(index).failures.empty());
}

TEST(IndexCommand, ComponentsAreShapesOfTheirOwn) {
    const Collection c;
    // An eight and a torus in one file, side by side.
    SurfaceMesh eight = load_mesh(c.eights[0]).components.at(0),
                torus = load_mesh(c.tori[0]).components.at(0);
    std::vector<Point> points = eight.points;
    std::vector<Triangle> triangles = triangles_of(eight.connectivity);
    const auto shift = static_cast<Index>(points.size());
    for (const Point& p : torus.points) points.push_back({p[0] + 50.0, p[1], p[2]});
    for (const Triangle& t : triangles_of(torus.connectivity))
        triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    save_mesh(c.folder / "two.off", make_surface_mesh(points, triangles));
    const std::string index = c.folder / "index.h5";
    ASSERT_EQ(c.run({"build", c.folder / "two.off", c.eights[1], "-o", index}).status, 0);
    const ShapeIndex stored = read_shape_index(index);
    ASSERT_EQ(stored.entries.size(), 3U);
    EXPECT_EQ(stored.entries[0].shape.genus, 2);
    EXPECT_EQ(stored.entries[1].shape.genus, 1);
    EXPECT_EQ(stored.entries[1].shape.component, 1);
    const ProgramResult query = c.run({"query", index, c.folder / "two.off", "--json"});
    const auto lines = objects(query.out);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[0]["query"], c.folder / "two.off#c0");
    EXPECT_EQ(lines[1]["neighbours"][0]["component"], 1);
    EXPECT_EQ(reused(c.run({"build", c.folder / "two.off", "-o", index, "--json"})), 2U);
}

TEST(IndexCommand, ResolutionsGiveErrorBars) {
    const Collection c;
    const std::string index = c.folder / "index.h5", plain = c.folder / "plain.h5";
    const ProgramResult built =
        c.run({"build", c.eights[0], c.eights[1], "-o", index, "--resolutions", "300,input,1000"});
    ASSERT_EQ(built.status, 0) << built.err;
    for (const IndexEntry& entry : read_shape_index(index).entries) {
        const auto& r = entry.shape.resolutions;
        ASSERT_EQ(r.size(), 3U);
        EXPECT_LT(r[0].faces, r[1].faces);
        EXPECT_LT(r[1].faces, r[2].faces);
        EXPECT_NEAR(r[2].faces, 1000, 10) << "within 1 % of what was asked for";
        EXPECT_EQ(entry.shape.faces, r[2].faces) << "the finest is the entry";
        EXPECT_EQ(entry.shape.fingerprint, r[2].fingerprint);
        EXPECT_NE(entry.shape.fingerprint, r[0].fingerprint);
    }
    ASSERT_EQ(c.run({"build", c.eights[0], c.eights[1], "-o", plain}).status, 0);
    EXPECT_EQ(read_shape_index(index).entries[0].shape.resolutions[1].fingerprint,
              read_shape_index(plain).entries[0].shape.fingerprint);
    EXPECT_EQ(run_ricci(c.folder, {"verify", index}).status, 0);
    EXPECT_EQ(c.run({"build", c.eights[0], "-o", index, "--resolutions", "many"}).status, 2);
}

TEST(IndexCommand, DistancesAgreeInEveryForm) {
    const Collection c;
    const std::string index = c.folder / "index.h5";
    ASSERT_EQ(c.run({"build", c.folder / "set", "-o", index}).status, 0);
    const ProgramResult r =
        c.run({"distances", index, "--type", "g2b0", "--json", "-o", c.folder / "d.csv", "--svg",
               c.folder / "map.svg", "--dendrogram", c.folder / "tree.svg", "--clusters", "2"});
    ASSERT_EQ(r.status, 0) << r.err;
    const nlohmann::json o = objects(r.out).at(0);
    ASSERT_EQ(o["shapes"].size(), 5U);
    const std::string csv = read_text(c.folder / "d.csv");
    for (std::size_t i = 0; i < 5; ++i) {
        const ProgramResult query = c.run({"query", index, o["shapes"][i], "-k", "5", "--json"});
        for (const auto& n : objects(query.out).at(0)["neighbours"]) {
            const auto found = std::find(o["shapes"].begin(), o["shapes"].end(), n["file"]);
            const auto j = static_cast<std::size_t>(found - o["shapes"].begin());
            EXPECT_EQ(o["distances"][i][j], n["distance"]);
        }
        EXPECT_EQ(o["distances"][i][i], 0.0);
    }
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);
    EXPECT_NE(csv.find("," + fmt::format("{}", o["distances"][1][2].get<double>())), std::string::npos);
    std::set<int> clusters;
    for (const auto& k : o["clusters"]) clusters.insert(k.get<int>());
    EXPECT_EQ(clusters, (std::set<int>{0, 1}));
    for (const char* picture : {"map.svg", "tree.svg"}) {
        const std::string svg = read_text(c.folder / picture);
        for (int k = 0; k < 5; ++k)
            EXPECT_NE(svg.find("eight" + std::to_string(k) + ".off"), std::string::npos) << picture;
    }
    EXPECT_EQ(c.run({"distances", index, "-o", c.folder / "all.csv"}).status, 0);
    EXPECT_TRUE(fs::exists(c.folder / "all.g1b0.csv"));
    EXPECT_TRUE(fs::exists(c.folder / "all.g2b0.csv"));
    EXPECT_EQ(read_text(c.folder / "all.g2b0.csv"), csv);
    EXPECT_EQ(c.run({"distances", index, "-o", c.folder / "all.h5"}).status, 0);
    EXPECT_EQ(run_ricci(c.folder, {"verify", c.folder / "all.h5"}).status, 0);
    EXPECT_EQ(c.run({"distances", index, "--type", "g9b0"}).status, 2);
    EXPECT_EQ(c.run({"distances", index, "-o", c.folder / "all.txt"}).status, 2);
}

TEST(IndexCommand, SameBitsForAnyNumberOfThreads) {
    const Collection c;
    for (const char* threads : {"1", "2", "3", "8"}) {
        const std::string index = c.folder / (std::string(threads) + ".h5");
        ASSERT_EQ(c.run({"build", c.folder / "set", "--threads", threads, "-o", index}).status, 0);
        expect_same(c.folder / "1.h5", index);
    }
}

TEST(IndexCommand, KilledAtRandomMomentsAndResumedEqualsUndisturbed) {
    const Collection c;
    for (int k = 5; k < 60; ++k) make_bent(c.folder, c.eights[0], k, "set/more" + std::to_string(k) + ".off");
    const Words words{"index", "build", c.folder / "set", "--threads", "2", "-o"};
    Words plain = words, killed = words;
    plain.push_back(c.folder / "plain.h5");
    killed.push_back(c.folder / "killed.h5");
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(run_ricci(c.folder, plain).status, 0);
    const auto whole =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start)
            .count();
    killed.emplace_back("--resume");
    std::mt19937 random(11);
    int kills = 0;
    for (int k = 0; k < 8; ++k) {
        const int after = static_cast<int>(random() % static_cast<unsigned>(std::max<long>(whole, 2)));
        kills += run_ricci(c.folder, killed, after).status == 128 + SIGKILL ? 1 : 0;
    }
    EXPECT_GE(kills, 1);
    ASSERT_EQ(run_ricci(c.folder, killed).status, 0);
    expect_same(c.folder / "plain.h5", c.folder / "killed.h5");
    EXPECT_FALSE(fs::exists(c.folder / "killed.h5.parts"));
}

TEST(IndexCommand, AnInterruptHandsOverWhatIsFinished) {
    const Collection c;
    for (int k = 5; k < 90; ++k) make_bent(c.folder, c.eights[0], k, "set/more" + std::to_string(k) + ".off");
    const std::string index = c.folder / "index.h5";
    const Words words{"index", "build", c.folder / "set", "--threads", "1", "-o", index, "--json"};
    const ProgramResult stopped = run_ricci(c.folder, words, 700, SIGINT);
    ASSERT_EQ(stopped.status, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("--resume"), std::string::npos);
    EXPECT_FALSE(fs::exists(index));
    Words resumed = words;
    resumed.emplace_back("--resume");
    Words changed = resumed;
    changed.insert(changed.end(), {"--tolerance", "1e-9"});
    EXPECT_EQ(run_ricci(c.folder, changed).status, 2) << "another configuration must not continue this run";
    const ProgramResult finished = run_ricci(c.folder, resumed);
    ASSERT_EQ(finished.status, 0) << finished.err;
    EXPECT_GE(reused(finished), 1U) << "under a second, so no block was full: handed over at the signal";
    EXPECT_LT(reused(finished), 93U);
    ASSERT_EQ(c.run({"build", c.folder / "set", "-o", c.folder / "plain.h5"}).status, 0);
    expect_same(index, c.folder / "plain.h5");
}

TEST(IndexCommand, StatsCountShapesByType) {
    const Collection c;
    const std::string index = c.folder / "index.h5";
    ASSERT_EQ(c.run({"build", c.folder / "set", "-o", index}).status, 0);
    const auto lines = objects(c.run({"stats", index, "--json"}).out);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[0]["type"], "g1b0");
    EXPECT_EQ(lines[0]["shapes"], 3);
    EXPECT_EQ(lines[1]["type"], "g2b0");
    EXPECT_EQ(lines[1]["shapes"], 5);
    for (const char* command : {"build", "add", "remove", "query", "stats", "distances"}) {
        const ProgramResult help = c.run({command, "--help"});
        EXPECT_EQ(help.status, 0) << command;
        EXPECT_NE(help.out.find("Example:"), std::string::npos) << command;
    }
    EXPECT_EQ(c.run({}).status, 2);
}

}  // namespace
}  // namespace ricci
