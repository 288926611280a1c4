#include "engine/topology/tree_cotree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "engine/topology/boundary_loops.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

void check_connected(const Connectivity& c, const ShortestPaths& tree) {
    const std::vector<std::uint8_t> used = used_vertices(c);
    for (Index v = 0; v < c.vertex_count; ++v) {
        if (used[at(v)] != 0 && std::isinf(tree.distance[at(v)]))
            throw std::invalid_argument("the surface is not connected: no path from vertex " +
                                        std::to_string(tree.root) + " to vertex " + std::to_string(v));
    }
}

Index find(std::vector<Index>& parent, Index i) {
    while (parent[at(i)] != i) {
        parent[at(i)] = parent[at(parent[at(i)])];
        i = parent[at(i)];
    }
    return i;
}

/// Kruskal over the edges outside the primal tree, the longest loop first.
void grow_dual_tree(const Connectivity& c, std::span<const double> length, TreeCotree& result) {
    const std::vector<Index> halfedge = edge_halfedges(c);
    const std::vector<double>& d = result.tree.distance;
    std::vector<Index> order;
    std::vector<double> weight(at(c.edge_count));
    for (Index e = 0; e < c.edge_count; ++e) {
        const Index h = halfedge[at(e)];
        weight[at(e)] = d[at(c.tail[at(h)])] + length[at(h)] + d[at(c.head(h))];
        if (result.role[at(e)] != EdgeRole::tree) order.push_back(e);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&weight](Index e, Index f) { return weight[at(e)] > weight[at(f)]; });
    std::vector<Index> parent(at(c.face_count()) + result.boundary.size());  // faces, then polygons
    std::iota(parent.begin(), parent.end(), Index{0});
    for (const Index e : order) {
        const Index h = halfedge[at(e)], t = c.twin[at(h)];
        const Index other = t == kNoTwin ? c.face_count() + result.component_of_halfedge[at(h)] : face_of(t);
        const Index a = find(parent, face_of(h)), b = find(parent, other);
        if (a == b) {
            result.role[at(e)] = EdgeRole::loop;
            result.loop_halfedges.push_back(h);
        } else {
            parent[at(std::max(a, b))] = std::min(a, b);
        }
    }
    std::reverse(result.loop_halfedges.begin(), result.loop_halfedges.end());
}

}  // namespace

TreeCotree tree_cotree(const Connectivity& connectivity, std::span<const double> length, Index base,
                       std::span<const std::uint8_t> avoided) {
    TreeCotree result;
    result.tree = shortest_paths(connectivity, vertex_stars(connectivity), length, base, avoided);
    check_connected(connectivity, result.tree);
    result.role.assign(at(connectivity.edge_count), EdgeRole::cotree);
    for (const Step s : result.tree.arriving) {
        if (s != kNoStep) result.role[at(connectivity.edge[at(halfedge_of(s))])] = EdgeRole::tree;
    }
    result.boundary = boundary_loops(connectivity);
    result.component_of_halfedge.assign(connectivity.tail.size(), -1);
    for (std::size_t j = 0; j < result.boundary.size(); ++j)
        for (const Index h : result.boundary[j]) result.component_of_halfedge[at(h)] = static_cast<Index>(j);
    grow_dual_tree(connectivity, length, result);
    return result;
}

}  // namespace ricci
