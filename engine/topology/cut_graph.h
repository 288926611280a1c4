// Edges along which a surface is cut open into a disk, and the boundary of that disk.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/topology/homotopy_basis.h"

namespace ricci {

/// A side of the disk: a maximal chain of cut edges between nodes, or of boundary edges between nodes. Nodes
/// are the base, cones, boundary vertices and vertices where the number of cut edge-ends is not 2.
struct CutSide {
    std::string name;     // "s3", partner "s3^-1", numbered as met; "c2": arc of boundary component 1
    Index partner = -1;   // index of the side glued to this one; -1 on the boundary
    Index boundary = -1;  // boundary component; -1 for a cut
    std::vector<Index> halfedges;  // in order, the disk on the left; the partner has the twins in reverse
};

struct CutGraph {
    std::vector<std::uint8_t> cut;  // E, 1 where an interior edge is cut
    std::vector<CutSide> sides;     // cyclic, the disk on the left; empty for a sphere that is not cut
};

/// The edges of all loops of the basis, and the tree paths to every cone and to the vertex of each boundary
/// component nearest to the base, less what is superfluous: edges between different pieces (loops that touch
/// the boundary more than once would cut the surface into several; the longest loops go first) and ends that
/// hang loose, neither on the boundary nor at a cone. What is left cuts the surface into one disk; nothing
/// is cut on a disk or on a sphere with at most one cone (which stays a sphere).
CutGraph make_cut_graph(const Connectivity& connectivity, const HomotopyBasis& basis);

/// V - E + F of the surface after cutting along interior edges `cut` (E): 1 for a disk. An uncut vertex in
/// the interior stays one vertex; each cut edge-end adds a copy beyond the first, at boundary vertices all
/// do.
Index euler_characteristic_after(const Connectivity& connectivity, std::span<const std::uint8_t> cut);

}  // namespace ricci
