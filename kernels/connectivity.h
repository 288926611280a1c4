// Flat triangle connectivity with implicit halfedges.
//
//             k
//           /   \            face f owns the halfedges 3f, 3f+1, 3f+2; halfedge h = 3f+c runs from
//   prev(h)/     \next(h)    corner c to the next corner, so next and prev are arithmetic. twin[h]
//         /   f   \          is the oppositely directed halfedge of the neighbouring face, or
//        i ------> j         kNoTwin on the boundary. Loops and multi-edges are legal: an edge is
//             h              named by its halfedges, never by its pair of vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ricci {

using Index = std::int32_t;
inline constexpr Index kNoTwin = -1;

constexpr Index next_halfedge(Index h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}
constexpr Index prev_halfedge(Index h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}
constexpr Index face_of(Index h) {
    return h / 3;
}

using Triangle = std::array<Index, 3>;

/// Connectivity of a triangulated surface, possibly with boundary, several components, or unused vertices.
struct Connectivity {
    Index vertex_count = 0;   // vertices are 0 … vertex_count-1; unused ones have no halfedge
    Index edge_count = 0;     // edges are 0 … edge_count-1
    std::vector<Index> tail;  // 3F, vertex at which halfedge h starts
    std::vector<Index> twin;  // 3F, opposite halfedge or kNoTwin
    std::vector<Index> edge;  // 3F, edge of the halfedge; h and twin[h] share it

    [[nodiscard]] Index face_count() const { return static_cast<Index>(tail.size() / 3); }
    [[nodiscard]] Index halfedge_count() const { return static_cast<Index>(tail.size()); }
    [[nodiscard]] Index head(Index h) const { return tail[static_cast<std::size_t>(next_halfedge(h))]; }
};

/// Builds connectivity from vertex triples by matching oppositely directed edges (i,j) and (j,i).
/// Throws std::invalid_argument when an index is out of range, a directed edge occurs twice (non-manifold or
/// inconsistently oriented) or a face repeats a vertex; io's importer diagnoses such inputs by name before.
Connectivity build_connectivity(std::span<const Triangle> triangles, Index vertex_count);

/// Builds connectivity from explicit gluing (interface: intrinsic surfaces): loops and multi-edges allowed.
/// `tail`, `twin`: 3F. Throws std::invalid_argument where the twins are not an involution that reverses ends.
Connectivity connectivity_from_gluing(std::vector<Index> tail, std::vector<Index> twin, Index vertex_count);

/// One halfedge of every edge, indexed by edge (the lower-numbered one). // E
std::vector<Index> edge_halfedges(const Connectivity& connectivity);

/// 1 where a vertex lies on the boundary. // V
std::vector<std::uint8_t> boundary_vertices(const Connectivity& connectivity);

/// 1 where a vertex is used by a face. // V
std::vector<std::uint8_t> used_vertices(const Connectivity& connectivity);

/// Topological type of one component (or of a whole, possibly disconnected, surface).
struct Topology {
    Index vertices = 0;  // used ones
    Index edges = 0, faces = 0, components = 0, boundaries = 0;
    Index euler_characteristic = 0;  // V - E + F
    Index genus = 0;                 // summed over components: (2c - b - chi)/2
};
Topology topology_of(const Connectivity& connectivity);

/// Component number of every face, numbered by lowest vertex. // F
std::vector<Index> face_components(const Connectivity& connectivity);

/// Checks the invariants stated at the top; returns an empty string or what is broken. For tests and
/// assertions.
const char* check_connectivity(const Connectivity& connectivity);

}  // namespace ricci
