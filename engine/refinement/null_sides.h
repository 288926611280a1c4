// Tidies a refinement: crossings that fall on one another, or on a vertex.
#pragma once

#include "engine/refinement/common_refinement.h"

namespace ricci {

/// On symmetric surfaces edges of all three triangulations meet in one point. The refinement is right
/// combinatorially then, too, but has sides of no length and pieces of no area. Merges the ends of such sides
/// (to rounding, in the input's metric), unless both are vertices of the input, and glues the neighbours of
/// pieces that lose all but two sides. Returns the number of pieces removed. Vertices keep their numbers;
/// merged ones are no longer used.
Index collapse_null_sides(CommonRefinement& refinement);

}  // namespace ricci
