#include "engine/app/sweep_config.h"

#include <gtest/gtest.h>

#include <numbers>

#include "engine/app/console.h"
#include "engine/app/solve_options.h"
#include "tests/support/program.h"

namespace ricci::app {
namespace {

using ricci::testing::TemporaryFolder;
using ricci::testing::write_text;

std::string complaint(const std::string& text) {
    const TemporaryFolder folder;
    write_text(folder / "c.toml", text);
    try {
        read_sweep_config(folder / "c.toml");
    } catch (const UsageError& e) {
        return e.what();
    }
    return {};
}

TEST(SweepConfig, ReadsEveryKey) {
    const TemporaryFolder folder;
    write_text(folder / "c.toml", R"(
[input]
meshes = ["a.off", "b"]
repair = "orient"
[solve]
scheme = "thurston"
boundary = "free"
cone_curvature = "-4pi"
delaunay = "none"
tolerance = 1e-8
max_iterations = 7
densify = true
solver = "newton"
[sweep]
vertices = "sample:5:3"
resolutions = [5000, "input"]
keep = 3
[run]
output = "x.h5"
shard = "1/4"
threads = 2
lanes = 3
max_memory = "1G"
timeout = 2.5
)");
    const SweepConfig c = read_sweep_config(folder / "c.toml");
    EXPECT_EQ(c.meshes, (std::vector<std::string>{"a.off", "b"}));
    const SweepOptions options = sweep_options(c);
    EXPECT_EQ(options.scheme, Scheme::thurston);
    EXPECT_EQ(options.boundary, Boundary::free);
    EXPECT_DOUBLE_EQ(options.cone_curvature.value(), -4.0 * std::numbers::pi);
    EXPECT_FALSE(options.delaunay);
    EXPECT_TRUE(options.densify);
    EXPECT_EQ(options.tolerance, 1e-8);
    EXPECT_EQ(options.max_iterations, 7);
    EXPECT_EQ(options.solver, SweepSolverKind::newton);
    EXPECT_EQ(options.lanes, 3);
    EXPECT_EQ(parse_resolutions(c.resolutions), (std::vector<Index>{5000, 0}));
    EXPECT_EQ(parse_keep(c.keep).count, 3);
    EXPECT_EQ(parse_shard(c.shard).index, 1U);
    EXPECT_EQ(parse_bytes(c.max_memory), std::int64_t{1} << 30);
    EXPECT_EQ(c.timeout, 2.5);
    EXPECT_EQ(c.threads, 2);
}

TEST(SweepConfig, ResolvedTextReadsBack) {
    SweepConfig c;
    c.meshes = {"a \"quoted\".off"};
    c.keep = "all";
    const TemporaryFolder folder;
    write_text(folder / "c.toml", to_toml(c, false));
    const SweepConfig again = read_sweep_config(folder / "c.toml");
    EXPECT_EQ(to_toml(again, false), to_toml(c, false));
    SweepConfig other = c;
    other.threads = 7;
    other.lanes = 5;
    other.output = "elsewhere.h5";
    EXPECT_EQ(to_toml(other, true), to_toml(c, true)) << "threads, lanes and output decide no result";
    EXPECT_NE(to_toml(other, false), to_toml(c, false));
    other.solver = "newton";
    EXPECT_NE(to_toml(other, true), to_toml(c, true));
    other = c;
    other.tolerance = 1e-9;
    EXPECT_NE(to_toml(other, true), to_toml(c, true));
}

TEST(SweepConfig, NamesFileLineAndKeyOfAMistake) {
    EXPECT_NE(complaint("[solve]\ntolerence = 1e-10\n").find("c.toml:2: unknown key 'tolerence' in [solve]"),
              std::string::npos);
    EXPECT_NE(complaint("[solving]\n").find("unknown table or key 'solving'"), std::string::npos);
    EXPECT_NE(complaint("[solve]\ntolerance = \"small\"\n").find("'tolerance' must be a number"),
              std::string::npos);
    EXPECT_NE(complaint("[solve]\ndensify = 1\n").find("'densify' must be true or false"), std::string::npos);
    EXPECT_NE(complaint("solve = 3\n").find("must be a table"), std::string::npos);
    EXPECT_NE(complaint("[solve\n").find("c.toml:1"), std::string::npos);
    EXPECT_EQ(complaint("[solve]\ntolerance = 1\n"), "") << "a whole number is a number";
}

TEST(SweepConfig, RefusesUnknownSolversAndLanes) {
    SweepConfig c;
    EXPECT_EQ(sweep_options(c).solver, SweepSolverKind::lanes);
    EXPECT_EQ(sweep_options(c).lanes, kLanes);
    c.lanes = 0;
    EXPECT_THROW(sweep_options(c), UsageError);
    c.lanes = kLanes + 1;
    EXPECT_THROW(sweep_options(c), UsageError);
    c.lanes = 1;
    c.solver = "gauss";
    EXPECT_THROW(sweep_options(c), UsageError);
}

TEST(SweepConfig, RefusesNumbersOutOfRange) {
    const auto refused = [](const std::string& text) {
        const SweepConfig c = sweep_config_from_toml(text, "c.toml");
        EXPECT_THROW(sweep_options(c), UsageError) << text;
    };
    for (const char* tolerance : {"0", "-1", "inf", "nan"})
        refused(std::string("[solve]\ntolerance = ") + tolerance + "\n");
    refused("[solve]\nmax_iterations = -1\n");
    refused("[run]\ntimeout = -0.5\n");
    refused("[run]\ntimeout = nan\n");
    for (const char* threads : {"-1", "5000", "4294967297"})
        EXPECT_THROW(sweep_config_from_toml(std::string("[run]\nthreads = ") + threads + "\n", "c.toml"),
                     UsageError);
    EXPECT_THROW(parse_keep("-1"), UsageError);
    EXPECT_EQ(parse_keep("7").count, 7);
    for (const char* bytes : {"1e300T", "inf", "nan", "-1G", "9e18"})
        EXPECT_THROW(parse_bytes(bytes), UsageError) << bytes;
}

TEST(VertexChoice, ListsThatAreNoneAreRefused) {
    const TemporaryFolder folder;
    EXPECT_THROW(read_vertex_list(folder / "."), FileError);  // a folder, which opens as an empty file
    write_text(folder / "v.txt", std::string(1'000'000, '7') + "\n");
    try {
        read_vertex_list(folder / "v.txt");
        FAIL() << "taken in";
    } catch (const UsageError& error) {
        EXPECT_EQ(std::string(error.what()),
                  (folder / "v.txt") + ":1: '" + std::string(40, '7') + "...' is not a number");
    }
}

TEST(Curvature, ParsesMultiplesOfPi) {
    const double pi = std::numbers::pi;
    EXPECT_DOUBLE_EQ(parse_curvature("-4pi"), -4 * pi);
    EXPECT_DOUBLE_EQ(parse_curvature("pi/2"), pi / 2);
    EXPECT_DOUBLE_EQ(parse_curvature("-pi/3"), -pi / 3);
    EXPECT_DOUBLE_EQ(parse_curvature("0.5*pi"), pi / 2);
    EXPECT_DOUBLE_EQ(parse_curvature("2*pi/3"), 2 * pi / 3);
    EXPECT_DOUBLE_EQ(parse_curvature("+1.5"), 1.5);
    for (const char* wrong : {"", "pi2", "4 pi", "*pi", "pi/", "pi/0", "1e400", "nan", "4pie"})
        EXPECT_THROW(parse_curvature(wrong), UsageError) << wrong;
}

TEST(Cone, NeedsVertexAndCurvature) {
    EXPECT_EQ(parse_cone("17:-2pi").vertex, 17);
    for (const char* wrong : {"17", ":pi", "-1:pi", "x:pi", "1.5:pi", "3:"})
        EXPECT_THROW(parse_cone(wrong), UsageError) << wrong;
}

TEST(VertexChoice, SamplesAndLists) {
    const std::vector<Index> candidates{2, 3, 5, 7, 11, 13};
    EXPECT_EQ(choose_vertices(parse_vertices("all"), candidates), candidates);
    EXPECT_EQ(choose_vertices(parse_vertices("sample:100"), candidates), candidates);
    EXPECT_EQ(choose_vertices(parse_vertices("sample:3:9"), candidates).size(), 3U);
    EXPECT_EQ(choose_vertices(parse_vertices("sample:3:9"), candidates),
              choose_vertices(parse_vertices("sample:3:9"), candidates));
    const TemporaryFolder folder;
    write_text(folder / "v.txt", "7 # comment\n\n3\n7\n");
    EXPECT_EQ(choose_vertices(parse_vertices(folder / "v.txt"), candidates), (std::vector<Index>{3, 7}));
    write_text(folder / "v.txt", "4\n");
    EXPECT_THROW(choose_vertices(parse_vertices(folder / "v.txt"), candidates), std::invalid_argument);
    EXPECT_EQ(choose_vertices(parse_vertices("list:7,3,7"), candidates), (std::vector<Index>{3, 7}));
    EXPECT_THROW(parse_vertices("list:"), UsageError);
    EXPECT_THROW(parse_vertices("list:3,x"), UsageError);
    EXPECT_THROW(parse_vertices("sample:0"), UsageError);
    EXPECT_THROW(parse_vertices("sample:x"), UsageError);
}

}  // namespace
}  // namespace ricci::app
