#include "engine/remesh/densify.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

using Edge = std::pair<Index, Index>;
Edge edge_of(Index a, Index b) {
    return std::minmax(a, b);
}

/// Triangles with points, refined in place; points lie on the old faces, so the surface stays the same.
struct Refinement {
    std::vector<Point> points;
    std::vector<Triangle> triangles;

    double squared_length(Edge e) const {
        double sum = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = points[at(e.first)][k] - points[at(e.second)][k];
            sum += d * d;
        }
        return sum;
    }

    Index midpoint(Edge e) {
        Point m{};
        for (std::size_t k = 0; k < 3; ++k) m[k] = 0.5 * (points[at(e.first)][k] + points[at(e.second)][k]);
        points.push_back(m);
        return static_cast<Index>(points.size()) - 1;
    }

    Index valence(Index vertex) const {
        return static_cast<Index>(std::count_if(triangles.begin(), triangles.end(), [&](const Triangle& t) {
            return std::find(t.begin(), t.end(), vertex) != t.end();
        }));
    }

    /// Replaces every triangle by what its split edges ask for.
    void split(const std::map<Edge, Index>& middle) {
        std::vector<Triangle> result;
        result.reserve(triangles.size() + 4 * middle.size());
        for (const Triangle& t : triangles) split_one(t, middle, result);
        triangles = std::move(result);
    }

    void split_one(Triangle t, const std::map<Edge, Index>& middle, std::vector<Triangle>& result) const {
        const auto find = [&](Index a, Index b) {
            const auto found = middle.find(edge_of(a, b));
            return found == middle.end() ? Index{-1} : found->second;
        };
        std::array<Index, 3> m{};
        for (std::size_t k = 0; k < 3; ++k) m[k] = find(t[k], t[(k + 1) % 3]);
        const auto count = std::count_if(m.begin(), m.end(), [](Index i) { return i >= 0; });
        // Rotate so that the first edge is split and, of two, the last one is not.
        for (int turn = 0; turn < 3 && count > 0 && count < 3 && !(m[0] >= 0 && m[2] < 0); ++turn) {
            std::rotate(t.begin(), t.begin() + 1, t.end());
            std::rotate(m.begin(), m.begin() + 1, m.end());
        }
        if (count == 0) {
            result.push_back(t);
        } else if (count == 1) {
            result.push_back({t[0], m[0], t[2]});
            result.push_back({m[0], t[1], t[2]});
        } else if (count == 2) {
            result.push_back({m[0], t[1], m[1]});
            // The quadrilateral t0 m0 m1 t2, by its shorter diagonal.
            if (squared_length({t[0], m[1]}) <= squared_length({m[0], t[2]})) {
                result.push_back({t[0], m[0], m[1]});
                result.push_back({t[0], m[1], t[2]});
            } else {
                result.push_back({t[0], m[0], t[2]});
                result.push_back({m[0], m[1], t[2]});
            }
        } else {
            result.push_back({t[0], m[0], m[2]});
            result.push_back({m[0], t[1], m[1]});
            result.push_back({m[2], m[1], t[2]});
            result.push_back({m[0], m[1], m[2]});
        }
    }

    /// Edges opposite `vertex`, longest first (ties: lowest pair).
    std::vector<Edge> link(Index vertex) const {
        std::vector<Edge> edges;
        for (const Triangle& t : triangles)
            for (std::size_t k = 0; k < 3; ++k)
                if (t[k] == vertex) edges.push_back(edge_of(t[(k + 1) % 3], t[(k + 2) % 3]));
        std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) {
            const double la = squared_length(a), lb = squared_length(b);
            return la != lb ? la > lb : a < b;
        });
        return edges;
    }

    /// Edges of the faces that touch a vertex less than `rings` edges away from `vertex`.
    std::map<Edge, Index> edges_near(Index vertex, int rings) const {
        std::vector<std::uint8_t> near(points.size(), 0);
        near[at(vertex)] = 1;
        const auto touches = [&](const Triangle& t) {
            return std::any_of(t.begin(), t.end(), [&](Index v) { return near[at(v)] != 0; });
        };
        for (int ring = 1; ring < rings; ++ring) {
            std::vector<std::uint8_t> wider = near;
            for (const Triangle& t : triangles)
                if (touches(t))
                    for (const Index v : t) wider[at(v)] = 1;
            near = std::move(wider);
        }
        std::map<Edge, Index> edges;
        for (const Triangle& t : triangles)
            if (touches(t))
                for (std::size_t k = 0; k < 3; ++k) edges.emplace(edge_of(t[k], t[(k + 1) % 3]), -1);
        return edges;
    }
};

}  // namespace

DensifiedMesh densify_around(const SurfaceMesh& mesh, Index vertex, Index valence, int rings, int levels) {
    if (mesh.intrinsic())
        throw std::invalid_argument("densify needs vertex positions; an intrinsic surface has none");
    Refinement r{mesh.points, triangles_of(mesh.connectivity)};
    for (Index missing = valence - r.valence(vertex); missing > 0; missing = valence - r.valence(vertex)) {
        std::vector<Edge> edges = r.link(vertex);
        if (edges.empty()) throw std::invalid_argument("densify: the vertex has no faces");
        edges.resize(std::min(edges.size(), at(missing)));
        std::map<Edge, Index> middle;
        for (const Edge& e : edges)
            if (!middle.contains(e)) middle.emplace(e, r.midpoint(e));
        r.split(middle);
    }
    for (int level = 0; level < levels; ++level) {
        std::map<Edge, Index> middle = r.edges_near(vertex, rings);
        for (auto& [edge, m] : middle) m = r.midpoint(edge);
        r.split(middle);
    }
    DensifiedMesh result;
    result.mesh = make_surface_mesh(std::move(r.points), r.triangles);
    result.mesh.input_vertex.assign(mesh.input_vertex.begin(), mesh.input_vertex.end());
    result.mesh.input_vertex.resize(result.mesh.points.size(),
                                    -1);  // new vertices have no number in the input
    result.valence = 0;
    for (const Index v : result.mesh.connectivity.tail) result.valence += v == vertex ? 1 : 0;
    return result;
}

}  // namespace ricci
