// `ricci layout` and the exports of what it stores.
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

TEST(LayoutCommand, HyperbolicSurfaceHasGeneratorsInSl2R) {
    const TemporaryFolder folder;
    const ProgramResult run = run_ricci(folder, {"layout", make(folder, "eight", 2000), "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const nlohmann::json o = objects(run.out).at(0);
    EXPECT_EQ(o["status"], "converged");
    EXPECT_EQ(o["geometry"], "hyperbolic");
    ASSERT_EQ(o["generators"].size(), 4U);
    EXPECT_LE(o["relator_error"].get<double>(), 1e-10);
    EXPECT_LE(o["closing_error"].get<double>(), 1e-10);
    EXPECT_EQ(o["flipped_pieces"], 0);
    for (const auto& g : o["generators"]) {
        const auto& m = g["matrix"];
        const double a = m[0][0], b = m[0][1], c = m[1][0], d = m[1][1];
        // Entries of a generator are a few hundred at most: 1e-9 is their rounding squared and some.
        EXPECT_NEAR(a * d - b * c, 1.0, 1e-9);
        EXPECT_GT(std::abs(a + d), 2.0) << "not hyperbolic";
    }
}

TEST(LayoutCommand, EveryTopologyHasItsGeometry) {
    const TemporaryFolder folder;
    const std::vector<std::pair<std::string, std::string>> expected = {
        {"sphere", "spherical"},  {"disk", "spherical"},   {"torus", "euclidean"},
        {"annulus", "euclidean"}, {"pants", "hyperbolic"}, {"genus-g-one-boundary", "hyperbolic"}};
    for (const auto& [name, geometry] : expected) {
        const ProgramResult run = run_ricci(folder, {"layout", make(folder, name, 1500), "--json"});
        ASSERT_EQ(run.status, 0) << name << run.err;
        const nlohmann::json o = objects(run.out).at(0);
        EXPECT_EQ(o["geometry"], geometry) << name;
        EXPECT_EQ(o["flipped_pieces"], 0) << name;
        EXPECT_LE(o["relator_error"].get<double>(), 1e-8) << name;
        EXPECT_LE(o["closing_error"].get<double>(), 1e-8) << name;
    }
}

TEST(LayoutCommand, ResultFileHoldsEverythingAndTheSameBitsForAnyThreads) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 2000);
    const std::string one = folder / "one.h5", two = folder / "two.h5";
    for (const auto& [file, threads] : {std::pair(one, "1"), std::pair(two, "2")})
        ASSERT_EQ(run_ricci(folder, {"layout", mesh, "-o", file, "--threads", threads, "--quality", "--atlas",
                                     "hyperbolic", "--copies", "50"})
                      .status,
                  0);
    EXPECT_EQ(run_ricci(folder, {"verify", one}).status, 0);
    const StoredRun a = read_run(one), b = read_run(two);
    for (const char* kind : {"layout", "quality", "atlas"}) {
        const ResultGroup &x = group_of(a, kind), &y = group_of(b, kind);
        ASSERT_EQ(x.arrays.size(), y.arrays.size());
        for (std::size_t k = 0; k < x.arrays.size(); ++k) {
            if (std::holds_alternative<std::vector<double>>(x.arrays[k].values)) {
                const auto &p = std::get<std::vector<double>>(x.arrays[k].values),
                           &q = std::get<std::vector<double>>(y.arrays[k].values);
                ASSERT_EQ(p.size(), q.size());
                for (std::size_t i = 0; i < p.size(); ++i)
                    ASSERT_TRUE(p[i] == q[i] || (std::isnan(p[i]) && std::isnan(q[i])))
                        << kind << "/" << x.arrays[k].path << " " << i;
            } else {
                EXPECT_EQ(x.arrays[k], y.arrays[k]);
            }
        }
    }
}

TEST(LayoutCommand, TexturedMeshIsTheRefinedInput) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "torus", 2000), textured = folder / "torus.obj",
                      stored = folder / "torus.h5", exported = folder / "exported.obj";
    ASSERT_EQ(run_ricci(folder, {"layout", mesh, "--uv", textured, "-o", stored}).status, 0);
    ASSERT_EQ(run_ricci(folder, {"export", stored, "-o", exported, "--checker", "0"}).status, 0);
    EXPECT_EQ(read_text(textured), read_text(exported));
    const LoadedMesh input = load_mesh(mesh), output = load_mesh(textured);
    ASSERT_EQ(output.components.size(), 1U);
    const SurfaceMesh &x = input.components[0], &y = output.components[0];
    EXPECT_EQ(topology_of(y.connectivity).genus, 1);
    // The input's vertices first, where they were.
    for (std::size_t v = 0; v < x.points.size(); ++v) EXPECT_EQ(x.points[v], y.points[v]);
    double area = 0, refined = 0;
    for (const double f : face_areas(x)) area += f;
    for (const double f : face_areas(y)) refined += f;
    EXPECT_NEAR(refined, area, 1e-12 * area);
    EXPECT_NE(read_text(textured).find("\nvt "), std::string::npos);
}

TEST(LayoutCommand, MistakesAreNamed) {
    const TemporaryFolder folder;
    const std::string mesh = make(folder, "eight", 1000);
    EXPECT_EQ(run_ricci(folder, {"layout", mesh, "--model", "mercator"}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"layout", mesh, "--base", "1000000"}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"layout", mesh, "--atlas", "spherical"}).status, 2);
    EXPECT_EQ(run_ricci(folder, {"layout", folder / "none.off"}).status, 3);
    const ProgramResult cone = run_ricci(folder, {"layout", mesh, "--cone=0:-2pi", "--json"});
    EXPECT_EQ(cone.status, 1);
    EXPECT_EQ(objects(cone.out).at(0)["status"], "inadmissible_target");
}

}  // namespace
}  // namespace ricci
