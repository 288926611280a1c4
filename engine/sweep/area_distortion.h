// The area distortion of a metric on a surface: what a sweep ranks its vertices by.
#pragma once

#include <span>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// Mean over the faces of (log(S_f / sum S) - log(s_f / sum s))^2, with S_f the input's areas (thesis
/// section 5.3.1.2; its printed formula has a sign slip). Vertex scaling: log s_f = log S_f + (2/3)(u_i + u_j
/// + u_k), whether or not the face was flipped away. `area`: F, `tail`: 3F, `u`: V. Invariant under adding a
/// constant to u.
double area_distortion_of_scaling(std::span<const double> area, std::span<const Index> tail,
                                  std::span<const double> u);

/// The same from the faces' areas in the new metric. `area`, `new_area`: F.
double area_distortion_of_areas(std::span<const double> area, std::span<const double> new_area);

}  // namespace ricci
