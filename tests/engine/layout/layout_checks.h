// What the tests of groups and layouts share: elements of words, distances, and pieces seen in the layout.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/structure/surface_structure.h"
#include "io/mesh/mesh_file.h"
#include "tests/engine/refinement/refinement_surfaces.h"
#include "tests/support/test_data.h"

namespace ricci::testing {

inline SurfaceMesh load_component(const std::string& path) {
    LoadedMesh loaded = load_mesh(path);
    if (loaded.components.size() != 1) throw std::runtime_error(path + " is not one component");
    return std::move(loaded.components[0]);
}

/// The structure of a surface whose flow must converge.
inline SurfaceStructure structure_of(const SurfaceMesh& mesh, const StructureOptions& options = {}) {
    SurfaceStructure s = make_surface_structure(mesh, options);
    if (s.flow.outcome.status != Status::converged)
        throw std::runtime_error("the flow did not converge: " + s.flow.message);
    return s;
}

/// The trace of an element of SU(1,1), which is known up to sign.
inline double trace_size(const Isometry<double>& x) {
    return std::abs(2 * x.a.re);
}

/// The product of the letters of a word.
inline Isometry<double> element_of(const SurfaceGroup& group, std::span<const Index> word) {
    Isometry<double> x;
    for (const Index letter : word) {
        const Isometry<double>& g = group.letters[at(generator_of(letter))];
        x = compose(group.kappa, x, letter > 0 ? g : inverse(g));
    }
    return x;
}

/// Geodesic distance, also of points that almost coincide: chords lose nothing.
inline double distance(int kappa, const std::array<double, 3>& p, const std::array<double, 3>& q) {
    const double dx = p[0] - q[0], dy = p[1] - q[1], dt = p[2] - q[2];
    const double chord = std::sqrt(std::max(0.0, dx * dx + dy * dy + (kappa < 0 ? -1 : 1) * dt * dt));
    return kappa == 0 ? chord : 2 * (kappa < 0 ? std::asinh(chord / 2) : std::asin(std::min(1.0, chord / 2)));
}

/// The motion that takes the origin to p and the x axis to the ray from p to q.
inline Isometry<double> frame_at(int kappa, const std::array<double, 3>& p, const std::array<double, 3>& q) {
    // z = x / (1 + t) for all three.
    Isometry<double> m{{1, 0}, {p[0] / (1 + p[2]), p[1] / (1 + p[2])}};
    normalise(kappa, m);
    const std::array<double, 3> ahead = apply(kappa, inverse(m), q);
    const double angle = std::atan2(ahead[1], ahead[0]);
    return compose(kappa, m, {{std::cos(angle / 2), std::sin(angle / 2)}, {}});
}

inline const std::array<double, 3>& position_of(const SurfaceLayout& layout, Index corner) {
    return layout.position[at(layout.corner_vertex[at(corner)])];
}

/// Angle of a piece's image at one of its corners, in (-pi, pi]: negative where it is turned over.
inline double image_angle(const CommonRefinement& r, const SurfaceLayout& layout, Index corner) {
    const Isometry<double> back =
        inverse(frame_at(layout.kappa, position_of(layout, corner), position_of(layout, r.next(corner))));
    const auto p = apply(layout.kappa, back, position_of(layout, r.previous(corner)));
    return std::atan2(p[1], p[0]);
}

/// A polygon's signed area by a fan from its first corner: in the plane, or on the sphere (tan(E/2) of each
/// triangle by Oosterom and Strackee).
inline double image_area(const CommonRefinement& r, const SurfaceLayout& layout, Index piece) {
    const Index begin = r.first[at(piece)], end = r.first[at(piece) + 1];
    const auto dot = [](const auto& p, const auto& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; };
    const std::array<double, 3>& o = position_of(layout, begin);
    double sum = 0;
    for (Index k = begin + 1; k + 1 < end; ++k) {
        const std::array<double, 3>&p = position_of(layout, k), &q = position_of(layout, k + 1);
        // From differences, so that small triangles keep their digits.
        const std::array<double, 3> u{p[0] - o[0], p[1] - o[1], p[2] - o[2]},
            v{q[0] - o[0], q[1] - o[1], q[2] - o[2]};
        const std::array<double, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                      u[0] * v[1] - u[1] * v[0]};
        sum +=
            layout.kappa == 0 ? n[2] / 2 : 2 * std::atan2(dot(o, n), 1 + dot(o, p) + dot(p, q) + dot(q, o));
    }
    return sum;
}

/// Angles around every vertex of the refinement add up to a full turn, on the boundary to half of one: for
/// crossings this says that edges are straight. Vertices in `except` are left out.
inline void expect_flat_angles(const CommonRefinement& r, const SurfaceLayout& layout, double tolerance,
                               const std::vector<Index>& except = {}) {
    std::vector<double> sum(at(r.vertex_count), 0.0);
    std::vector<std::uint8_t> boundary(sum.size(), 0);
    for (Index c = 0; c < r.corner_count(); ++c) {
        sum[at(r.vertex[at(c)])] += image_angle(r, layout, c);
        if (r.twin[at(c)] >= 0) continue;
        boundary[at(r.vertex[at(c)])] = boundary[at(r.vertex[at(r.next(c))])] = 1;
    }
    double worst = 0;
    for (std::size_t v = 0; v < sum.size(); ++v) {
        if (sum[v] == 0.0 || std::count(except.begin(), except.end(), static_cast<Index>(v)) > 0) continue;
        const double error = std::abs(sum[v] - (boundary[v] ? 1 : 2) * std::numbers::pi);
        worst = error > worst || std::isnan(error) ? error : worst;
    }
    EXPECT_LE(worst, tolerance);
}

/// Points moved by x -> centre + (x - centre) / |x - centre|^2, lengths measured anew.
inline SurfaceMesh inverted(const SurfaceMesh& mesh, const Point& centre) {
    std::vector<Point> points;
    for (const Point& p : mesh.points) {
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) square += (p[k] - centre[k]) * (p[k] - centre[k]);
        Point q{};
        for (std::size_t k = 0; k < 3; ++k) q[k] = centre[k] + (p[k] - centre[k]) / square;
        points.push_back(q);
    }
    return make_surface_mesh(std::move(points), triangles_of(mesh.connectivity));
}

}  // namespace ricci::testing
