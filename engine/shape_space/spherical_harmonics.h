// Real orthonormal spherical harmonics.
#pragma once

#include <cstddef>
#include <span>

#include "kernels/surface_mesh.h"

namespace ricci {

/// Number of harmonics of degree 0 ... `degree`.
constexpr std::size_t harmonic_count(int degree) {
    const std::size_t side = static_cast<std::size_t>(degree) + 1;
    return side * side;
}

/// Index of Y_lm, -l <= m <= l.
constexpr std::size_t harmonic_index(int l, int m) {
    const auto row = static_cast<std::size_t>(l);
    return row * row + static_cast<std::size_t>(l + m);
}

/// All Y_lm(p) up to `degree` at a point of the unit sphere: integral of Y Y' over the sphere = delta. m > 0:
/// with cos(m phi), m < 0: with sin(|m| phi), phi about the z axis, no sign (-1)^m. Y_lm is even under z ->
/// -z where l + m is. // value: harmonic_count(degree)
void spherical_harmonics(int degree, const Point& p, std::span<double> value);

}  // namespace ricci
