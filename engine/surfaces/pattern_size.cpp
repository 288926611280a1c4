#include "engine/surfaces/pattern_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace ricci {

void check_face_count(double faces) {
    if (!(faces >= 1.0)) throw std::invalid_argument("generate: faces must be at least 1");
    constexpr Index kMostFaces = std::numeric_limits<Index>::max() / 3;
    if (faces > kMostFaces) {
        throw std::invalid_argument("generate: " + std::to_string(faces) + " faces exceed 32-bit indices");
    }
}

Index pattern_repeats(Index faces, double faces_per_square) {
    check_face_count(faces);
    const double wanted = std::sqrt(faces / faces_per_square);
    const double below = std::max(1.0, std::floor(wanted));
    // Nearest in ratio: the border between n and n + 1 is their geometric mean.
    const double repeats = (wanted * wanted > below * (below + 1.0) ? below + 1.0 : below);
    check_face_count(faces_per_square * repeats * repeats);
    return static_cast<Index>(repeats);
}

}  // namespace ricci
