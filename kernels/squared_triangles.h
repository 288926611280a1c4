// Angles and cotangents of plane triangles given by the squares of their sides, in blocks.
#pragma once

#include <array>

#include "kernels/vector_math.h"

namespace ricci {

/// Up to kFaceBlock triangles, one array per corner or side.
struct SquaredTriangles {
    int count = 0;
    alignas(64) std::array<std::array<double, kFaceBlock>, 3> square;  // in: opposite corner 0, 1, 2
    alignas(64) std::array<std::array<double, kFaceBlock>, 3> angle;   // out: radians
    alignas(64) std::array<std::array<double, kFaceBlock>, 3> cot;     // out
    alignas(64) std::array<double, kFaceBlock> radicand;               // out: 16 area^2; not positive: broken
};

/// Evaluates the first `count` triangles. The square root is taken of 4pq - (p+q-s)^2 with s the largest of
/// the squares: the angle opposite is the best conditioned. Broken triangles have angles 0, 0, pi and
/// cotangents that are not finite. A triangle's bits do not depend on its place.
void evaluate_triangles(SquaredTriangles& triangles);

}  // namespace ricci
