// Theorem 4 of the thesis: which curvatures a circle packing on a fixed triangulation can have. The bound is
// computed here from its definition, for every subset of a small mesh, and compared with what the flow does
// and says.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "engine/flow/target.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::at;
using testing::Random;

/// -sum over Lk(I) of (pi - phi(e)) + 2 pi chi(F_I), straight from the theorem; I as a bit mask, closed
/// surface.
double bound_of(const Connectivity& c, const std::vector<double>& eta, unsigned set) {
    const auto in = [&](Index v) { return (set >> v & 1U) != 0; };
    int vertices = std::popcount(set), edges = 0, faces = 0;
    double link = 0.0;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const bool ends = in(c.tail[at(h)]) && in(c.head(h));
        const Index apex = c.tail[at(prev_halfedge(h))];
        if (ends && c.twin[at(h)] > h) ++edges;
        if (ends && in(apex) && h % 3 == 0) ++faces;
        // The edge of h with the vertex opposite: in the link when the edge has no end in I.
        if (!in(c.tail[at(h)]) && !in(c.head(h)) && in(apex))
            link += pi - std::acos(std::min(eta[at(h)], 1.0));
    }
    return -link + 2 * pi * (vertices - edges + faces);
}

double sum_over(const std::vector<double>& curvature, unsigned set) {
    double sum = 0.0;
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if ((set >> v & 1U) != 0) sum += curvature[v];
    return sum;
}

/// min over proper subsets of (sum K - bound): positive exactly for admissible curvatures.
struct Margin {
    double value = 1e9;
    unsigned set = 0;
};
Margin margin_of(const Connectivity& c, const std::vector<double>& eta,
                 const std::vector<double>& curvature) {
    Margin margin;
    const unsigned all = (1U << c.vertex_count) - 1;
    for (unsigned set = 1; set < all; ++set) {
        const double value = sum_over(curvature, set) - bound_of(c, eta, set);
        if (value < margin.value) margin = {value, set};
    }
    return margin;
}

SurfaceMesh tiny_torus() {
    return testing::bumpy_torus(3, 3);
}

FlowOptions tangential(const std::vector<double>& curvature) {
    FlowOptions options;
    options.geometry = Geometry::euclidean;
    options.scheme = Scheme::tangential;
    options.target = TargetKind::values;
    options.target_values = curvature;
    options.boundary = Boundary::curvature;
    return options;
}

/// Random curvatures below 2 pi with the right sum, in which a random set gets about what the theorem lets it
/// have.
std::vector<double> random_curvature(const SurfaceMesh& mesh, const std::vector<double>& eta,
                                     Random& random) {
    const Connectivity& c = mesh.connectivity;
    const auto n = at(c.vertex_count);
    const double total = 2 * pi * topology_of(c).euler_characteristic;
    for (;;) {
        const unsigned set = 1 + random.below((1U << n) - 2);
        const double inside = bound_of(c, eta, set) + random.uniform(-0.6, 0.6);
        const auto size = static_cast<double>(std::popcount(set));
        std::vector<double> k = random.uniforms(n, -0.5, 0.5);
        const double noise_inside = sum_over(k, set), noise = sum_over(k, (1U << n) - 1);
        for (std::size_t v = 0; v < n; ++v)
            k[v] += (set >> v & 1U) != 0
                        ? (inside - noise_inside) / size
                        : (total - inside - noise + noise_inside) / (static_cast<double>(n) - size);
        if (*std::max_element(k.begin(), k.end()) < 2 * pi - 0.05) return k;
    }
}

unsigned mask_of(const std::vector<Index>& vertices) {
    unsigned set = 0;
    for (const Index v : vertices) set |= 1U << v;
    return set;
}

/// The flow converges exactly where brute force says admissible, and a violation it names is one, with the
/// right bound.
void expect_flow_obeys_the_theorem(const SurfaceMesh& mesh, Random& random, int trials) {
    int admissible = 0, inadmissible = 0, by_sets = 0;
    const std::vector<double> eta(mesh.edge_length.size(), 1.0);
    for (int trial = 0; trial < trials; ++trial) {
        const auto k = random_curvature(mesh, eta, random);
        const Margin margin = margin_of(mesh.connectivity, eta, k);
        if (std::abs(margin.value) < 0.02) continue;  // radii of e^-(1/margin): too close to call
        FlowOptions options = tangential(k);
        // Radii in the ratio e^-14 here: lengths that are sums of them lose six digits, the angles with them.
        options.tolerance = 1e-8;
        const FlowResult result = solve_flow(mesh, options);
        if (margin.value > 0) {
            ++admissible;
            EXPECT_EQ(result.outcome.status, Status::converged) << "margin " << margin.value;
            continue;
        }
        ++inadmissible;
        EXPECT_EQ(result.outcome.status, Status::inadmissible_target)
            << "margin " << margin.value << ", " << result.message;
        CurvatureTarget target;
        target.curvature = k;
        for (Index v = 0; v < mesh.connectivity.vertex_count; ++v) target.unknown.push_back(v);
        target.unknown_count = mesh.connectivity.vertex_count;
        const auto violation = find_violation(mesh.connectivity, eta, target, result.conformal_factor);
        ASSERT_TRUE(violation.has_value());
        const unsigned set = mask_of(violation->vertices);
        by_sets += violation->vertices.size() > 1 ? 1 : 0;
        EXPECT_TRUE(std::is_sorted(violation->vertices.begin(), violation->vertices.end()));
        EXPECT_NEAR(violation->bound, bound_of(mesh.connectivity, eta, set), 1e-12);
        EXPECT_NEAR(violation->curvature_sum, sum_over(k, set), 1e-12);
        EXPECT_LE(violation->curvature_sum, violation->bound + 1e-9);
        EXPECT_EQ(result.message, describe(*violation));
    }
    EXPECT_GT(admissible, trials / 10);
    EXPECT_GT(inadmissible, trials / 10);
    EXPECT_GT(by_sets, 0);
}

TEST(Admissibility, FlowOnTheOctahedronObeysTheorem4) {
    Random random(1);
    expect_flow_obeys_the_theorem(testing::octahedron(), random, 150);
}

TEST(Admissibility, FlowOnATinyTorusObeysTheorem4) {
    Random random(2);
    expect_flow_obeys_the_theorem(tiny_torus(), random, 150);
}

TEST(Admissibility, ASingleVertexIsFoundBeforeTheFlow) {
    // Valence 4, tangential: K > 2 pi - 4 pi.
    std::vector<double> k(6, (4 * pi + 2.1 * pi) / 5);
    k[2] = -2.1 * pi;
    const FlowResult result = solve_flow(testing::octahedron(), tangential(k));
    EXPECT_EQ(result.outcome.status, Status::inadmissible_target);
    EXPECT_EQ(result.outcome.iterations, 0);
    EXPECT_NE(result.message.find("{2}"), std::string::npos) << result.message;
    EXPECT_NE(result.message.find("-6.28318531"), std::string::npos) << result.message;
}

TEST(Admissibility, ALargerSetIsFoundByTheFlow) {
    // I = {0, 2, 4}, a face: the bound is 2 pi (3 - 3 + 1) - 6 ... counted by brute force; each vertex alone
    // is fine.
    const SurfaceMesh mesh = testing::octahedron();
    const std::vector<double> eta(24, 1.0);
    const unsigned set = 1U << 0 | 1U << 2 | 1U << 4;
    const double bound = bound_of(mesh.connectivity, eta, set);
    EXPECT_NEAR(bound, 2 * pi - 3 * pi, 1e-12);  // three link edges around the opposite face
    std::vector<double> k(6, (4 * pi - (bound - 0.3)) / 3);
    for (const std::size_t v : {0U, 2U, 4U}) k[v] = (bound - 0.3) / 3;
    EXPECT_GT(k[0], -2 * pi + 1.0);
    EXPECT_LT(k[1], 2 * pi);
    const FlowResult result = solve_flow(mesh, tangential(k));
    EXPECT_EQ(result.outcome.status, Status::inadmissible_target);
    EXPECT_GT(result.outcome.iterations, 0);
    EXPECT_NE(result.message.find("{0, 2, 4}"), std::string::npos) << result.message;
    EXPECT_NE(result.message.find("-3.14159265"), std::string::npos) << result.message;
    // A little above the bound: admissible.
    k.assign(6, (4 * pi - (bound + 0.3)) / 3);
    for (const std::size_t v : {0U, 2U, 4U}) k[v] = (bound + 0.3) / 3;
    EXPECT_EQ(solve_flow(mesh, tangential(k)).outcome.status, Status::converged);
}

TEST(Admissibility, BoundsOfRandomSetsWithRandomAnglesAreExact) {
    Random random(3);
    for (const SurfaceMesh& mesh : {testing::icosahedron(), tiny_torus()}) {
        const Connectivity& c = mesh.connectivity;
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<double> eta(mesh.edge_length.size());
            for (Index h = 0; h < c.halfedge_count(); ++h)
                eta[at(h)] = c.twin[at(h)] > h ? random.uniform(0, 1.2) : eta[at(c.twin[at(h)])];
            // Levels that single out a random set, whose curvature is far too low while every vertex alone is
            // admissible.
            const auto set = static_cast<unsigned>(random.below(std::uint64_t{1} << c.vertex_count));
            if (std::popcount(set) < 2 || std::popcount(set) >= c.vertex_count) continue;
            CurvatureTarget target;
            std::vector<double> u;
            const double bound = bound_of(c, eta, set);
            for (Index v = 0; v < c.vertex_count; ++v) {
                const bool in = (set >> v & 1U) != 0;
                target.unknown.push_back(target.unknown_count++);
                target.curvature.push_back(in ? std::max(bound_of(c, eta, 1U << v) + 1e-3, -3.0) : 100.0);
                u.push_back(in ? -1.0 - 0.01 * random.uniform(0, 1) : 1.0);
            }
            const double sum = sum_over(target.curvature, set);
            const auto violation = find_violation(c, eta, target, u);
            if (sum < bound - 1e-6) {
                ASSERT_TRUE(violation.has_value());
            }
            if (!violation) continue;
            const unsigned found = mask_of(violation->vertices);
            EXPECT_NEAR(violation->bound, bound_of(c, eta, found), 1e-11);
            EXPECT_NEAR(violation->curvature_sum, sum_over(target.curvature, found), 1e-11);
        }
    }
}

TEST(Admissibility, WithAFreeBoundaryAllUnknownsTogetherAreAProperSubset) {
    // The nine interior vertices of a 4 x 4 square cannot all be as negative as each of them could alone.
    const SurfaceMesh mesh = testing::wavy_square(4);
    const std::vector<double> eta(mesh.edge_length.size(), 1.0);
    const FlowSurface surface = make_flow_surface(mesh, false, false);
    FlowOptions options;
    const CurvatureTarget flat = make_target(surface, options, Geometry::euclidean, Boundary::free);
    unsigned interior = 0;
    for (unsigned v = 0; v < 25; ++v)
        if (!surface.boundary[v]) interior |= 1U << v;
    const double bound = bound_of(mesh.connectivity, eta, interior);
    CurvatureTarget target = flat;
    std::vector<double> u(25, 0.0);
    for (std::size_t v = 0; v < 25; ++v)
        if (!surface.boundary[v]) {
            target.curvature[v] = (bound - 0.05) / 9;
            u[v] = -1.0;
        }
    const auto violation = find_violation(mesh.connectivity, eta, target, u);
    ASSERT_TRUE(violation.has_value());
    EXPECT_EQ(mask_of(violation->vertices), interior);
    EXPECT_NEAR(violation->bound, bound, 1e-12);
}

}  // namespace
}  // namespace ricci
