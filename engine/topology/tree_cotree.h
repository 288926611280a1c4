// Tree-cotree decomposition: which edges carry the topology of a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/topology/shortest_paths.h"

namespace ricci {

enum class EdgeRole : std::uint8_t { tree, cotree, loop };

/// Every edge of a surface whose boundary components are closed by one polygon each belongs to the primal
/// tree of shortest paths from the base, to the dual tree of faces and polygons, or to the 2g left over.
struct TreeCotree {
    ShortestPaths tree;
    std::vector<EdgeRole> role;                // E
    std::vector<Index> loop_halfedges;         // 2g, one of every edge left over, by length of its loop
    std::vector<std::vector<Index>> boundary;  // boundary_loops()
    std::vector<Index> component_of_halfedge;  // 3F, boundary component of a halfedge without twin, else -1
};

/// The dual tree is a maximum spanning tree for the weight d(tail) + length + d(head), d the distance from
/// the base: the loops base -> tail -> head -> base of the edges left over then are the shortest system that
/// cuts the closed surface into a disk (Erickson, Whittlesey 2005). `avoided`: see shortest_paths. Ties go
/// to the lower edge. Throws std::invalid_argument when the surface is not connected.
TreeCotree tree_cotree(const Connectivity& connectivity, std::span<const double> length, Index base,
                       std::span<const std::uint8_t> avoided);

}  // namespace ricci
