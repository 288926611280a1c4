// Which triangles would have to be flipped for a consistent orientation.
#pragma once

#include <cstdint>
#include <vector>

#include "io/mesh/checks/triangle_soup.h"

namespace ricci {

struct Orientation {
    std::vector<std::uint8_t>
        flip;  // F: 1 where a triangle stands against the majority of its patch (ties: against
               // the patch's first triangle); all 0 in patches that cannot be oriented
    std::vector<Index> contradiction;  // one edge of each patch that cannot be oriented
};

/// Judges patches: triangles connected through edges of exactly two triangles.
Orientation orientation_of(const TriangleSoup& soup, const SoupEdges& edges);

}  // namespace ricci
