#include "io/picture/checkerboard.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace ricci {
namespace {

constexpr double kMaximalSquare = 0x1p51;  // beyond 2^53 there is no next square

// A corner of a piece: texture coordinates in units of squares, and where it is drawn.
struct Corner {
    PlanePoint uv, point;
};
using Piece = std::vector<Corner>;

// Where the segment meets the line uv[axis] = level. Evaluated from the end with the smaller coordinates, so
// that both triangles at an edge get the same bits; on the line exactly.
Corner crossing(const Corner& p, const Corner& q, std::size_t axis, double level) {
    const bool swap = std::pair(q.uv, q.point) < std::pair(p.uv, p.point);
    const Corner& a = swap ? q : p;
    const Corner& b = swap ? p : q;
    const double t = (level - a.uv[axis]) / (b.uv[axis] - a.uv[axis]);
    Corner corner;
    for (std::size_t k = 0; k < 2; ++k) {
        corner.uv[k] = a.uv[k] + t * (b.uv[k] - a.uv[k]);
        corner.point[k] = a.point[k] + t * (b.point[k] - a.point[k]);
    }
    corner.uv[axis] = level;
    return corner;
}

// Cuts a convex piece along uv[axis] = level. Either part may come out empty or flat.
void split(const Piece& piece, std::size_t axis, double level, Piece& below, Piece& above) {
    below.clear();
    above.clear();
    for (std::size_t i = 0; i < piece.size(); ++i) {
        const Corner& p = piece[i];
        const Corner& q = piece[i + 1 == piece.size() ? 0 : i + 1];
        if (p.uv[axis] <= level) below.push_back(p);
        if (p.uv[axis] >= level) above.push_back(p);
        const bool crosses =
            (p.uv[axis] < level && q.uv[axis] > level) || (p.uv[axis] > level && q.uv[axis] < level);
        if (!crosses) continue;
        below.push_back(crossing(p, q, axis, level));
        above.push_back(below.back());
    }
}

std::pair<double, double> range_of(const Piece& piece, std::size_t axis) {
    const auto [low, high] =
        std::minmax_element(piece.begin(), piece.end(),
                            [&](const Corner& a, const Corner& b) { return a.uv[axis] < b.uv[axis]; });
    return {low->uv[axis], high->uv[axis]};
}

// Calls take(part, i) for every part of the piece in i <= uv[axis] < i + 1.
template <class Take>
void slice(Piece piece, std::size_t axis, Take take) {
    const auto [low, high] = range_of(piece, axis);
    Piece below, above;
    double i = std::floor(low);
    while (i < high) {
        if (high <= i + 1.0) return take(piece, i);
        split(piece, axis, i + 1.0, below, above);
        if (below.size() > 2) take(below, i);
        piece.swap(above);
        if (piece.size() < 3) return;
        i += 1.0;
    }
}

void append(const Piece& piece, PlanePolygons& polygons) {
    for (const Corner& corner : piece) polygons.points.push_back(corner.point);
    polygons.start.push_back(polygons.points.size());
}

Piece piece_of(const TexturedTriangle& triangle, double cell) {
    Piece piece;
    for (std::size_t k = 0; k < 3; ++k) {
        const PlanePoint uv{triangle.uv[k][0] / cell, triangle.uv[k][1] / cell};
        for (const double x : {uv[0], uv[1], triangle.corners[k][0], triangle.corners[k][1]})
            if (!std::isfinite(x)) throw std::invalid_argument("a textured triangle is not finite");
        if (std::max(std::abs(uv[0]), std::abs(uv[1])) > kMaximalSquare)
            throw std::invalid_argument("texture coordinates are too large for squares to be told apart");
        piece.push_back({uv, triangle.corners[k]});
    }
    return piece;
}

// Squares of the box around the piece.
double squares_of(const Piece& piece) {
    const auto [left, right] = range_of(piece, 0);
    const auto [bottom, top] = range_of(piece, 1);
    return (std::floor(right) - std::floor(left) + 1.0) * (std::floor(top) - std::floor(bottom) + 1.0);
}

}  // namespace

PlanePolygons black_squares(std::span<const TexturedTriangle> triangles, double cell, std::size_t limit) {
    if (!(cell > 0.0 && std::isfinite(cell))) throw std::invalid_argument("a square has a positive side");
    PlanePolygons polygons;
    double squares = 0.0;
    for (const TexturedTriangle& triangle : triangles) {
        const Piece piece = piece_of(triangle, cell);
        squares += squares_of(piece);
        if (squares > static_cast<double>(limit))
            throw std::invalid_argument("a checkerboard has too many squares; make them larger");
        slice(piece, 0, [&](const Piece& column, double i) {
            slice(column, 1, [&](const Piece& part, double j) {
                if (std::fmod(i + j, 2.0) == 0.0) append(part, polygons);
            });
        });
    }
    return polygons;
}

}  // namespace ricci
