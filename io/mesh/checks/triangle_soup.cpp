#include "io/mesh/checks/triangle_soup.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ricci {
namespace {

/// Halfedges sorted by lower end, upper end, number: counting sort by the lower end, then each short group.
std::vector<Index> sorted_halfedges(const TriangleSoup& soup, Index vertex_count) {
    const auto count = static_cast<Index>(3 * soup.triangles.size());
    std::vector<Index> first(to_size(vertex_count) + 1, 0);
    const auto low = [&](Index h) { return to_size(std::min(soup.tail(h), soup.head(h))); };
    for (Index h = 0; h < count; ++h) ++first[low(h) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::pair<Index, Index>> entries(to_size(count));  // upper end, halfedge
    std::vector<Index> cursor(first.begin(), first.end() - 1);
    for (Index h = 0; h < count; ++h) {
        entries[to_size(cursor[low(h)]++)] = {std::max(soup.tail(h), soup.head(h)), h};
    }
    for (std::size_t v = 0; v < to_size(vertex_count); ++v) {
        std::sort(entries.begin() + first[v], entries.begin() + first[v + 1]);
    }
    std::vector<Index> sorted(entries.size());
    std::transform(entries.begin(), entries.end(), sorted.begin(),
                   [](const auto& entry) { return entry.second; });
    return sorted;
}

bool same_ends(const TriangleSoup& soup, Index g, Index h) {
    const bool parallel = soup.tail(g) == soup.tail(h) && soup.head(g) == soup.head(h);
    const bool opposite = soup.tail(g) == soup.head(h) && soup.head(g) == soup.tail(h);
    return parallel || opposite;
}

}  // namespace

SoupEdges soup_edges(const TriangleSoup& soup, Index vertex_count) {
    const std::vector<Index> sorted = sorted_halfedges(soup, vertex_count);
    std::vector<Index> leader(sorted.size());  // lowest halfedge of the edge
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const bool joins = i > 0 && same_ends(soup, sorted[i - 1], sorted[i]);
        leader[to_size(sorted[i])] = joins ? leader[to_size(sorted[i - 1])] : sorted[i];
    }
    SoupEdges edges;
    edges.edge.resize(sorted.size());
    Index count = 0;
    for (std::size_t h = 0; h < leader.size(); ++h) {
        const auto lead = to_size(leader[h]);
        edges.edge[h] = lead == h ? count++ : edges.edge[lead];
    }
    edges.first.assign(to_size(count) + 1, 0);
    for (const Index e : edges.edge) ++edges.first[to_size(e) + 1];
    std::partial_sum(edges.first.begin(), edges.first.end(), edges.first.begin());
    std::vector<Index> cursor(edges.first.begin(), edges.first.end() - 1);
    edges.halfedges.resize(sorted.size());
    for (std::size_t h = 0; h < leader.size(); ++h) {
        edges.halfedges[to_size(cursor[to_size(edges.edge[h])]++)] = static_cast<Index>(h);
    }
    return edges;
}

DisjointSets::DisjointSets(Index count) : parent_(to_size(count)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
}

Index DisjointSets::find(Index i) {
    while (parent_[to_size(i)] != i) {
        parent_[to_size(i)] = parent_[to_size(parent_[to_size(i)])];
        i = parent_[to_size(i)];
    }
    return i;
}

void DisjointSets::unite(Index a, Index b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[to_size(std::max(a, b))] = std::min(a, b);
}

}  // namespace ricci
