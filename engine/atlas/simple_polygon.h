// Whether a closed polygon crosses itself.
#pragma once

#include <array>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// One side of a polygon; sides that share the number of an end are neighbours.
struct RimSegment {
    std::array<double, 2> from, to;
    Index from_vertex = -1, to_vertex = -1;
};

/// Whether no two sides cross, but for rounding. A disk that is mapped without folds, its rim to a simple
/// polygon, is mapped one to one. False where a coordinate is not finite.
bool is_simple(std::vector<RimSegment> rim);

}  // namespace ricci
