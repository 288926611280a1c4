// Exact test for faces of zero area.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// True exactly when the three finite points lie on one line (equal points included): no rounding, no
/// underflow.
bool collinear(const Point& a, const Point& b, const Point& c);

}  // namespace ricci
