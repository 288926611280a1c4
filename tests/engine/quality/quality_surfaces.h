// Flat tori and solved surfaces for the tests of quality.
#pragma once

#include <array>
#include <cmath>

#include "engine/flow/flow.h"
#include "engine/layout/final_metric.h"
#include "tests/support/small_surfaces.h"

namespace ricci::testing {

/// The linear map (x, y) -> (m[0] x + m[1] y, m[2] x + m[3] y).
using PlaneMap = std::array<double, 4>;

/// Lengths of a torus grid of n x n cells whose vertices are displaced in the plane by up to `noise` of a
/// cell, after a linear map. // 3F
inline std::vector<double> mapped_lengths(Index n, double noise, std::uint64_t seed, const PlaneMap& m) {
    Random random(seed);
    const std::vector<double> shift = random.uniforms(2 * at(n) * at(n), -noise, noise);
    const auto place = [&](Index i, Index j) {
        const std::size_t v = at(i % n) * at(n) + at(j % n);
        const double x = i + shift[2 * v], y = j + shift[2 * v + 1];
        return std::array<double, 2>{m[0] * x + m[1] * y, m[2] * x + m[3] * y};
    };
    std::vector<double> length;
    const auto add_face = [&](const std::array<std::array<double, 2>, 3>& p) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto &a = p[k], &b = p[(k + 1) % 3];
            length.push_back(std::hypot(b[0] - a[0], b[1] - a[1]));
        }
    };
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) {
            add_face({place(i, j), place(i + 1, j), place(i + 1, j + 1)});
            add_face({place(i, j), place(i + 1, j + 1), place(i, j + 1)});
        }
    return length;
}

/// The flat torus with those lengths.
inline SurfaceMesh flat_torus(Index n, double noise, std::uint64_t seed, const PlaneMap& m = {1, 0, 0, 1}) {
    SurfaceMesh mesh;
    mesh.connectivity = build_connectivity(torus_grid(n, n), n * n);
    mesh.edge_length = mapped_lengths(n, noise, seed, m);
    for (Index v = 0; v < n * n; ++v) mesh.input_vertex.push_back(v);
    // A length measured from either side differs by rounding.
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h) {
        const Index t = mesh.connectivity.twin[at(h)];
        if (t < h) mesh.edge_length[at(h)] = mesh.edge_length[at(t)];
    }
    return mesh;
}

/// A converged solve, its refinement and metric.
struct Solved {
    FlowResult flow;
    CommonRefinement refinement;
    FinalMetric<double> metric;
};

inline Solved solved(const SurfaceMesh& mesh, const FlowOptions& options = {}) {
    Solved s;
    s.flow = solve_flow(mesh, options);
    s.refinement = make_common_refinement(mesh, s.flow.conformal_factor, s.flow.doubled, options.delaunay);
    s.metric = make_final_metric(curvature_sign(s.flow.geometry), s.refinement);
    return s;
}

}  // namespace ricci::testing
