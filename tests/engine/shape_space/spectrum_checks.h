// What the tests of length spectra share: solved surfaces, multiplets, sets of isometries.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/shape_space/length_spectrum.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci::testing {

/// The smooth hyperbolic metric with all vertices that the final triangulation has.
inline HyperbolicTriangulation smooth_triangulation(const SurfaceMesh& mesh,
                                                    const FlowOptions& options = {}) {
    const FlowResult flow = solve_sharply(mesh, options);
    if (flow.outcome.status != Status::converged)
        throw std::runtime_error("the flow did not converge: " + flow.message);
    if (flow.doubled) {
        const CommonRefinement r =
            make_common_refinement(mesh, flow.conformal_factor, true, options.delaunay);
        return half_triangulation(r, make_final_metric(-1, r));
    }
    std::vector<double> half_chord;
    for (const double l : flow.edge_length) half_chord.push_back(std::sinh(l / 2));
    return closed_triangulation(flow.triangulation, std::move(half_chord));
}

inline CoarseSurface thinned(const SurfaceMesh& mesh, double spacing = CoarseOptions{}.spacing,
                             const FlowOptions& options = {}) {
    CoarseOptions coarse;
    coarse.spacing = spacing;
    return make_coarse_surface(smooth_triangulation(mesh, options), coarse);
}

inline LengthSpectrum spectrum_up_to(const CoarseSurface& surface, double max_length) {
    SpectrumOptions options;
    options.max_length = max_length;
    return length_spectrum(surface, options);
}

/// Lengths, powers included, ascending.
inline std::vector<double> lengths_of(const LengthSpectrum& s) {
    std::vector<double> lengths;
    for (const SpectrumLength& l : s.lengths) lengths.push_back(l.length);
    return lengths;
}
inline std::vector<double> lengths_up_to(const SurfaceMesh& mesh, double max_length,
                                         const FlowOptions& options = {}) {
    return lengths_of(spectrum_up_to(thinned(mesh, CoarseOptions{}.spacing, options), max_length));
}

/// Equal one to one, and not empty.
inline void expect_same_lengths(const std::vector<double>& x, const std::vector<double>& y,
                                double tolerance) {
    EXPECT_FALSE(x.empty());
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t k = 0; k < x.size(); ++k) ASSERT_NEAR(x[k], y[k], tolerance) << k;
}

/// Hyperbolic angle between sides of half chords p, q, opposite to that of r: by the half angle formula.
inline double hyperbolic_angle(double p, double q, double r) {
    const double a = 2 * std::asinh(p), b = 2 * std::asinh(q), c = 2 * std::asinh(r), s = (a + b + c) / 2;
    return 2 * std::asin(std::min(
                   1.0, std::sqrt(std::sinh(s - a) * std::sinh(s - b) / (std::sinh(a) * std::sinh(b)))));
}

/// A point of the hyperboloid in the triangle of three others.
inline std::array<double, 3> mixed(const std::array<std::array<double, 3>, 3>& corner, double u, double v) {
    std::array<double, 3> x{};
    for (std::size_t k = 0; k < 3; ++k)
        x[k] = u * corner[0][k] + v * corner[1][k] + (1 - u - v) * corner[2][k];
    const double size = std::sqrt(x[2] * x[2] - x[0] * x[0] - x[1] * x[1]);
    for (double& value : x) value /= size;
    return x;
}

/// Two copies of a surface, one of them mirrored, glued along the boundary: intrinsic and closed.
inline SurfaceMesh glued_double(const SurfaceMesh& mesh) {
    const Connectivity& c = mesh.connectivity;
    const Index n = c.halfedge_count();
    std::vector<Index> copy(at(c.vertex_count), kNoTwin);
    for (Index h = 0; h < n; ++h)
        if (c.twin[at(h)] == kNoTwin) copy[at(c.tail[at(h)])] = c.tail[at(h)];
    Index vertices = c.vertex_count;
    for (Index h = 0; h < n; ++h)
        if (Index& v = copy[at(c.tail[at(h)])]; v == kNoTwin) v = vertices++;
    // Halfedge h of face f, read backwards, is halfedge mirror(h).
    const auto mirror = [n](Index h) { return n + 3 * (h / 3) + (3 - h % 3) % 3; };
    std::vector<Index> tail = c.tail, twin(2 * at(n));
    std::vector<double> length = mesh.edge_length;
    tail.resize(2 * at(n));
    length.resize(2 * at(n));
    for (Index h = 0; h < n; ++h) {
        const Index m = mirror(h), t = c.twin[at(h)];
        tail[at(m)] = copy[at(c.head(h))];
        length[at(m)] = mesh.edge_length[at(h)];
        twin[at(h)] = t == kNoTwin ? m : t;
        twin[at(m)] = t == kNoTwin ? h : mirror(t);
    }
    SurfaceMesh out;
    out.connectivity = connectivity_from_gluing(std::move(tail), std::move(twin), vertices);
    out.edge_length = std::move(length);
    out.input_vertex.resize(at(vertices));
    std::iota(out.input_vertex.begin(), out.input_vertex.end(), 0);
    return out;
}

/// Isometries up to sign, each with a label, found again up to rounding.
class IsometrySet {
  public:
    /// Number of the isometry, or -1.
    [[nodiscard]] Index find(const Isometry<double>& x, Index label = 0) const {
        const double key = key_of(x), slack = 1e-7 * (1 + key);
        for (auto it = by_key_.lower_bound(key - slack); it != by_key_.end() && it->first <= key + slack;
             ++it)
            if (label_[at(it->second)] == label && same(element_[at(it->second)], x, slack))
                return it->second;
        return -1;
    }
    /// Number of the isometry; adds it where it is new.
    Index insert(const Isometry<double>& x, Index label = 0) {
        if (const Index known = find(x, label); known >= 0) return known;
        const auto number = static_cast<Index>(element_.size());
        by_key_.emplace(key_of(x), number);
        element_.push_back(x);
        label_.push_back(label);
        return number;
    }
    [[nodiscard]] const std::vector<Isometry<double>>& elements() const { return element_; }
    [[nodiscard]] const std::vector<Index>& labels() const { return label_; }

  private:
    static double key_of(const Isometry<double>& x) {
        return std::abs(x.a.re) + 1.37 * std::abs(x.a.im) + 1.71 * std::abs(x.b.re) + 2.03 * std::abs(x.b.im);
    }
    static bool same(const Isometry<double>& x, const Isometry<double>& y, double slack) {
        const auto differ = [&](double sign) {
            return std::max({std::abs(x.a.re - sign * y.a.re), std::abs(x.a.im - sign * y.a.im),
                             std::abs(x.b.re - sign * y.b.re), std::abs(x.b.im - sign * y.b.im)});
        };
        return std::min(differ(1), differ(-1)) <= slack;
    }
    std::multimap<double, Index> by_key_;
    std::vector<Isometry<double>> element_;
    std::vector<Index> label_;
};

/// cosh of how far the origin moves.
inline double displacement_cosh(const Isometry<double>& x) {
    return squared(x.a) + squared(x.b);
}

}  // namespace ricci::testing
