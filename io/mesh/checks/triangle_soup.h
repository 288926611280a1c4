// Triangles that need not form a surface, and their edges.
#pragma once

#include <span>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

inline std::size_t to_size(Index i) {
    return static_cast<std::size_t>(i);
}

/// Triangles with three different vertices each, and the face of the input that each belongs to.
struct TriangleSoup {
    std::vector<Triangle> triangles;
    std::vector<Index> source_face;  // F

    [[nodiscard]] Index tail(Index h) const { return triangles[to_size(h / 3)][to_size(h % 3)]; }
    [[nodiscard]] Index head(Index h) const { return tail(next_halfedge(h)); }
    /// The face of the input that halfedge h lies in.
    [[nodiscard]] Index source(Index h) const { return source_face[to_size(h / 3)]; }
};

/// Halfedges grouped by the unordered pair of their ends; any number of them per edge, in either direction.
/// Edges are numbered by their lowest halfedge, as in Connectivity.
struct SoupEdges {
    std::vector<Index> edge;   // 3F
    std::vector<Index> first;  // E+1: edge e has halfedges[first[e]] ... halfedges[first[e+1]-1], ascending
    std::vector<Index> halfedges;  // 3F

    [[nodiscard]] Index count() const { return static_cast<Index>(first.size()) - 1; }
    [[nodiscard]] std::span<const Index> of(Index e) const {
        return std::span(halfedges).subspan(to_size(first[to_size(e)]),
                                            to_size(first[to_size(e) + 1] - first[to_size(e)]));
    }
};
SoupEdges soup_edges(const TriangleSoup& soup, Index vertex_count);

/// Disjoint sets of 0 ... count-1; the lowest member represents a set.
class DisjointSets {
  public:
    explicit DisjointSets(Index count);
    Index find(Index i);
    void unite(Index a, Index b);

  private:
    std::vector<Index> parent_;
};

}  // namespace ricci
