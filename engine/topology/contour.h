// The boundary of a surface cut into a disk, read as a word; the words of all halfedges are parts of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/topology/tree_cotree.h"
#include "engine/topology/words.h"

namespace ricci {

/// Cutting along the primal tree and the loop edges leaves a disk, the faces and polygons of the dual tree.
/// Its boundary, read counterclockwise from face 0, meets each letter as homotopy_basis.h tells.
///
/// For a face f (not face 0) the dual tree enters by the halfedge p of f. The subtree of f is a disk on the
/// left of p whose boundary is p * rest = 1, rest leading from head(p) to tail(p): so word(p) = rest^-1 and
/// word(twin p) = rest, and rest is a stretch of the whole boundary.
struct Contour {
    Word word;                          // the relator
    std::vector<Index> begin, end;      // E, stretch of `word` that belongs to the edge; empty on the tree
    std::vector<std::uint8_t> inverse;  // 3F, 1 where word(h) is the inverse of that stretch
    std::vector<Index> entrance;        // boundaries, halfedge by which the dual tree enters the polygon
};

/// `cones`: the letter of cones[i] is 2g + boundaries + i + 1, inserted inverted (see homotopy_basis.h).
Contour trace_contour(const Connectivity& connectivity, const TreeCotree& trees,
                      std::span<const Index> cones);

}  // namespace ricci
