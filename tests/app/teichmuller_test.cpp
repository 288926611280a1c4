// `ricci teichmuller`: what it prints, draws and stores, and what it says of bad curve files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/store/run_store.h"
#include "tests/support/program.h"
#include "tests/support/stored_results.h"

namespace ricci {
namespace {

using ricci::testing::array_of;
using ricci::testing::make;
using ricci::testing::objects;
using ricci::testing::ProgramResult;
using ricci::testing::read_text;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;
using ricci::testing::write_text;

TEST(Teichmuller, KeepsTheContractInJsonAndFile) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 800);
    const ProgramResult r = run_ricci(folder, {"teichmuller", mesh, "--json", "-o", folder / "t.h5",
                                               "--curves", folder / "c.obj", "--svg", folder / "c.svg"});
    ASSERT_EQ(r.status, 0) << r.err;
    const nlohmann::json t = objects(r.out).at(0);
    for (const char* key : {"file", "genus", "boundaries", "coordinates", "names", "marking"})
        EXPECT_TRUE(t.contains(key)) << key;
    EXPECT_EQ(t["names"], (std::vector<std::string>{"a1", "b1", "a1b1", "a2", "b2", "a2b2", "z(e1)"}));
    EXPECT_EQ(t["marking"]["kind"], "geometric");
    EXPECT_EQ(t["fenchel_nielsen"].size(), 3U);
    EXPECT_NE(r.err.find("near-ties"), std::string::npos) << "eight is symmetric";
    const StoredRun run = read_run(folder / "t.h5");
    ASSERT_EQ(run.items.at(0).results.size(), 1U);
    const ResultGroup& group = run.items[0].results[0];
    EXPECT_EQ(group.kind, "teichmuller");
    EXPECT_EQ(std::get<std::vector<double>>(array_of(group, "coordinates").values),
              t["coordinates"].get<std::vector<double>>());
    EXPECT_EQ(std::get<std::vector<std::string>>(array_of(group, "names").values),
              t["names"].get<std::vector<std::string>>());
    const auto first = std::get<std::vector<std::int32_t>>(array_of(group, "curves/points_first").values);
    ASSERT_EQ(first.size(), 8U);
    EXPECT_EQ(static_cast<std::uint64_t>(first.back()), array_of(group, "curves/points").shape.at(0));
    EXPECT_EQ(array_of(group, "fenchel_nielsen/twist").shape, (std::vector<std::uint64_t>{3}));
    const std::string obj = read_text(folder / "c.obj");
    EXPECT_EQ(std::count(obj.begin(), obj.end(), 'l') > 0, true);
    EXPECT_NE(obj.find("a1b1"), std::string::npos);
    EXPECT_NE(read_text(folder / "c.svg").find("<svg"), std::string::npos);
    EXPECT_EQ(run_ricci(folder, {"verify", folder / "t.h5"}).status, 0);
}

TEST(Teichmuller, PantsHaveAHexagonTorusAndAnnulusAModulus) {
    const TemporaryFolder folder;
    const ProgramResult r =
        run_ricci(folder, {"teichmuller", make(folder, "pants", 500), make(folder, "torus", 800),
                           make(folder, "annulus", 400), "--json"});
    ASSERT_EQ(r.status, 0) << r.err;
    const auto lines = objects(r.out);
    ASSERT_EQ(lines.size(), 3U);
    ASSERT_TRUE(lines[0].contains("hexagon_seams"));
    const auto l = lines[0]["coordinates"].get<std::vector<double>>();
    const auto seams = lines[0]["hexagon_seams"].get<std::vector<double>>();
    for (std::size_t k = 0; k < 3; ++k) {
        const double a = l[k] / 2, b = l[(k + 1) % 3] / 2, c = l[(k + 2) % 3] / 2;
        EXPECT_NEAR(std::cosh(a),
                    std::sinh(b) * std::sinh(c) * std::cosh(seams[k]) - std::cosh(b) * std::cosh(c),
                    1e-9 * std::cosh(a) * std::cosh(b) * std::cosh(c));
    }
    EXPECT_NEAR(lines[1]["modulus_im"].get<double>(), std::sqrt(5.25), 0.05);
    EXPECT_NEAR(lines[2]["modulus"].get<double>(), 1 / (2 * std::acos(-1.0)), 1e-8);
}

TEST(Teichmuller, NamesFileLineCurveAndVertex) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 400);
    const auto complaint = [&](const std::string& text, const char* option) {
        write_text(folder / "curves.txt", text);
        const ProgramResult r = run_ricci(folder, {"teichmuller", mesh, option, folder / "curves.txt"});
        EXPECT_NE(r.status, 0) << text;
        return r.err;
    };
    for (const char* option : {"--marking", "--loops"}) {
        const std::string beyond = complaint("# comment\nlong 0 1 9999999\n", option);
        EXPECT_NE(beyond.find("curves.txt"), std::string::npos) << beyond;
        EXPECT_NE(beyond.find("line 2"), std::string::npos) << beyond;
        EXPECT_NE(beyond.find("9999999"), std::string::npos) << beyond;
        EXPECT_NE(beyond.find("long"), std::string::npos) << beyond;
        EXPECT_NE(complaint("far 0 399\n", option).find("far"), std::string::npos);
        EXPECT_NE(complaint("word 0 x 2\n", option).find("x"), std::string::npos);
        EXPECT_NE(complaint("", option).find("curves.txt"), std::string::npos);
    }
    EXPECT_NE(run_ricci(folder, {"teichmuller", mesh, "--marking", folder / "missing"}).status, 0);
}

}  // namespace
}  // namespace ricci
