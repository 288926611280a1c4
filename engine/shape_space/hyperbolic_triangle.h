// One hyperbolic triangle, small or large, in half chords sinh(l/2).
//
// Halfedge k runs from corner k to corner k + 1, opposite corner k + 2. Angles are given as e^(i theta).
#pragma once

#include <array>

#include "engine/layout/isometry.h"

namespace ricci {

/// Angles of a triangle. Where rounding leaves it no area they are 0, 0, pi.
std::array<Complex<double>, 3> triangle_angles(const std::array<double, 3>& half_chord);

/// The side opposite two others and the angle between them, in (0, pi):
/// sinh^2(a/2) = sinh^2((b - c)/2) + sinh b sinh c sin^2(A/2).
double third_half_chord(double b, double c, const Complex<double>& angle);

/// Half chord of half the length.
double halved(double half_chord);

/// Every point of the triangle has a corner within this distance, and no less will do.
double covering_radius(const std::array<double, 3>& half_chord, const std::array<Complex<double>, 3>& angle);

}  // namespace ricci
