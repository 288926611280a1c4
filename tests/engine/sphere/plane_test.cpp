// The pieces of the route: the punctured plane, its layout, the balance.
#include <numbers>

#include "engine/sphere/barycentre.h"
#include "engine/sphere/plane_layout.h"
#include "engine/sphere/punctured_plane.h"
#include "tests/engine/sphere/sphere_checks.h"

namespace ricci {
namespace {

using Complex = std::complex<long double>;
using testing::at;
using testing::Random;
constexpr long double kPi = std::numbers::pi_v<long double>;

TEST(PuncturedPlane, IsAConvexPolygonOfFlatDelaunayTriangles) {
    for (const bool closed : {true, false}) {
        const FlowSurface surface =
            make_flow_surface(testing::jittered(closed ? "ellipsoid" : "disk", 400), true, true);
        Index infinity = 0;
        while (!closed && !surface.boundary[at(infinity)]) ++infinity;
        PuncturedPlane plane(surface, infinity, false);
        SolveOptions options;
        options.tolerance = 1e-13;
        ASSERT_EQ(plane.flatten(options, 1e-10).status, Status::converged);
        const IntrinsicTriangulation<long double>& disk = plane.triangulation();
        const Connectivity& c = disk.connectivity;
        EXPECT_STREQ(check_connectivity(c), "");
        EXPECT_EQ(count_non_delaunay(disk, {}), 0);
        // Laid out anywhere, every edge has its length: the metric is flat, and its angles say convex.
        const std::vector<Complex> z = lay_out_plane(disk, 0);
        std::vector<long double> angle(at(c.vertex_count), 0.0L);
        Index rim = 0;
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            const Complex i = z[at(c.tail[at(h)])], j = z[at(c.head(h))],
                          k = z[at(c.tail[at(prev_halfedge(h))])];
            // Positions are sums of up to 400 edges whose directions err by curvatures below 1e-13.
            EXPECT_LT(std::abs(std::abs(j - i) / std::exp(disk.log_chord[at(h)]) - 1.0L), 1e-10L);
            angle[at(c.tail[at(h)])] += std::arg((k - i) / (j - i));
            rim += c.twin[at(h)] == kNoTwin ? 1 : 0;
        }
        EXPECT_EQ(rim, plane.rim_size());
        const std::vector<std::uint8_t> on_rim = boundary_vertices(c);
        for (Index v = 0; v < c.vertex_count; ++v) {
            if (v == infinity) {
                EXPECT_EQ(angle[at(v)], 0.0L) << "no faces at infinity";
            } else if (on_rim[at(v)]) {
                EXPECT_LE(angle[at(v)], kPi + 2.0L * PuncturedPlane::kReflexAngle);
            } else {
                EXPECT_LT(std::abs(angle[at(v)] - 2.0L * kPi), 1e-9L);
            }
        }
    }
}

TEST(PuncturedPlane, NeedsAnEmbeddedStar) {
    EXPECT_TRUE(embedded_star(testing::octahedron().connectivity, 3));
    EXPECT_FALSE(embedded_star(testing::folded_square<long double>(1.0L).connectivity, 0));
    EXPECT_FALSE(embedded_star(testing::folded_square<long double>(1.0L).connectivity, 1));
}

/// A grid of the plane, seen as lengths, each row `ratio` times as large as the one before it in log-polar
/// coordinates: a spiral of cells from radius 1 outwards.
std::vector<Complex> log_polar_points(Index n, long double ratio) {
    std::vector<Complex> z;
    for (Index i = 0; i <= n; ++i)
        for (Index j = 0; j <= n; ++j)
            z.push_back(std::polar(std::pow(ratio, static_cast<long double>(i)), 0.5L * j / n));
    return z;
}

TEST(PlaneLayout, IsExactRelativeToTheDistanceFromTheSeed) {
    // Twenty rows, each six times as large: e^36 from the first to the last.
    const Index n = 20;
    const std::vector<Complex> z = log_polar_points(n, 6.0L);
    const Connectivity grid = testing::wavy_square(n).connectivity;
    IntrinsicTriangulation<long double> disk{grid, std::vector<long double>(grid.tail.size())};
    for (Index h = 0; h < grid.halfedge_count(); ++h)
        disk.log_chord[at(h)] = std::log(std::abs(z[at(grid.head(h))] - z[at(grid.tail[at(h)])]));
    Index seed = 0;
    while (grid.tail[at(seed)] != 0) ++seed;
    const std::vector<Complex> laid = lay_out_plane(disk, seed);
    const Complex unit = (z[at(grid.head(seed))] - z[0]) / std::abs(z[at(grid.head(seed))] - z[0]);
    for (std::size_t v = 1; v < z.size(); ++v) {
        // Angles at these needles lose three digits of 1e-19, over some forty faces.
        const Complex wanted = z[v] - z[0];
        EXPECT_LT(std::abs(laid[v] * unit - wanted), 1e-14L * std::abs(wanted)) << v;
    }
}

TEST(Barycentre, BalancesAndIsUnique) {
    Random random(3);
    std::vector<Complex> z;
    std::vector<long double> mass;
    for (int i = 0; i < 50; ++i) {
        z.emplace_back(random.uniform(-1, 3), random.uniform(2, 5));
        mass.push_back(random.uniform(0.1, 1.0));
    }
    const PlaneSimilarity map = balance(z, mass, 2.0L, {});
    EXPECT_LT(map.imbalance, 1e-17L);
    Complex sum = 0.0L;
    long double height = 2.0L;
    for (std::size_t i = 0; i < z.size(); ++i) {
        const Complex w = (z[i] - map.centre) / map.scale;
        sum += mass[i] * 2.0L * w / (1.0L + std::norm(w));
        height += mass[i] * (std::norm(w) - 1.0L) / (1.0L + std::norm(w));
    }
    EXPECT_LT(std::abs(sum), 1e-16L);  // 50 masses at 1e-19
    EXPECT_LT(std::abs(height), 1e-16L);
    // From far away, and of a similar configuration.
    const PlaneSimilarity far = balance(z, mass, 2.0L, {Complex(1000.0L, 7.0L), 1e-3L, 1.0L});
    EXPECT_LT(std::abs(far.centre - map.centre), 1e-16L);
    EXPECT_LT(std::abs(far.scale - map.scale), 1e-16L);
    const Complex turn(0.3L, -2.0L), shift(5.0L, 1.0L);
    for (Complex& p : z) p = turn * p + shift;
    const PlaneSimilarity moved = balance(z, mass, 2.0L, {});
    EXPECT_LT(std::abs(moved.centre - (turn * map.centre + shift)), 1e-15L);
    EXPECT_LT(std::abs(moved.scale - std::abs(turn) * map.scale), 1e-15L);
}

TEST(Barycentre, HasNoneWithHalfOfTheMassInOnePoint) {
    const std::vector<Complex> z{0.0L, 1.0L, Complex(0.0L, 1.0L)};
    EXPECT_GT(balance(z, std::vector<long double>{3.0L, 1.0L, 1.0L}, 0.5L, {}).imbalance, 0.01L);
    EXPECT_GT(balance(z, std::vector<long double>{1.0L, 1.0L, 1.0L}, 4.0L, {}).imbalance, 0.01L);
    EXPECT_LT(balance(z, std::vector<long double>{1.0L, 1.0L, 1.0L}, 1.0L, {}).imbalance, 1e-17L);
}

}  // namespace
}  // namespace ricci
