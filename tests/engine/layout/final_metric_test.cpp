#include "engine/layout/final_metric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/layout/final_metric.inl"
#include "engine/surfaces/regular_map.h"
#include "kernels/extended.h"
#include "tests/engine/refinement/refinement_surfaces.h"

namespace ricci {
namespace {

using testing::at;

/// The refinement of a surface in its hyperbolic metric.
CommonRefinement solved(const SurfaceMesh& mesh, double& residual) {
    FlowOptions options;
    options.geometry = Geometry::hyperbolic;
    const FlowResult flow = solve_flow(mesh, options);
    EXPECT_EQ(flow.outcome.status, Status::converged);
    residual = 0.0;
    for (const double k : flow.curvature) residual = std::max(residual, std::abs(k));
    return make_common_refinement(mesh, flow.conformal_factor, flow.doubled, true);
}

/// Largest distance to +-1 of the product of the moves once around a vertex, relative to how far the vertex
/// is from the origin of the frame it is measured in.
template <class Real>
Real worst_turn(const FinalMetric<Real>& metric, const Connectivity& c) {
    Real worst(0);
    std::vector<std::uint8_t> done(at(c.vertex_count), 0);
    for (Index start = 0; start < c.halfedge_count(); ++start) {
        if (done[at(c.tail[at(start)])]++) continue;
        // In the frame of the halfedge that starts at the vertex, its tail is the origin.
        Isometry<Real> around = inverse(metric.to_halfedge(start));
        for (Index h = start;;) {
            around = compose(metric.kappa, around, metric.crossing(c, prev_halfedge(h)));
            h = c.twin[at(prev_halfedge(h))];
            if (h == start) break;
        }
        around = compose(metric.kappa, around, metric.to_halfedge(start));
        worst = std::max<Real>(worst, distance_to_identity(around));
    }
    return worst;
}

std::vector<SurfaceMesh> hyperbolic_surfaces() {
    return {make_bolza(), testing::scrambled(make_klein_quartic(), 200, 2),
            testing::generated("eight", 1000, 0.3)};
}

TEST(FinalMetric, LaysTrianglesNextToEachOther) {
    const Connectivity c = testing::icosahedron().connectivity;
    testing::Random random(1);
    std::vector<double> of_edge = random.uniforms(at(c.edge_count), 0.4, 0.6);
    for (const int kappa : {-1, 0, 1}) {
        std::vector<double> half;
        for (const Index e : c.edge) half.push_back(of_edge[at(e)]);
        const FinalMetric<double> metric = make_final_metric<double>(kappa, half);
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            const Index t = c.twin[at(h)];
            const auto corners = metric.corners(face_of(h)), there = metric.corners(face_of(t));
            const Isometry<double> move = metric.crossing(c, h);
            const auto from_head = apply(kappa, move, there[at(t % 3)]),
                       from_tail = apply(kappa, move, there[at(next_halfedge(t) % 3)]);
            const auto &tail = corners[at(h % 3)], &head = corners[at(next_halfedge(h) % 3)];
            double chord = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                // Coordinates of order 1 after some ten operations.
                EXPECT_NEAR(from_tail[k], tail[k], 1e-14);
                EXPECT_NEAR(from_head[k], head[k], 1e-14);
                chord += (k == 2 ? (kappa < 0 ? -1 : 1) : 1) * (head[k] - tail[k]) * (head[k] - tail[k]);
            }
            EXPECT_NEAR(std::sqrt(chord), 2 * half[at(h)], 1e-14);
            // The neighbour lies on the other side.
            const auto far = apply(kappa, move, there[at(prev_halfedge(t) % 3)]);
            const auto& apex = corners[at(prev_halfedge(h) % 3)];
            const auto side = [&](const std::array<double, 3>& p) {
                return tail[0] * (head[1] * p[2] - head[2] * p[1]) +
                       tail[1] * (head[2] * p[0] - head[0] * p[2]) +
                       tail[2] * (head[0] * p[1] - head[1] * p[0]);
            };
            EXPECT_GT(side(apex), 1e-3);
            EXPECT_LT(side(far), -1e-3);
        }
    }
}

TEST(FinalMetric, ClosesAroundVerticesAsWellAsTheyAreFlat) {
    for (const SurfaceMesh& mesh : hyperbolic_surfaces()) {
        double residual = 0;
        const CommonRefinement r = solved(mesh, residual);
        const double error = worst_turn(make_final_metric(-1, r), r.final_triangulation.connectivity);
        // Half the curvature of a vertex, and its valence times a few roundings.
        EXPECT_LT(error, 0.51 * residual + 1e-13);
        EXPECT_GT(error, 0.0);
    }
}

TEST(FinalMetric, DoesNotCloseAroundACone) {
    double residual = 0;
    CommonRefinement r = solved(make_bolza(), residual);
    r.u[2] += 0.01;
    EXPECT_GT(worst_turn(make_final_metric(-1, r), r.final_triangulation.connectivity), 1e-3);
}

template <class Real>
void expect_polished(const CommonRefinement& r, double bound) {
    const PolishedMetric<Real> polished = polish_hyperbolic<Real>(r);
    // Its own goal is 4096 epsilon.
    EXPECT_LE(polished.residual, 4096 * static_cast<double>(std::numeric_limits<Real>::epsilon()));
    EXPECT_LE(polished.residual, bound);
    const Real turn = worst_turn(polished.metric, r.final_triangulation.connectivity);
    EXPECT_LE(static_cast<double>(turn), bound);
    EXPECT_LE(polished.steps, 12);
    for (std::size_t v = 0; v < r.u.size(); ++v) {
        if (polished.scale[v] == Real(0)) continue;
        // It moves no farther than the flow's residual, 1e-10, lets it.
        EXPECT_NEAR(static_cast<double>(polished.scale[v]), std::exp(r.u[v] / 2),
                    1e-8 * std::exp(r.u[v] / 2));
    }
}

TEST(FinalMetric, IsSolvedAnewToAsManyDigitsAsWanted) {
    for (const SurfaceMesh& mesh : hyperbolic_surfaces()) {
        double residual = 0;
        const CommonRefinement r = solved(mesh, residual);
        expect_polished<long double>(r, 4.5e-16);
        expect_polished<Extended<50>>(r, 1e-45);
    }
}

TEST(FinalMetric, GoesOnFromTheScalesItIsGiven) {
    double residual = 0;
    const CommonRefinement r = solved(testing::generated("eight", 400, 0.3), residual);
    const PolishedMetric<long double> coarse = polish_hyperbolic<long double>(r);
    std::vector<Extended<50>> scale(coarse.scale.begin(), coarse.scale.end());
    const PolishedMetric<Extended<50>> from_coarse = polish_hyperbolic<Extended<50>>(r, std::move(scale)),
                                       from_start = polish_hyperbolic<Extended<50>>(r);
    EXPECT_LE(from_coarse.steps, from_start.steps);
    for (std::size_t v = 0; v < r.u.size(); ++v) {
        const Extended<50> ratio = from_coarse.scale[v] / from_start.scale[v] - 1;
        // Residuals below 4e-47 times the condition of the Hessian, below 1e4.
        EXPECT_LT(abs(ratio), Extended<50>("1e-42"));
    }
}

}  // namespace
}  // namespace ricci
