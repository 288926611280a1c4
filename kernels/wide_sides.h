// Sides of a triangle known by logarithms of more digits than it is evaluated in: what cancels, rounded last.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/extended.h"
#include "kernels/triangle.h"

namespace ricci {

/// Chords and their differences, all to the relative accuracy of long double. `x`: logarithms of the chords.
struct WideSides {
    long double chord[3];
    SideDifferences<long double> difference;
};

inline WideSides wide_sides(const WideReal (&x)[3]) {
    const auto rounded = [](const WideReal& value) { return static_cast<long double>(value); };
    WideSides s;
    for (std::size_t k = 0; k < 3; ++k) s.chord[k] = std::exp(rounded(x[k]));
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const long double shorter = std::min(s.chord[i], s.chord[j]);
        // Of needles: sides that agree in many digits.
        s.difference.gap[k] = s.chord[k] * std::expm1(rounded(std::max(x[i], x[j]) - x[k]));
        s.difference.excess[k] = shorter + s.difference.gap[k];
        // Of flat triangles: a side that is nearly the sum of the other two. Rare, and the exponentials are
        // slow.
        if (std::abs(s.difference.excess[k]) < 0x1p-10L * shorter)
            s.difference.excess[k] = rounded(exp(x[i]) + exp(x[j]) - exp(x[k]));
    }
    return s;
}

}  // namespace ricci
