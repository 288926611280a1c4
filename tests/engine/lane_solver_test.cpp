// The lanes' residual against the flow's own metric, the bookkeeping of a lane's region, and solves alone and
// in company.
#include "engine/lanes/lane_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "engine/flow/target.h"
#include "engine/surfaces/generate.h"
#include "tests/support/random.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::Random;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A generated surface with what lanes need of it.
struct Prepared {
    FlowSurface surface;
    CurvatureTarget target;
    std::shared_ptr<const LaneSurface> lanes;
    double cone = 0.0;
};

Prepared prepare(const std::string& name, Index faces, Boundary boundary = Boundary::geodesic,
                 Index genus = 2) {
    GenerateOptions options;
    options.genus = genus;
    options.faces = faces;
    options.jitter = 0.3;
    options.seed = 7;
    Prepared p;
    p.surface = make_flow_surface(generate(name, options), boundary != Boundary::free, true);
    FlowOptions flow;
    flow.geometry = Geometry::euclidean;
    flow.boundary = boundary;
    p.target = make_target(p.surface, flow, Geometry::euclidean, boundary);
    p.lanes = make_lane_surface(p.surface, p.target, {});
    p.cone = 2.0 * pi * p.surface.topology.euler_characteristic;
    return p;
}

class LaneResiduals : public ::testing::TestWithParam<std::pair<const char*, Boundary>> {};

// A random metric, so far from the start that hundreds of edges flip: pass and region together must give what
// the flow's metric gives in extended precision after flipping the whole surface.
TEST_P(LaneResiduals, AgreeWithTheMetricOfTheWholeSurface) {
    const auto [name, boundary] = GetParam();
    const Prepared p = prepare(name, 3000, boundary);
    ASSERT_NE(p.lanes, nullptr);
    const LaneSurface& s = *p.lanes;
    Random random(11);
    const auto rows = at(s.rows());
    LaneArray<double> u(rows), shrink(rows), residual(rows);
    std::vector<LaneMask> owned(at(s.faces.face_count()), 0);
    constexpr int kLane = 5;
    std::vector<double> of_vertex(p.target.curvature.size(), 0.0);
    for (std::size_t r = 0; r < rows; ++r) {
        for (double& x : u[r].lane) x = 0.0;
        if (r >= at(s.unknowns)) continue;
        u[r].lane[kLane] = of_vertex[at(s.vertex_of_row[r])] = random.uniform(-0.4, 0.4);
    }
    lane_exponentials(u, shrink);
    OwnedRegion region(s, kLane, owned);
    const Index cone = s.unknowns / 2;
    region.start(cone, p.cone, 3);
    region.load(u, shrink);
    std::vector<LaneFlip> flips;
    find_lane_flips(s.edges, shrink, owned, flips);
    for (const LaneFlip& flip : flips) {
        EXPECT_EQ(flip.lanes, 1U << kLane);
        region.take_edge(flip.edge, shrink);
    }
    ASSERT_TRUE(region.make_delaunay(shrink));
    EXPECT_GT(region.flips(), 50);
    for (std::size_t r = 0; r < rows; ++r)
        for (double& x : residual[r].lane) x = s.residual[r];
    EXPECT_EQ(add_angle_changes(s.faces, shrink, owned, residual), 0);
    ASSERT_TRUE(region.add_residual(residual));

    ScaledMetric<long double> metric(p.surface, Geometry::euclidean, false);
    ASSERT_TRUE(metric.move_to(of_vertex));
    ASSERT_TRUE(metric.evaluate(false));
    for (std::size_t r = 0; r < at(s.unknowns); ++r) {
        const auto v = at(s.vertex_of_row[r]);
        double expected = p.target.curvature[v] - metric.curvature()[v];
        if (static_cast<Index>(r) == cone) expected += p.cone;
        EXPECT_NEAR(s.side * residual[r].lane[kLane], expected, 2e-12);
    }

    region.clear();
    EXPECT_TRUE(std::all_of(owned.begin(), owned.end(), [](LaneMask mask) { return mask == 0; }));
    EXPECT_EQ(region.face_count(), 0);
    // Nothing of the first use shows in the second.
    const auto residuals_of = [&](OwnedRegion& used) {
        used.start(cone + 1, p.cone, 2);
        used.load(u, shrink);
        EXPECT_TRUE(used.make_delaunay(shrink));
        LaneArray<double> sum(rows);
        used.add_residual(sum);
        used.clear();
        std::vector<double> values;
        for (const auto& row : sum) values.push_back(row.lane[kLane]);
        return values;
    };
    OwnedRegion fresh(s, kLane, owned);
    EXPECT_EQ(residuals_of(region), residuals_of(fresh));
}

INSTANTIATE_TEST_SUITE_P(Surfaces, LaneResiduals,
                         ::testing::Values(std::pair{"eight", Boundary::geodesic},
                                           std::pair{"genus-g-one-boundary", Boundary::geodesic},
                                           std::pair{"genus-g-one-boundary", Boundary::free}));

std::map<Index, LaneSolve> solve(const Prepared& p, const std::vector<Index>& vertices, LaneOptions options) {
    options.cone_curvature = p.cone;
    LaneSolver solver(p.lanes, p.surface.vertex_count(), options);
    std::map<Index, LaneSolve> solves;
    std::size_t next = 0;
    LaneStream stream;
    stream.next = [&]() -> std::optional<Index> {
        return next < vertices.size() ? std::optional(vertices[next++]) : std::nullopt;
    };
    stream.finished = [&](LaneSolve s) { solves[s.vertex] = std::move(s); };
    solver.run(stream);
    return solves;
}

TEST(LaneSolver, BitsDependOnTheVertexAlone) {
    const Prepared p = prepare("eight", 4000);
    std::vector<Index> vertices;
    for (Index v = 0; v < p.surface.vertex_count(); v += 61) vertices.push_back(v);
    const auto together = solve(p, vertices, {});
    ASSERT_EQ(together.size(), vertices.size());
    std::vector<Index> some(vertices.rbegin(), vertices.rend());
    some.resize(20);
    for (const int lanes : {1, 3, 16}) {
        LaneOptions options;
        options.lanes = lanes;
        for (const auto& [vertex, alone] : solve(p, some, options)) {
            const LaneSolve& other = together.at(vertex);
            EXPECT_EQ(alone.conformal_factor, other.conformal_factor);
            EXPECT_EQ(alone.residual_max, other.residual_max);
            EXPECT_EQ(alone.steps, other.steps);
            EXPECT_EQ(alone.flips, other.flips);
        }
    }
}

// What a lane leaves behind that gave up must not reach the vertex after it.
TEST(LaneSolver, BitsAreTheSameAfterALaneThatGaveUp) {
    const Prepared p = prepare("genus-g", 2600, Boundary::geodesic, 10);
    ASSERT_NE(p.lanes, nullptr);
    std::vector<Index> vertices;
    for (Index v = 0; v < p.surface.vertex_count(); v += 59) vertices.push_back(v);
    LaneOptions options;
    options.lanes = 1;
    const auto forwards = solve(p, vertices, options);
    std::reverse(vertices.begin(), vertices.end());
    const auto backwards = solve(p, vertices, options);
    int given_up = 0;
    for (const auto& [vertex, solved] : forwards) {
        given_up += solved.converged ? 0 : 1;
        EXPECT_EQ(solved.converged, backwards.at(vertex).converged);
        EXPECT_EQ(solved.steps, backwards.at(vertex).steps);
        if (solved.converged) {
            EXPECT_EQ(solved.conformal_factor, backwards.at(vertex).conformal_factor);
        }
    }
    EXPECT_GT(given_up, 0);
}

// Patch, history and precision only choose the way: wherever it ends within the tolerance is the solution.
TEST(LaneSolver, TheWayDoesNotChangeTheEnd) {
    const Prepared p = prepare("eight", 4000);
    const std::vector<Index> vertices = {3, 500, 1200};
    LaneOptions options;
    options.tolerance = 1e-12;
    const auto reference = solve(p, vertices, options);
    for (const int rings : {4, 7})
        for (const int history : {0, 2, 5}) {
            options.rings = rings;
            options.history = history;
            for (const auto& [vertex, solved] : solve(p, vertices, options)) {
                ASSERT_TRUE(solved.converged);
                EXPECT_LE(solved.residual_max, 1e-12);
                const std::vector<double>& u = reference.at(vertex).conformal_factor;
                for (std::size_t v = 0; v < u.size(); ++v)
                    EXPECT_NEAR(solved.conformal_factor[v], u[v], 1e-10);
            }
        }
}

TEST(LaneSolver, AnInterruptedLaneLeavesTheOthersAlone) {
    const Prepared p = prepare("eight", 2000);
    LaneOptions options;
    options.cone_curvature = p.cone;
    LaneSolver solver(p.lanes, p.surface.vertex_count(), options);
    std::vector<Index> left = {5, 6, 7, 8};
    int asked = 0, interrupted = 0, converged = 0;
    LaneStream stream;
    stream.next = [&]() -> std::optional<Index> {
        if (left.empty()) return std::nullopt;
        const Index v = left.back();
        left.pop_back();
        return v;
    };
    stream.interrupted = [&](double seconds) -> std::optional<Status> {
        EXPECT_GE(seconds, 0.0);
        return ++asked == 2 ? std::optional(Status::timeout) : std::nullopt;
    };
    stream.finished = [&](const LaneSolve& s) {
        interrupted += s.interrupted == Status::timeout ? 1 : 0;
        converged += s.converged ? 1 : 0;
    };
    solver.run(stream);
    EXPECT_EQ(interrupted, 1);
    EXPECT_EQ(converged, 3);
}

}  // namespace
}  // namespace ricci
