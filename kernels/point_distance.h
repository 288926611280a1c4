// Distance of two points of space.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// Rounded once; infinite where it is beyond the range of double, and zero for equal points only.
double point_distance(const Point& a, const Point& b);

}  // namespace ricci
