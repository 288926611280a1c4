// How often a pattern must repeat to come near a wanted number of faces.
#pragma once

#include "kernels/connectivity.h"

namespace ricci {

/// The n >= 1 for which faces_per_square * n^2 is nearest to `faces` in ratio.
/// Throws std::invalid_argument when `faces` is below 1 or the surface would not fit 32-bit halfedges.
Index pattern_repeats(Index faces, double faces_per_square);

/// Throws std::invalid_argument unless 3 * faces fits an Index.
void check_face_count(double faces);

}  // namespace ricci
