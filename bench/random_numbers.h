// Random numbers that are the same on every standard library, and the few operations on points that go with
// them.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "kernels/surface_mesh.h"
#include "tests/support/random.h"

namespace ricci::bench {

/// The tests' generator, with what shapes are drawn from.
class RandomNumbers : public testing::Random {
  public:
    using Random::Random;

    /// Standard normal (Box, Muller 1958).
    double normal() {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
        return radius * std::cos(uniform(0.0, 2.0 * std::numbers::pi));
    }
    /// Uniform on the unit sphere.
    Point direction() {
        const double z = uniform(-1.0, 1.0), angle = uniform(0.0, 2.0 * std::numbers::pi);
        const double radius = std::sqrt(1.0 - z * z);
        return {radius * std::cos(angle), radius * std::sin(angle), z};
    }
};

inline Point plus(const Point& a, const Point& b, double factor = 1.0) {
    return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
inline double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Point unit(const Point& a) {
    const double length = std::sqrt(dot(a, a));
    return length > 0.0 ? Point{a[0] / length, a[1] / length, a[2] / length} : a;
}

/// Rows of a rotation drawn from the uniform distribution up to the order of draws.
using Frame = std::array<Point, 3>;
inline Frame random_frame(RandomNumbers& random) {
    const Point first = random.direction();
    Point second = random.direction();
    second = unit(plus(second, first, -dot(first, second)));
    return {first, second, cross(first, second)};
}

}  // namespace ricci::bench
