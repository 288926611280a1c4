#include "engine/refinement/common_refinement.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/refinement/edge_nodes.h"
#include "engine/refinement/null_sides.h"
#include "engine/refinement/piece_builder.h"

namespace ricci {
namespace {

using Real = long double;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Flips `triangulation` to Delaunay and tells how the start's edges run across the result.
CurvePaths flip_and_trace(IntrinsicTriangulation<Real>& triangulation, std::span<const double> u,
                          FlipRule rule, std::int64_t& flips) {
    NormalCurves curves(triangulation.connectivity);
    DelaunayWorkspace workspace;
    const FlipCount count = make_delaunay<Real>(triangulation, u, rule, workspace);
    if (!count.finished) throw std::logic_error("the flips to a Delaunay triangulation do not end");
    for (const Index h : workspace.flipped) curves.flip(h);
    flips = count.flips;
    return curves.trace();
}

/// Drops the pieces of the mirror image and numbers the vertices anew: the input's, then those in use.
void keep_input_side(CommonRefinement& r, Index input_faces, Index triangulation_vertices) {
    std::vector<Index> new_piece(r.input_face.size(), -1), new_corner(r.vertex.size(), -1);
    std::vector<Index> new_vertex(at(r.vertex_count), -1);
    for (Index v = 0; v < r.input_vertices; ++v) new_vertex[at(v)] = v;
    Index vertices = r.input_vertices, pieces = 0, corners = 0;
    std::vector<Index> first{0};
    for (Index p = 0; p < r.piece_count(); ++p) {
        if (r.input_face[at(p)] >= input_faces) continue;
        r.input_face[at(pieces)] = r.input_face[at(p)];
        r.final_face[at(pieces)] = r.final_face[at(p)];
        for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
            Index& vertex = new_vertex[at(r.vertex[at(c)])];
            if (vertex < 0) {
                if (r.vertex[at(c)] < triangulation_vertices)
                    throw std::logic_error("a mirror image belongs to a piece of the input");
                vertex = vertices++;
            }
            new_corner[at(c)] = corners;
            r.copy_corner(c, corners, pieces);
            r.vertex[at(corners)] = vertex;
            ++corners;
        }
        first.push_back(corners);
        ++pieces;
    }
    r.first = std::move(first);
    r.resize(pieces, corners);
    for (Index& t : r.twin)
        if (t >= 0) t = new_corner[at(t)];
    if (!r.points.empty()) {
        std::vector<Point> points(at(vertices));
        for (std::size_t v = 0; v < new_vertex.size(); ++v)
            if (new_vertex[v] >= 0) points[at(new_vertex[v])] = r.points[v];
        r.points = std::move(points);
    }
    r.vertex_count = vertices;
}

enum class Flips { none, ptolemy, both };

CommonRefinement refine(const SurfaceMesh& mesh, std::span<const double> u, bool doubled, Flips flips) {
    const FlowSurface start = make_flow_surface(mesh, doubled, false);
    CommonRefinement out;
    out.doubled = start.doubled;
    out.input_vertices = mesh.connectivity.vertex_count;
    for (const Index v : start.orbit) out.u.push_back(u[at(v)]);
    IntrinsicTriangulation<Real> middle = start.triangulation;
    Crossings x;
    x.input = &start.triangulation.connectivity;
    if (flips == Flips::both) {
        x.input_paths = flip_and_trace(middle, {}, FlipRule::isometric, out.isometric_flips);
    } else {
        x.input_paths = NormalCurves(middle.connectivity).trace();
    }
    x.middle = &middle.connectivity;
    out.final_triangulation = middle;
    if (flips == Flips::none) {
        x.middle_paths = x.input_paths;
    } else {
        x.middle_paths = flip_and_trace(out.final_triangulation, out.u, FlipRule::ptolemy, out.ptolemy_flips);
    }
    const Connectivity& last = out.final_triangulation.connectivity;
    x.last = &last;
    x.input_points = straight_crossings(middle.connectivity, middle.log_chord, x.input_paths);
    x.middle_points = ideal_crossings(last, out.final_triangulation.log_chord, out.u, x.middle_paths);
    const std::vector<DirectedEdge> directed = directed_edges(middle.connectivity);
    x.input_along.assign(middle.connectivity.tail.size(), -1);
    x.last_along.assign(middle.connectivity.tail.size(), -1);
    const std::vector<Index> lowest = edge_halfedges(middle.connectivity);
    for (Index e = 0; e < x.input->edge_count; ++e) {
        const Index h = x.input_paths.shared[at(e)];
        if (h < 0) continue;
        x.input_along[at(h)] = 2 * e;
        if (middle.connectivity.twin[at(h)] != kNoTwin)
            x.input_along[at(middle.connectivity.twin[at(h)])] = 2 * e + 1;
    }
    for (Index h = 0; h < middle.connectivity.halfedge_count(); ++h) {
        const Index g = x.middle_paths.shared[at(middle.connectivity.edge[at(h)])];
        if (g >= 0)
            x.last_along[at(h)] = h == lowest[at(middle.connectivity.edge[at(h)])] ? g : last.twin[at(g)];
    }
    const EdgeNodes nodes = merge_edge_nodes(x, out.u);
    out.first.assign(1, 0);
    PieceBuilder builder(x, nodes, middle.log_chord, out.u, out);
    builder.run();
    const Index vertices = start.triangulation.connectivity.vertex_count;
    out.vertex_count = vertices + static_cast<Index>(nodes.node.size() + builder.inside().size());
    if (!mesh.intrinsic()) {
        for (const Index v : start.orbit) out.points.push_back(mesh.points[at(v)]);
        const std::vector<Point> of_nodes = node_points(x, nodes, out.points);
        out.points.insert(out.points.end(), of_nodes.begin(), of_nodes.end());
        for (const auto& inside : builder.inside()) {
            const Point a = out.points[at(inside.from)], b = out.points[at(inside.to)];
            const auto t = static_cast<double>(inside.fraction);
            Point p{};
            for (std::size_t k = 0; k < 3; ++k) p[k] = (1 - t) * a[k] + t * b[k];
            out.points.push_back(p);
        }
    }
    keep_input_side(out, mesh.connectivity.face_count(), vertices);
    collapse_null_sides(out);
    return out;
}

}  // namespace

CommonRefinement make_common_refinement(const SurfaceMesh& mesh, std::span<const double> u, bool doubled,
                                        bool delaunay) {
    return refine(mesh, u, doubled, delaunay ? Flips::both : Flips::ptolemy);
}

CommonRefinement trivial_refinement(const SurfaceMesh& mesh, std::span<const double> log_chord) {
    const std::vector<double> zero(at(mesh.connectivity.vertex_count), 0.0);
    CommonRefinement out = refine(mesh, zero, false, Flips::none);
    out.final_triangulation.log_chord.assign(log_chord.begin(), log_chord.end());
    return out;
}

void CommonRefinement::copy_corner(Index from, Index to, Index to_piece) {
    vertex[at(to)] = vertex[at(from)];
    twin[at(to)] = twin[at(from)];
    input_halfedge[at(to)] = input_halfedge[at(from)];
    final_halfedge[at(to)] = final_halfedge[at(from)];
    weight[at(to)] = weight[at(from)];
    flat[at(to)] = flat[at(from)];
    piece[at(to)] = to_piece;
}

void CommonRefinement::resize(Index pieces, Index corners) {
    input_face.resize(at(pieces));
    final_face.resize(at(pieces));
    vertex.resize(at(corners));
    twin.resize(at(corners));
    input_halfedge.resize(at(corners));
    final_halfedge.resize(at(corners));
    weight.resize(at(corners));
    flat.resize(at(corners));
    piece.resize(at(corners));
}

PieceAreas piece_areas(const CommonRefinement& r) {
    constexpr double kRounding = 8 * 0x1p-53;
    struct Polygon {
        double area = 0, length = 0, extent = 0;
    };
    PieceAreas areas;
    for (Index p = 0; p < r.piece_count(); ++p) {
        const auto measure = [&](auto&& coordinates) {
            Polygon polygon;
            const Index a = r.first[at(p)];
            const std::array<double, 2> o = coordinates(a);
            for (Index c = a; c < r.first[at(p) + 1]; ++c) {
                const std::array<double, 2> x = coordinates(c), y = coordinates(r.next(c));
                polygon.area += ((x[0] - o[0]) * (y[1] - o[1]) - (x[1] - o[1]) * (y[0] - o[0])) / 2;
                polygon.length += std::abs(y[0] - x[0]) + std::abs(y[1] - x[1]);
                polygon.extent = std::max({polygon.extent, std::abs(x[0]), std::abs(x[1])});
            }
            return polygon;
        };
        const Polygon flat = measure([&](Index c) { return r.flat[at(c)]; });
        const Polygon share = measure([&](Index c) {
            const std::array<double, 3>& w = r.weight[at(c)];
            const double sum = w[0] + w[1] + w[2];
            return std::array<double, 2>{w[1] / sum, w[2] / sum};
        });
        areas.flat.push_back(flat.area);
        areas.flat_rounding.push_back(kRounding * flat.extent * flat.length);
        areas.final_share.push_back(2 * share.area);
        areas.share_rounding.push_back(2 * kRounding * share.extent * share.length);
    }
    return areas;
}

}  // namespace ricci
