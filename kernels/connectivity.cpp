#include "kernels/connectivity.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

void check_size(std::size_t faces) {
    constexpr std::size_t kMaxFaces = 715'827'882;  // 3F must fit an Index
    if (faces > kMaxFaces) throw std::invalid_argument("more than 715827882 faces");
}

void number_edges(Connectivity& c) {
    c.edge.assign(c.tail.size(), 0);
    c.edge_count = 0;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        c.edge[at(h)] = (t != kNoTwin && t < h) ? c.edge[at(t)] : c.edge_count++;
    }
}

void check_triangle(const Triangle& triangle, std::size_t f, Index vertex_count) {
    for (const Index v : triangle) {
        if (v < 0 || v >= vertex_count) {
            throw std::invalid_argument("face " + std::to_string(f) + ": vertex " + std::to_string(v) +
                                        " out of range");
        }
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
        throw std::invalid_argument("face " + std::to_string(f) + " repeats a vertex");
    }
}

/// Halfedges grouped by tail (counting sort), ascending within a group.
struct HalfedgesByTail {
    std::vector<Index> first;     // V+1
    std::vector<Index> halfedge;  // 3F
};

HalfedgesByTail group_by_tail(const Connectivity& c) {
    HalfedgesByTail groups{std::vector<Index>(at(c.vertex_count) + 1, 0), std::vector<Index>(c.tail.size())};
    for (const Index v : c.tail) ++groups.first[at(v) + 1];
    std::partial_sum(groups.first.begin(), groups.first.end(), groups.first.begin());
    std::vector<Index> cursor(groups.first.begin(), groups.first.end() - 1);
    for (Index h = 0; h < c.halfedge_count(); ++h) groups.halfedge[at(cursor[at(c.tail[at(h)])]++)] = h;
    return groups;
}

[[noreturn]] void throw_repeated_edge(Index from, Index to) {
    throw std::invalid_argument("the directed edge " + std::to_string(from) + " -> " + std::to_string(to) +
                                " occurs twice: non-manifold or inconsistently oriented");
}

class DisjointSets {
  public:
    explicit DisjointSets(Index count) : parent_(at(count)) {
        std::iota(parent_.begin(), parent_.end(), Index{0});
    }
    Index find(Index i) {
        while (parent_[at(i)] != i) {
            parent_[at(i)] = parent_[at(parent_[at(i)])];
            i = parent_[at(i)];
        }
        return i;
    }
    /// The lower number represents the union.
    void unite(Index a, Index b) {
        a = find(a);
        b = find(b);
        if (a != b) parent_[at(std::max(a, b))] = std::min(a, b);
    }

  private:
    std::vector<Index> parent_;
};

/// Components of vertices that share a face; the root of a component is its lowest vertex.
DisjointSets vertex_components(const Connectivity& c) {
    DisjointSets sets(c.vertex_count);
    for (Index h = 0; h < c.halfedge_count(); ++h) sets.unite(c.tail[at(h)], c.head(h));
    return sets;
}

/// Next boundary halfedge after h: turn about head(h) until a halfedge without twin leaves it.
Index next_on_boundary(const Connectivity& c, Index h) {
    Index n = next_halfedge(h);
    while (c.twin[at(n)] != kNoTwin) n = next_halfedge(c.twin[at(n)]);
    return n;
}

Index count_boundaries(const Connectivity& c) {
    std::vector<std::uint8_t> seen(c.tail.size(), 0);
    Index boundaries = 0;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        if (c.twin[at(h)] != kNoTwin || seen[at(h)] != 0) continue;
        ++boundaries;
        for (Index b = h; seen[at(b)] == 0; b = next_on_boundary(c, b)) seen[at(b)] = 1;
    }
    return boundaries;
}

const char* check_twins(const Connectivity& c) {
    const Index count = c.halfedge_count();
    for (Index h = 0; h < count; ++h) {
        const Index t = c.twin[at(h)];
        if (t == kNoTwin) continue;
        if (t < 0 || t >= count) return "a twin is out of range";
        if (t == h) return "a halfedge is its own twin";
        if (c.twin[at(t)] != h) return "the twins are not an involution";
        if (c.tail[at(t)] != c.head(h) || c.head(t) != c.tail[at(h)])
            return "a twin does not reverse the ends";
    }
    return "";
}

const char* check_tails(const Connectivity& c) {
    if (c.tail.size() % 3 != 0) return "the number of halfedges is not a multiple of three";
    if (c.twin.size() != c.tail.size()) return "tail and twin differ in size";
    if (c.vertex_count < 0) return "the number of vertices is negative";
    for (const Index v : c.tail) {
        if (v < 0 || v >= c.vertex_count) return "a vertex is out of range";
    }
    return "";
}

const char* check_edges(const Connectivity& c) {
    if (c.edge.size() != c.tail.size()) return "tail and edge differ in size";
    if (c.edge_count < 0) return "the number of edges is negative";
    std::vector<std::uint8_t> halfedges(at(c.edge_count), 0);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index e = c.edge[at(h)];
        const Index t = c.twin[at(h)];
        if (e < 0 || e >= c.edge_count) return "an edge number is out of range";
        if (t != kNoTwin && c.edge[at(t)] != e) return "twins do not share their edge";
        if (halfedges[at(e)] == 2) return "an edge has more than two halfedges";
        ++halfedges[at(e)];
        if (halfedges[at(e)] == 2 && t == kNoTwin) return "two halfedges that are not twins share an edge";
    }
    for (const std::uint8_t n : halfedges) {
        if (n == 0) return "an edge has no halfedge";
    }
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const bool interior = c.twin[at(h)] != kNoTwin;
        if (halfedges[at(c.edge[at(h)])] != (interior ? 2 : 1))
            return "an edge does not belong to its halfedges";
    }
    return "";
}

/// Every vertex has one fan: turning about it from any of its halfedges meets all of them.
const char* check_fans(const Connectivity& c) {
    std::vector<std::uint8_t> seen(c.tail.size(), 0);
    std::vector<std::uint8_t> visited(at(c.vertex_count), 0);
    const auto turn = [&c](Index h) { return c.twin[at(prev_halfedge(h))]; };  // anticlockwise about tail(h)
    for (Index start = 0; start < c.halfedge_count(); ++start) {
        if (seen[at(start)] != 0) continue;
        if (visited[at(c.tail[at(start)])]++ != 0) return "a vertex has more than one fan of faces";
        Index h = start;
        while (c.twin[at(h)] != kNoTwin) {  // clockwise to the boundary, or once around
            h = next_halfedge(c.twin[at(h)]);
            if (h == start) break;
        }
        for (; h != kNoTwin && seen[at(h)] == 0; h = turn(h)) seen[at(h)] = 1;
    }
    return "";
}

}  // namespace

Connectivity build_connectivity(std::span<const Triangle> triangles, Index vertex_count) {
    check_size(triangles.size());
    if (vertex_count < 0) throw std::invalid_argument("negative number of vertices");
    Connectivity c;
    c.vertex_count = vertex_count;
    c.tail.reserve(triangles.size() * 3);
    for (std::size_t f = 0; f < triangles.size(); ++f) {
        check_triangle(triangles[f], f, vertex_count);
        c.tail.insert(c.tail.end(), triangles[f].begin(), triangles[f].end());
    }
    c.twin.assign(c.tail.size(), kNoTwin);
    const HalfedgesByTail groups = group_by_tail(c);
    // leaving[v]: the halfedge from the current tail to v; valid while stamp[v] is that tail.
    std::vector<Index> leaving(at(vertex_count), kNoTwin);
    std::vector<Index> stamp(at(vertex_count), -1);
    for (Index v = 0; v < vertex_count; ++v) {
        const Index begin = groups.first[at(v)];
        const Index end = groups.first[at(v) + 1];
        for (Index g = begin; g < end; ++g) {
            const Index h = groups.halfedge[at(g)];
            const Index w = c.head(h);
            if (stamp[at(w)] == v) throw_repeated_edge(v, w);
            stamp[at(w)] = v;
            leaving[at(w)] = h;
        }
        for (Index g = begin; g < end; ++g) {
            const Index arriving = prev_halfedge(groups.halfedge[at(g)]);  // from some u to v
            const Index u = c.tail[at(arriving)];
            if (stamp[at(u)] == v) c.twin[at(arriving)] = leaving[at(u)];
        }
    }
    number_edges(c);
    return c;
}

Connectivity connectivity_from_gluing(std::vector<Index> tail, std::vector<Index> twin, Index vertex_count) {
    check_size(tail.size() / 3);
    Connectivity c;
    c.vertex_count = vertex_count;
    c.tail = std::move(tail);
    c.twin = std::move(twin);
    if (const char* broken = check_tails(c); *broken != '\0') throw std::invalid_argument(broken);
    if (const char* broken = check_twins(c); *broken != '\0') throw std::invalid_argument(broken);
    number_edges(c);
    return c;
}

std::vector<Index> edge_halfedges(const Connectivity& connectivity) {
    std::vector<Index> halfedges(at(connectivity.edge_count), kNoTwin);
    for (Index h = connectivity.halfedge_count() - 1; h >= 0; --h) {
        halfedges[at(connectivity.edge[at(h)])] = h;
    }
    return halfedges;
}

std::vector<std::uint8_t> boundary_vertices(const Connectivity& connectivity) {
    std::vector<std::uint8_t> boundary(at(connectivity.vertex_count), 0);
    for (Index h = 0; h < connectivity.halfedge_count(); ++h) {
        if (connectivity.twin[at(h)] != kNoTwin) continue;
        boundary[at(connectivity.tail[at(h)])] = 1;
        boundary[at(connectivity.head(h))] = 1;
    }
    return boundary;
}

std::vector<std::uint8_t> used_vertices(const Connectivity& connectivity) {
    std::vector<std::uint8_t> used(at(connectivity.vertex_count), 0);
    for (const Index v : connectivity.tail) used[at(v)] = 1;
    return used;
}

Topology topology_of(const Connectivity& connectivity) {
    const Connectivity& c = connectivity;
    Topology topology;
    topology.edges = c.edge_count;
    topology.faces = c.face_count();
    const std::vector<std::uint8_t> used = used_vertices(c);
    DisjointSets sets = vertex_components(c);
    for (Index v = 0; v < c.vertex_count; ++v) {
        if (used[at(v)] == 0) continue;
        ++topology.vertices;
        if (sets.find(v) == v) ++topology.components;
    }
    topology.boundaries = count_boundaries(c);
    topology.euler_characteristic = topology.vertices - topology.edges + topology.faces;
    topology.genus = (2 * topology.components - topology.boundaries - topology.euler_characteristic) / 2;
    return topology;
}

std::vector<Index> face_components(const Connectivity& connectivity) {
    const Connectivity& c = connectivity;
    DisjointSets sets = vertex_components(c);
    const std::vector<std::uint8_t> used = used_vertices(c);
    std::vector<Index> number(at(c.vertex_count), -1);  // of a root
    Index components = 0;
    for (Index v = 0; v < c.vertex_count; ++v) {
        // A root is the lowest vertex of its component, so ascending roots are components by lowest vertex.
        if (used[at(v)] != 0 && sets.find(v) == v) number[at(v)] = components++;
    }
    std::vector<Index> component(at(c.face_count()));
    for (Index f = 0; f < c.face_count(); ++f) component[at(f)] = number[at(sets.find(c.tail[at(3 * f)]))];
    return component;
}

const char* check_connectivity(const Connectivity& connectivity) {
    if (const char* broken = check_tails(connectivity); *broken != '\0') return broken;
    if (const char* broken = check_twins(connectivity); *broken != '\0') return broken;
    if (const char* broken = check_edges(connectivity); *broken != '\0') return broken;
    return check_fans(connectivity);
}

}  // namespace ricci
