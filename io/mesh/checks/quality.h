// Angles of the faces, for reports.
#pragma once

#include <span>

#include "kernels/surface_mesh.h"

namespace ricci {

struct Quality {
    double min_angle_deg = 0;  // smallest corner angle, degrees
    double obtuse_fraction =
        0;  // fraction of faces with an angle above 90 degrees (by more than 1e-8 degrees: right
            // angles of coordinates rounded to double or float are no obtuse ones)
};

/// Of embedded triangles (at least one), computed in long double from the coordinates.
Quality quality_of(std::span<const Triangle> triangles, std::span<const Point> points);

/// Of intrinsic triangles (at least one) with the given edge lengths. // 3F
Quality quality_of(std::span<const double> edge_length);

/// Smallest corner angle of a triangle in radians; 0 where corners coincide.
double min_corner_angle(const Point& a, const Point& b, const Point& c);

/// Corner angles in radians, at a, b and c.
std::array<long double, 3> corner_angles(const Point& a, const Point& b, const Point& c);

}  // namespace ricci
