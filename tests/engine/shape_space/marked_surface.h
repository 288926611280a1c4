// What the tests of markings and coordinates share: bent sample surfaces, solved and marked.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/shape_space/length_spectrum.h"
#include "engine/shape_space/teichmuller.h"
#include "engine/surfaces/ring_row.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci::testing {

/// Smooth waves in all coordinates. They vary on the scale of the surface, so they change its conformal
/// class.
inline void bend(SurfaceMesh& mesh, double amplitude, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> w = random.uniforms(36, -1.0, 1.0);
    for (Point& p : mesh.points) {
        Point moved = p;
        for (std::size_t k = 0; k < 9; ++k) {
            const double wave = std::sin(1.5 * (w[4 * k] * p[0] + w[4 * k + 1] * p[1] + w[4 * k + 2] * p[2]) +
                                         3 * w[4 * k + 3]);
            moved[k % 3] += amplitude * wave;
        }
        p = moved;
    }
    mesh = make_surface_mesh(std::move(mesh.points), triangles_of(mesh.connectivity));
}

/// A row of rings or half of one, bent: no symmetry is left.
inline SurfaceMesh bent_row(Index rings, RowPart part, Index faces = 700, double amplitude = 0.15,
                            std::uint64_t seed = 5) {
    SurfaceMesh mesh = make_ring_row(faces, rings, part);
    bend(mesh, amplitude, seed);
    return mesh;
}

/// A topological type of negative Euler characteristic and a row that has it.
struct RowType {
    Index genus, boundaries, rings;
    RowPart part;
};
inline const std::vector<RowType>& row_types() {
    static const std::vector<RowType> types{
        {2, 0, 2, RowPart::whole}, {3, 0, 3, RowPart::whole}, {4, 0, 4, RowPart::whole},
        {0, 3, 2, RowPart::upper}, {0, 4, 3, RowPart::upper}, {0, 5, 4, RowPart::upper},
        {0, 6, 5, RowPart::upper}, {1, 1, 2, RowPart::right}, {1, 2, 3, RowPart::right},
        {2, 1, 4, RowPart::right}, {2, 2, 5, RowPart::right}, {3, 1, 6, RowPart::right}};
    return types;
}
inline std::string text_of(const RowType& t) {
    return "genus " + std::to_string(t.genus) + ", boundaries " + std::to_string(t.boundaries);
}

/// A surface with its marking and coordinates.
struct MarkedSurface {
    std::unique_ptr<CoarseSurface> coarse;
    std::unique_ptr<ExactSurface> exact;
    Marking marking;
    TeichmullerCoordinates coordinates;

    [[nodiscard]] ClosedGeodesic geodesic(const BasedCurve& curve) const {
        return follow_curve(*exact, moved_to_axis(*exact, curve)).geodesic;
    }
    [[nodiscard]] double length(const std::string& name) const {
        for (const LengthCoordinate& c : coordinates.lengths)
            if (c.name == name) return c.length;
        throw std::out_of_range("no coordinate " + name);
    }
    [[nodiscard]] bool has(const std::string& name) const {
        return std::any_of(coordinates.lengths.begin(), coordinates.lengths.end(),
                           [&](const LengthCoordinate& c) { return c.name == name; });
    }
    [[nodiscard]] const BasedCurve& curve(const std::string& name) const {
        for (const LengthCoordinate& c : coordinates.lengths)
            if (c.name == name) return c.curve;
        throw std::out_of_range("no coordinate " + name);
    }
    [[nodiscard]] const FenchelNielsen& pants_curve(const std::string& name) const {
        for (const FenchelNielsen& f : coordinates.pants)
            if (f.name == name) return f;
        throw std::out_of_range("no pants curve " + name);
    }
    [[nodiscard]] std::vector<double> lengths() const {
        std::vector<double> values;
        for (const LengthCoordinate& c : coordinates.lengths) values.push_back(c.length);
        return values;
    }
    /// 2 cosh of half the length.
    [[nodiscard]] double trace(const std::string& name) const { return 2 * std::cosh(length(name) / 2); }
};

inline MarkedSurface marked(CoarseSurface coarse) {
    MarkedSurface m;
    m.coarse = std::make_unique<CoarseSurface>(std::move(coarse));
    m.exact = std::make_unique<ExactSurface>(*m.coarse);
    m.marking = make_marking(*m.exact);
    m.coordinates = teichmuller_coordinates(*m.exact, m.marking);
    return m;
}
inline CoarseSurface coarse_of(const SurfaceMesh& mesh, bool delaunay = true) {
    FlowOptions options;
    options.delaunay = delaunay;
    const FlowResult flow = solve_sharply(mesh, options);
    if (flow.outcome.status != Status::converged)
        throw std::runtime_error("the flow did not converge: " + flow.message);
    return coarse_surface_of(mesh, flow, delaunay);
}
inline MarkedSurface marked(const SurfaceMesh& mesh, bool delaunay = true) {
    return marked(coarse_of(mesh, delaunay));
}

/// The curve around a handle.
inline BasedCurve around(const MarkedHandle& h) {
    return {h.vertex, product(h.a, h.b, inverse(h.a), inverse(h.b))};
}

/// Largest difference of two coordinate vectors, relative to the first.
inline double difference(const std::vector<double>& x, const std::vector<double>& y) {
    if (x.size() != y.size()) return 1e300;
    double largest = 0;
    for (std::size_t k = 0; k < x.size(); ++k)
        largest = std::max(largest, std::abs(x[k] - y[k]) / std::max(1e-300, std::abs(x[k])));
    return largest;
}

}  // namespace ricci::testing
