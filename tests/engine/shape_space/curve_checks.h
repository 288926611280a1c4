// What the tests of drawn geodesics share: curves on the surface, words as text.
#pragma once

#include <sstream>

#include "engine/shape_space/drawn_geodesic.h"
#include "engine/shape_space/surface_spectrum.h"
#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci::testing {

/// "a1 b1^-1" back to a word.
inline Word word_of(const std::string& text, const SurfaceGroup& group) {
    Word word;
    std::istringstream letters(text);
    for (std::string letter; letters >> letter;) {
        const bool inverted = letter.size() > 3 && letter.substr(letter.size() - 3) == "^-1";
        const std::string name = inverted ? letter.substr(0, letter.size() - 3) : letter;
        Index number = 0;
        for (std::size_t k = 0; k < group.generators.size(); ++k)
            if (group.generators[k].name == name) number = static_cast<Index>(k) + 1;
        if (number == 0) throw std::runtime_error("no generator " + name);
        word.push_back(inverted ? -number : number);
    }
    return word;
}

/// Every segment lies in the triangle that it says, and the last point is the first.
inline void expect_on_surface(const SurfaceMesh& mesh, const SurfaceCurve& curve, double length) {
    ASSERT_GE(curve.points.size(), 2U);
    ASSERT_EQ(curve.points.size(), curve.face.size() + 1);
    ASSERT_EQ(curve.lengths.size(), curve.face.size());
    EXPECT_EQ(curve.points.front(), curve.points.back());
    double sum = 0;
    for (std::size_t k = 0; k < curve.face.size(); ++k) {
        std::array<Point, 3> corner;
        for (std::size_t i = 0; i < 3; ++i)
            corner[i] = mesh.points[at(mesh.connectivity.tail[3 * at(curve.face[k]) + i])];
        const auto minus = [](const Point& p, const Point& q) {
            return Point{p[0] - q[0], p[1] - q[1], p[2] - q[2]};
        };
        const auto dot = [](const Point& p, const Point& q) {
            return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        };
        const Point e = minus(corner[1], corner[0]), f = minus(corner[2], corner[0]);
        const double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), determinant = ee * ff - ef * ef;
        for (const std::size_t end : {k, k + 1}) {
            const Point p = minus(curve.points[end], corner[0]);
            const double pe = dot(p, e), pf = dot(p, f), u = (pe * ff - pf * ef) / determinant,
                         v = (pf * ee - pe * ef) / determinant;
            ASSERT_GE(std::min({u, v, 1 - u - v}), -1e-6);
            Point off = p;
            for (std::size_t i = 0; i < 3; ++i) off[i] -= u * e[i] + v * f[i];
            ASSERT_LE(std::sqrt(dot(off, off)), 1e-9 * std::sqrt(ee + ff));
        }
        ASSERT_GE(curve.lengths[k], 0.0);
        sum += curve.lengths[k];
    }
    EXPECT_NEAR(sum, length, 1e-8 * length);
    EXPECT_NEAR(curve.length, length, 1e-8 * length);
    EXPECT_LE(curve.closing_error, 1e-7 * length);
}

}  // namespace ricci::testing
