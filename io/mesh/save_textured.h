// Surfaces with texture coordinates as Wavefront OBJ.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

inline constexpr Index kNoTexture = -1;

/// One corner of a face: numbers of its point and of its texture coordinates, or kNoTexture.
struct TexturedCorner {
    Index point = 0, uv = 0;
    bool operator==(const TexturedCorner&) const = default;
};

/// Polygons in space with texture coordinates of their own at every corner, so that a texture may be cut
/// where the surface is not.
struct TexturedMesh {
    std::vector<Point> points;              // P
    std::vector<std::array<double, 2>> uv;  // T
    std::vector<TexturedCorner> corners;    // face after face, each in its cyclic order
    std::vector<Index> face_start{0};       // F+1, first corner of each face
};

/// Writes `path` (.obj): v, vt and f v/vt with shortest round-trip decimals, in the order given, so that
/// load_mesh gives the same points and faces (polygons cut into triangles). With checker_squares > 0 also
/// <stem>.mtl and <stem>.png beside it: a checkerboard of that many squares along u and along v in
/// 0 <= u, v < 1, which viewers repeat; black as in black_squares() (io/picture/checkerboard.h) with cells of
/// 1/checker_squares, so an even number goes on across the repeats. Throws std::invalid_argument for an index
/// out of range, a face of fewer than three corners, numbers that are not finite or more than 1024 squares;
/// FileError for another suffix and where writing fails.
void save_textured(const std::string& path, const TexturedMesh& mesh, int checker_squares = 0);

}  // namespace ricci
