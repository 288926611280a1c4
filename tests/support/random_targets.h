// Random admissible target curvatures and an independent look at what a flow made of them: for stress tests,
// long (bench/stress_protocol.cpp) and short (tests/engine/precision_test.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string_view>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/verify/recompute.h"
#include "tests/support/random.h"

namespace ricci::testing {

/// How the cone angles theta = 2 pi - K of all vertices are drawn, before they are scaled to Gauss-Bonnet:
///   mild:    uniform in [1/2, 3/2): about pi to 3 pi
///   random:  uniform in (0, 1]: about 0 to 4 pi
///   harsh:   log-uniform over three decades: about 0.01 pi to 14 pi
///   extreme: log-uniform over twelve decades: about 1e-10 pi to 50 pi
enum class TargetDraw : std::uint8_t { mild, random, harsh, extreme };

inline constexpr std::array<std::string_view, 4> kDrawNames = {"mild", "random", "harsh", "extreme"};
inline std::string_view name_of(TargetDraw draw) {
    return kDrawNames[static_cast<std::size_t>(draw)];
}

inline double draw_angle(TargetDraw draw, Random& random) {
    switch (draw) {
        case TargetDraw::mild:
            return random.uniform(0.5, 1.5);
        case TargetDraw::random:
            return 1.0 - random.uniform(0.0, 1.0);  // never 0
        case TargetDraw::harsh:
            return std::pow(10.0, random.uniform(-3.0, 0.0));
        case TargetDraw::extreme:
            break;
    }
    return std::pow(10.0, random.uniform(-12.0, 0.0));
}

/// A target for the Euclidean flow on a closed surface: K < 2 pi at every vertex, sum K = 2 pi chi to
/// rounding. // V
inline std::vector<double> random_target(const SurfaceMesh& mesh, TargetDraw draw, std::uint64_t seed) {
    constexpr double full = 2.0 * std::numbers::pi;
    Random random(seed);
    std::vector<double> curvature(static_cast<std::size_t>(mesh.connectivity.vertex_count));
    for (double& theta : curvature) theta = draw_angle(draw, random);
    const double chi = topology_of(mesh.connectivity).euler_characteristic;
    const double scale = full * (static_cast<double>(curvature.size()) - chi) /
                         std::accumulate(curvature.begin(), curvature.end(), 0.0);
    for (double& theta : curvature) theta = full - scale * theta;
    return curvature;
}

/// A solved flow on a closed surface, seen by engine/verify.
struct FlowCheck {
    double residual_max = 0.0;  // max |K - target|
    double gauss_bonnet_error = 0.0;
    bool triangles = false;             // every final face is one, and the flips ended
    std::int64_t non_delaunay = 0;      // edges
    std::size_t edges_that_differ = 0;  // between the solver's final triangulation and the other one
};

/// Edges as sorted pairs of vertices, sorted.
template <class VertexOfHalfedge>
std::vector<std::array<Index, 2>> edges_of(std::size_t halfedges, VertexOfHalfedge&& vertex) {
    std::vector<std::array<Index, 2>> edges;
    for (std::size_t h = 0; h < halfedges; ++h) {
        const Index i = vertex(h), j = vertex(h % 3 == 2 ? h - 2 : h + 1);
        edges.push_back({std::min(i, j), std::max(i, j)});
    }
    std::sort(edges.begin(), edges.end());
    return edges;
}

inline FlowCheck check_flow(const SurfaceMesh& mesh, const FlowResult& flow, std::span<const double> target) {
    const Recomputed again =
        recompute_scaling(mesh, {flow.conformal_factor, flow.conformal_factor_low}, flow.geometry,
                          Boundary::geodesic, true, flow.precision_digits > 16 ? 50 : 19);
    FlowCheck check;
    for (std::size_t v = 0; v < target.size(); ++v)
        check.residual_max = std::max(check.residual_max, std::abs(again.curvature[v] - target[v]));
    check.gauss_bonnet_error = again.gauss_bonnet_error;
    check.triangles = again.valid;
    check.non_delaunay = again.non_delaunay;
    const auto ours =
        edges_of(flow.triangulation.tail.size(), [&](std::size_t h) { return flow.triangulation.tail[h]; });
    const auto theirs =
        edges_of(3 * again.triangles.size(), [&](std::size_t h) { return again.triangles[h / 3][h % 3]; });
    std::vector<std::array<Index, 2>> only_one;
    std::set_symmetric_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                                  std::back_inserter(only_one));
    check.edges_that_differ = only_one.size();
    return check;
}

}  // namespace ricci::testing
