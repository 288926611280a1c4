// First cohomology of a coarse surface with its boundary filled in.
#pragma once

#include <vector>

#include "engine/shape_space/closed_geodesic.h"

namespace ricci {

/// 2g closed 1-forms with integer values that are a basis modulo exact ones: a closed curve has all periods 0
/// exactly where it bounds, boundaries of the surface filled in. A simple closed curve with a period that is
/// not 0 does not separate.
std::vector<Cocycle> handle_cocycles(const CoarseSurface& surface);

}  // namespace ricci
