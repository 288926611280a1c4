// `ricci spectrum`: what it prints, writes and refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"
#include "tests/support/program.h"
#include "tests/support/stored_results.h"

namespace ricci {
namespace {

using ricci::testing::group_of;
using ricci::testing::make;
using ricci::testing::objects;
using ricci::testing::ProgramResult;
using ricci::testing::read_text;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;
using ricci::testing::values_of;

nlohmann::json spectrum_of(const TemporaryFolder& folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "spectrum");
    arguments.emplace_back("--json");
    const ProgramResult run = run_ricci(folder, arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    const std::vector<nlohmann::json> all = objects(run.out);
    return all.size() == 1 ? all[0] : nlohmann::json();
}

/// A generated intrinsic surface.
std::string make_len(const TemporaryFolder& folder, const std::string& name) {
    const std::string file = folder / (name + ".len");
    return run_ricci(folder, {"generate", name, "--faces", "1", "-o", file, "-q"}).status == 0 ? file : "";
}

TEST(SpectrumCommand, JsonHasWhatTheInterfaceSays) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "genus-g-one-boundary", 600);
    const nlohmann::json o = spectrum_of(folder, {mesh, "--max-length", "6.5"});
    EXPECT_EQ(o["file"], mesh);
    EXPECT_EQ(o["genus"], 2);
    EXPECT_EQ(o["boundaries"], 1);
    EXPECT_EQ(o["geometry"], "hyperbolic");
    EXPECT_EQ(o["complete_up_to"], 6.5);
    EXPECT_LE(o["relator_error"].get<double>(), 1e-10);
    EXPECT_LE(o["word_error"].get<double>(), 1e-8);
    const std::size_t n = o["lengths"].size();
    EXPECT_GT(n, 10U);
    std::size_t boundaries = 0, powers = 0;
    for (const char* list : {"primitive", "powers", "words", "boundary", "geodesics"})
        ASSERT_EQ(o[list].size(), n);
    for (std::size_t k = 0; k < n; ++k) {
        if (k > 0) {
            EXPECT_GE(o["lengths"][k], o["lengths"][k - 1]);
        }
        EXPECT_EQ(o["primitive"][k].get<bool>(), o["powers"][k] == 1);
        const std::string word = o["words"][k];
        EXPECT_FALSE(word.empty());
        const std::string power = "^" + std::to_string(o["powers"][k].get<int>());
        EXPECT_EQ(word[0] == '(' && word.find(power) != std::string::npos, o["powers"][k] != 1) << word;
        powers += o["powers"][k] != 1 ? 1 : 0;
        if (o["boundary"][k] < 0) continue;
        EXPECT_EQ(o["boundary"][k], 0);
        EXPECT_TRUE(o["words"][k] == "c1" || o["words"][k] == "c1^-1") << word;
        ++boundaries;
    }
    EXPECT_EQ(boundaries, 1U);
    EXPECT_GT(powers, 0U);
    const nlohmann::json plain = spectrum_of(folder, {mesh, "--max-length", "6.5", "--no-words"});
    ASSERT_EQ(plain["lengths"].size(), n);
    for (std::size_t k = 0; k < n; ++k) {
        EXPECT_NEAR(plain["lengths"][k].get<double>(), o["lengths"][k].get<double>(), 1e-9);
        EXPECT_EQ(plain["words"][k], "");
    }
}

TEST(SpectrumCommand, CountsFinishTheMultiplet) {
    const TemporaryFolder folder;
    const std::string klein = make_len(folder, "klein-quartic"), bolza = make_len(folder, "bolza");
    ASSERT_FALSE(klein.empty() || bolza.empty());
    const nlohmann::json one = spectrum_of(folder, {klein, "--count", "1"}),
                         more = spectrum_of(folder, {klein, "--count", "22", "--no-words"}),
                         third = spectrum_of(folder, {bolza, "--count", "25"});
    EXPECT_EQ(one["lengths"].size(), 21U);
    EXPECT_EQ(more["lengths"].size(), 49U);
    EXPECT_EQ(third["lengths"].size(), 48U);
    EXPECT_NEAR(one["lengths"][20].get<double>(), 3.935946, 1e-6);
    EXPECT_NEAR(more["lengths"][48].get<double>(), 5.208017, 1e-6);
    for (const nlohmann::json& o : {one, more, third})
        EXPECT_GE(o["complete_up_to"].get<double>(), o["lengths"].back().get<double>());
    for (const nlohmann::json& g : one["words"]) EXPECT_NE(g, "");
}

TEST(SpectrumCommand, ATorusAndAnAnnulusHaveTheirUnits) {
    const TemporaryFolder folder;
    const nlohmann::json torus = spectrum_of(folder, {make(folder, "torus", 4000), "--max-length", "2.6"});
    ASSERT_EQ(torus["lengths"].size(), 5U);
    EXPECT_EQ(torus["geometry"], "euclidean");
    EXPECT_EQ(torus["lengths"][0], 1.0);
    EXPECT_NEAR(torus["lengths"][2].get<double>(), std::sqrt(5.25), 0.01);
    const nlohmann::json annulus = spectrum_of(folder, {make(folder, "annulus", 400), "--count", "3"});
    EXPECT_EQ(annulus["lengths"], (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(annulus["unit"], "in units of the core");
}

/// Points of each `l` element of an OBJ file.
std::vector<std::vector<Point>> curves_of(const std::string& file) {
    std::istringstream lines(read_text(file));
    std::vector<Point> points;
    std::vector<std::vector<Point>> curves;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            Point p{};
            words >> p[0] >> p[1] >> p[2];
            points.push_back(p);
        } else if (kind == "l") {
            curves.emplace_back();
            for (std::size_t i = 0; words >> i;) curves.back().push_back(points.at(i - 1));
        }
    }
    return curves;
}

TEST(SpectrumCommand, CurvesPicturesAndResultsAreWritten) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 800), stored = folder / "s.h5", curves = folder / "s.obj",
                      picture = folder / "s.svg";
    const nlohmann::json o = spectrum_of(
        folder, {mesh, "--max-length", "4.5", "-o", stored, "--curves", curves, "--svg", picture});
    std::vector<std::size_t> geodesics = o["geodesics"];
    const std::size_t primitive = *std::max_element(geodesics.begin(), geodesics.end()) + 1;
    const std::vector<std::vector<Point>> drawn = curves_of(curves);
    ASSERT_EQ(drawn.size(), primitive);
    for (const std::vector<Point>& curve : drawn) {
        EXPECT_GT(curve.size(), 5U);
        EXPECT_EQ(curve.front(), curve.back());
    }
    const std::string svg = read_text(picture);
    EXPECT_NE(svg.find("<svg"), std::string::npos);
    EXPECT_NE(svg.find("g0"), std::string::npos);
    EXPECT_EQ(run_ricci(folder, {"verify", stored}).status, 0);
    const StoredRun run = read_run(stored);
    const ResultGroup& g = group_of(run, "spectrum");
    EXPECT_EQ(values_of<double>(g, "length"), o["lengths"].get<std::vector<double>>());
    EXPECT_EQ(values_of<std::int32_t>(g, "power"), o["powers"].get<std::vector<std::int32_t>>());
    EXPECT_EQ(values_of<std::int32_t>(g, "geodesic").size(), geodesics.size());
    const std::vector<std::int32_t>& first = values_of<std::int32_t>(g, "geodesics/points_first");
    const std::vector<double>& points = values_of<double>(g, "geodesics/points");
    ASSERT_EQ(first.size(), primitive + 1);
    EXPECT_EQ(3 * static_cast<std::size_t>(first.back()), points.size());
    for (std::size_t k = 0; k < primitive; ++k) {
        ASSERT_EQ(static_cast<std::size_t>(first[k + 1] - first[k]), drawn[k].size());
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(points[3 * static_cast<std::size_t>(first[k]) + i], drawn[k][0][i]);
    }
    // Some of them only.
    const std::string few = folder / "few.vtk";
    ASSERT_EQ(run_ricci(folder, {"spectrum", mesh, "--curves", few, "--draw", "2"}).status, 0);
    EXPECT_NE(read_text(few).find("LINES 2 "), std::string::npos);
}

TEST(SpectrumCommand, SameBitsForAnyNumberOfThreads) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "pants", 2000);
    std::vector<nlohmann::json> all;
    for (const char* threads : {"1", "2", "3", "8"}) {
        all.push_back(spectrum_of(folder, {mesh, "--max-length", "7", "--threads", threads}));
        all.back().erase("seconds");
        EXPECT_EQ(all.back(), all[0]);
    }
    EXPECT_GE(all[0]["lengths"].size(), 3U);
}

TEST(SpectrumCommand, ManyFilesAreGoneThroughWhateverFails) {
    const TemporaryFolder folder;
    const std::string eight = make(folder, "eight", 800), sphere = make(folder, "sphere", 100),
                      stored = folder / "all.h5";
    const ProgramResult run =
        run_ricci(folder, {"spectrum", sphere, folder / "none.off", eight, eight, "--max-length", "2",
                           "--json", "-o", stored, "--curves", folder / "c.obj"});
    EXPECT_EQ(run.status, 1) << "some failed";
    const std::vector<nlohmann::json> o = objects(run.out);
    ASSERT_EQ(o.size(), 4U);
    EXPECT_EQ(o[0]["status"], "invalid_input");
    EXPECT_NE(o[0]["message"].get<std::string>().find("no length spectrum"), std::string::npos);
    EXPECT_EQ(o[1]["status"], "invalid_input");
    EXPECT_EQ(o[2]["status"], "converged");
    EXPECT_EQ(o[2]["lengths"], o[3]["lengths"]);
    EXPECT_NE(o[2]["item"], o[3]["item"]) << "two results of one name";
    EXPECT_EQ(curves_of(folder / ("c." + o[2]["item"].get<std::string>() + ".obj")).size(), 2U);
    EXPECT_EQ(run_ricci(folder, {"verify", stored}).status, 0);
    EXPECT_EQ(read_run(stored).failures.size(), 1U) << "the file that is not there is no item";
}

TEST(SpectrumCommand, MistakesAreNamed) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 400), sphere = make(folder, "sphere", 100);
    const auto expect = [&](const std::vector<std::string>& arguments, int status, const std::string& said) {
        const ProgramResult run = run_ricci(folder, arguments);
        EXPECT_EQ(run.status, status) << said;
        EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
        EXPECT_EQ(run.out, "");
    };
    expect({"spectrum", mesh, "--max-length", "0"}, 2, "--max-length");
    expect({"spectrum", mesh, "--max-length", "-1"}, 2, "--max-length");
    expect({"spectrum", mesh, "--count", "0"}, 2, "--count");
    expect({"spectrum", mesh, "--draw", "-1"}, 2, "--draw");
    expect({"spectrum", mesh, "--delaunay", "sometimes"}, 2, "sometimes");
    expect({"spectrum"}, 2, "MESH");
    expect({"spectrum", folder / "none.off"}, 3, "none.off");
    // Before anything is read.
    expect({"spectrum", folder / "none.off", "--curves", folder / "x.stl"}, 3, ".obj, .vtk or .vtp");
    expect({"spectrum", sphere}, 2, "no length spectrum");
    expect({"spectrum", sphere}, 2, "ricci teichmuller");
    const ProgramResult poor = run_ricci(folder, {"spectrum", mesh, "--max-iterations", "1", "--json"});
    EXPECT_EQ(poor.status, 1);
    EXPECT_EQ(objects(poor.out).at(0)["status"], "max_iterations");
}

}  // namespace
}  // namespace ricci
