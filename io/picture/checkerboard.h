// A checkerboard in texture coordinates, cut out of triangles that lie anywhere in the plane.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "io/picture/circular_arc.h"

namespace ricci {

/// A triangle as it is drawn, with texture coordinates that are linear over it.
struct TexturedTriangle {
    std::array<PlanePoint, 3> corners;
    std::array<PlanePoint, 3> uv;
};

/// Polygons, corner after corner.
struct PlanePolygons {
    std::vector<PlanePoint> points;
    std::vector<std::size_t> start{0};  // N+1, first point of each polygon

    [[nodiscard]] std::size_t size() const { return start.size() - 1; }
    [[nodiscard]] std::span<const PlanePoint> polygon(std::size_t i) const {
        return std::span<const PlanePoint>(points).subspan(start[i], start[i + 1] - start[i]);
    }
};

/// The parts of the triangles that lie in black squares, where floor(u / cell) + floor(v / cell) is even: a
/// convex polygon for each triangle and square, oriented as the triangle. Cuts of an edge come out bit for
/// bit alike in both triangles that share it, so there are neither gaps nor overlaps. Throws
/// std::invalid_argument unless cell > 0, for coordinates that are not finite or beyond 2^51 squares, and
/// where the triangles cross more than `limit` squares (counted by the boxes around them).
PlanePolygons black_squares(std::span<const TexturedTriangle> triangles, double cell = 1.0,
                            std::size_t limit = 4'000'000);

}  // namespace ricci
