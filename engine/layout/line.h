// Lines of the plane and of the hyperbolic plane, as normals.
#pragma once

#include <array>
#include <optional>

#include "engine/layout/isometry.h"

namespace ricci {

/// The unit normal vector n of a line's plane through the origin, in the frame of a final face. The line is
/// where line_side is 0, and runs with its positive side on the left. kappa = -1: n_x^2 + n_y^2 - n_t^2 = 1;
/// kappa = 0: n_x^2 + n_y^2 = 1, and n_t is the offset.
using LineNormal = std::array<double, 3>;

/// n_x x + n_y y - n_t t on the hyperboloid (t last), n_x x + n_y y + n_t t in the plane. For points: sinh of
/// the distance from the line, or the distance, positive on the left.
double line_side(int kappa, const LineNormal& normal, const std::array<double, 3>& x);
/// Scaled to a unit normal.
LineNormal unit_normal(int kappa, const LineNormal& normal);
/// The image of the line under an isometry.
LineNormal moved_line(int kappa, const Isometry<double>& motion, const LineNormal& normal);
/// The line at right angles that crosses `normal` in its point x, from the left to the right: positive ahead
/// of x.
LineNormal line_across(int kappa, const LineNormal& normal, const std::array<double, 3>& x);
/// The point, as a vector (x, t), where two lines cross; they must.
std::array<double, 3> line_crossing(int kappa, const LineNormal& first, const LineNormal& second);

/// The line that a translation moves along itself, in its direction; in the plane the one through the origin.
/// None for isometries that are no translations (rotations, the identity).
std::optional<LineNormal> translation_axis(int kappa, const Isometry<double>& element);
/// Length of a translation.
double translation_length(int kappa, const Isometry<double>& element);

}  // namespace ricci
