// The boundary of a surface as closed walks.
#pragma once

#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// The boundary halfedge that follows h (one without twin), the surface on the left.
Index next_on_boundary(const Connectivity& connectivity, Index h);

/// Every boundary component as the cycle of its halfedges, the surface on the left: a hole is walked
/// clockwise. Components are ordered by lowest halfedge, with which each cycle starts.
std::vector<std::vector<Index>> boundary_loops(const Connectivity& connectivity);

}  // namespace ricci
