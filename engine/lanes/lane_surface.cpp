#include "engine/lanes/lane_surface.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "engine/flow/hessian.h"
#include "engine/flow/metric.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Below, a patch would be most of the surface, and Newton's method on all of it costs a millisecond.
constexpr Index kLeastUnknowns = 256;

template <class T>
std::int64_t bytes_of(const std::vector<T>& v) {
    return static_cast<std::int64_t>(v.size() * sizeof(T));
}

std::unique_ptr<const LaneFactor> make_factor(const FlowSurface& surface, const CurvatureTarget& target,
                                              const Metric& metric, std::span<const Index> ordering,
                                              Index pinned) {
    std::vector<Index> unknown(surface.orbit.size());
    for (std::size_t s = 0; s < unknown.size(); ++s) unknown[s] = target.unknown[at(surface.orbit[s])];
    HessianAssembler assembler;
    assembler.build(surface.triangulation.connectivity, unknown, target.unknown_count);
    std::vector<double> values;
    assembler.assemble(surface.triangulation.connectivity, metric.off(), metric.diagonal(), pinned, values);
    const auto solver = make_symmetric_solver(Definiteness::positive);
    if (ordering.empty()) {
        solver->choose_ordering(assembler.pattern(), Ordering::nested_dissection);
    } else {
        solver->use_ordering(ordering);
        solver->analyze(assembler.pattern());
    }
    if (!solver->factorize(values)) return nullptr;
    return std::make_unique<LaneFactor>(solver->supernodal_factor());
}

void bucket_corners(LaneSurface& s) {
    s.corner_begin.assign(at(s.rows()) + 1, 0);
    for (const Index row : s.triangulation.tail) ++s.corner_begin[at(row) + 1];
    for (std::size_t r = 0; r < at(s.rows()); ++r) s.corner_begin[r + 1] += s.corner_begin[r];
    std::vector<Index> fill(s.corner_begin.begin(), s.corner_begin.end() - 1);
    s.corner.resize(s.triangulation.tail.size());
    for (Index h = 0; h < s.triangulation.halfedge_count(); ++h)
        s.corner[at(fill[at(s.triangulation.tail[at(h)])]++)] = h;
}

}  // namespace

std::vector<Index> LaneSurface::rows_of_vertices(Index vertex_count) const {
    std::vector<Index> row(at(vertex_count), -1);
    for (std::size_t r = 0; r < vertex_of_row.size(); ++r) row[at(vertex_of_row[r])] = static_cast<Index>(r);
    return row;
}

std::int64_t LaneSurface::bytes() const {
    return bytes_of(vertex_of_row) + bytes_of(residual) + bytes_of(triangulation.tail) +
           bytes_of(triangulation.twin) + bytes_of(triangulation.edge) + bytes_of(chord) + bytes_of(angle) +
           bytes_of(corner_begin) + bytes_of(corner) + bytes_of(faces.row) + bytes_of(faces.square) +
           bytes_of(faces.cot) + bytes_of(faces.angle) + bytes_of(faces.corner) + bytes_of(edges.row) +
           bytes_of(edges.square) + bytes_of(edges.face) + bytes_of(edges.halfedge) + factor->bytes();
}

std::unique_ptr<const LaneSurface> make_lane_surface(const FlowSurface& surface,
                                                     const CurvatureTarget& target,
                                                     std::span<const Index> ordering) {
    if (target.unknown_count < kLeastUnknowns) return nullptr;
    ScaledMetric<long double> metric(surface, Geometry::euclidean, false);
    const std::vector<double> zero(target.curvature.size(), 0.0);
    if (!metric.move_to(zero) || metric.flips() > 0 || !metric.evaluate(true)) return nullptr;
    auto s = std::make_unique<LaneSurface>();
    s->side = surface.side;
    s->scale_free = target.scale_free;
    s->unknowns = target.unknown_count;
    const Index pinned = target.scale_free ? 0 : -1;
    s->factor = make_factor(surface, target, metric, ordering, pinned);
    if (!s->factor) return nullptr;

    std::vector<Index> vertex_of_unknown(at(target.unknown_count), -1);
    for (std::size_t v = 0; v < target.unknown.size(); ++v)
        if (target.unknown[v] >= 0) vertex_of_unknown[at(target.unknown[v])] = static_cast<Index>(v);
    const std::span<const Index> order = s->factor->elimination_order();
    for (std::size_t r = 0; r < order.size(); ++r) {
        if (order[r] == pinned) s->pinned_row = static_cast<Index>(r);
        s->vertex_of_row.push_back(vertex_of_unknown[at(order[r])]);
    }
    for (std::size_t v = 0; v < target.unknown.size(); ++v)
        if (target.unknown[v] < 0 && surface.used[v]) s->vertex_of_row.push_back(static_cast<Index>(v));
    const std::vector<Index> row_of_vertex = s->rows_of_vertices(surface.vertex_count());
    s->residual.assign(at(s->rows()), 0.0);
    for (std::size_t r = 0; r < at(s->unknowns); ++r) {
        const auto v = at(s->vertex_of_row[r]);
        s->residual[r] = (target.curvature[v] - metric.curvature()[v]) / s->side;
    }
    s->gauss_bonnet_excess = -2.0 * std::numbers::pi * surface.topology.euler_characteristic;
    for (std::size_t r = 0; r < at(s->rows()); ++r) {
        const auto v = at(s->vertex_of_row[r]);
        s->gauss_bonnet_excess += r < at(s->unknowns) ? target.curvature[v] : metric.curvature()[v];
    }

    std::vector<Index> row_of(surface.orbit.size());
    for (std::size_t v = 0; v < row_of.size(); ++v) row_of[v] = row_of_vertex[at(surface.orbit[v])];
    const IntrinsicTriangulation<long double>& start = surface.triangulation;
    try {
        s->faces = make_lane_faces(start.connectivity, start.log_chord, row_of);
    } catch (const std::invalid_argument&) {
        return nullptr;
    }
    s->edges = make_lane_edges(start.connectivity, start.log_chord, row_of);
    s->triangulation = start.connectivity;
    s->triangulation.vertex_count = s->rows();
    for (Index& tail : s->triangulation.tail) tail = row_of[at(tail)];
    s->chord.resize(start.log_chord.size());
    for (std::size_t h = 0; h < s->chord.size(); ++h)
        s->chord[h] = static_cast<double>(std::exp(start.log_chord[h]));
    s->angle.resize(s->chord.size());
    for (std::size_t c = 0; c < s->angle.size(); ++c) s->angle[at(s->faces.corner[c])] = s->faces.angle[c];
    bucket_corners(*s);
    return s;
}

}  // namespace ricci
