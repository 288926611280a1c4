// Surfaces with handles: rows of rings, and their halves.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// What to keep of the closed surface: all of it, or what lies on one side of a mirror plane; the cut is
/// straight along the mirror, so that the double of a half is the whole.
enum class RowPart {
    whole,
    upper,  // z >= 0: a sphere with genus + 1 boundaries
    right,  // x >= 0: even genus: genus/2 handles and one boundary; odd: (genus - 1)/2 and two
};

/// A smooth row of `genus` >= 1 rings (ring_row_field.h), about `faces` faces, symmetric to the last bit
/// under the three coordinate reflections (a half: under the other two). Throws std::invalid_argument where
/// genus < 1 or faces < 1.
SurfaceMesh make_ring_row(Index faces, Index genus, RowPart part);

}  // namespace ricci
