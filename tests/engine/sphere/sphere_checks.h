// What the tests of the sphere share.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "engine/sphere/solve_sphere.h"
#include "engine/surfaces/generate.h"
#include "tests/support/small_surfaces.h"

namespace ricci::testing {

inline double dot(const Point& p, const Point& q) {
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

inline double distance(const Point& p, const Point& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// An ellipsoid (or whatever generate() knows) with displaced vertices.
inline SurfaceMesh jittered(const std::string& name, Index faces, std::uint64_t seed = 1) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = 0.3;
    options.seed = seed;
    return generate(name, options);
}

/// `half` random points of the unit sphere and their antipodes: equal masses have their centre at the origin.
inline std::vector<Point> antipodal_points(std::size_t half, Random& random) {
    std::vector<Point> points;
    while (points.size() < 2 * half) {
        const Point p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const double length = std::sqrt(dot(p, p));
        if (length > 1.0 || length < 0.1) continue;
        points.push_back({p[0] / length, p[1] / length, p[2] / length});
        points.push_back({-p[0] / length, -p[1] / length, -p[2] / length});
    }
    return points;
}

/// The convex hull of points in general position, by trying every triple.
inline std::vector<Triangle> hull_triangles(const std::vector<Point>& p) {
    const auto n = static_cast<Index>(p.size());
    const auto outside = [&](Index a, Index b, Index c, Index d) {
        std::array<Point, 3> e;
        for (std::size_t x = 0; x < 3; ++x) {
            e[0][x] = p[at(b)][x] - p[at(a)][x];
            e[1][x] = p[at(c)][x] - p[at(a)][x];
            e[2][x] = p[at(d)][x] - p[at(a)][x];
        }
        const Point normal{e[0][1] * e[1][2] - e[0][2] * e[1][1], e[0][2] * e[1][0] - e[0][0] * e[1][2],
                           e[0][0] * e[1][1] - e[0][1] * e[1][0]};
        return dot(normal, e[2]) > 0.0;
    };
    std::vector<Triangle> result;
    for (Index a = 0; a < n; ++a)
        for (Index b = a + 1; b < n; ++b)
            for (Index c = a + 1; c < n; ++c) {
                bool face = c != b;
                for (Index d = 0; d < n && face; ++d)
                    face = d == a || d == b || d == c || !outside(a, b, c, d);
                if (face) result.push_back({a, b, c});
            }
    return result;
}

}  // namespace ricci::testing
