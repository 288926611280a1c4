#include "engine/surfaces/jitter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// SplitMix64 (Steele, Lea, Flood 2014), as a number in [0, 1).
class RandomUnit {
  public:
    explicit RandomUnit(std::uint64_t seed) : state_(seed) {}
    double operator()() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
    }

  private:
    std::uint64_t state_;
};

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length(const Point& a) {
    return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

Point scaled(const Point& a, double factor) {
    return {factor * a[0], factor * a[1], factor * a[2]};
}

/// Two orthonormal vectors orthogonal to a direction.
std::pair<Point, Point> tangent_frame(const Point& direction) {
    const Point normal = scaled(direction, 1.0 / length(direction));
    // The axis least aligned with the normal.
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (std::abs(normal[k]) < std::abs(normal[axis])) axis = k;
    }
    Point unit = {0.0, 0.0, 0.0};
    unit[axis] = 1.0;
    Point first = cross(normal, unit);
    first = scaled(first, 1.0 / length(first));
    return {first, cross(normal, first)};
}

}  // namespace

SurfaceMesh jitter_surface(const SurfaceMesh& mesh, double fraction, std::uint64_t seed) {
    constexpr double kLargestFraction = 0.45;
    if (mesh.intrinsic()) throw std::invalid_argument("generate: an intrinsic surface cannot be jittered");
    if (!(fraction >= 0.0 && fraction <= kLargestFraction)) {
        throw std::invalid_argument("generate: jitter must lie in [0, 0.45]");
    }
    const std::vector<Triangle> triangles = triangles_of(mesh.connectivity);
    std::vector<Point> normal(mesh.points.size(), Point{0.0, 0.0, 0.0});
    std::vector<double> reach(mesh.points.size(), std::numeric_limits<double>::infinity());
    for (const Triangle& t : triangles) {
        std::array<Point, 3> side{};
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t k = 0; k < 3; ++k) {
                side[c][k] = mesh.points[at(t[(c + 1) % 3])][k] - mesh.points[at(t[c])][k];
            }
        }
        const Point area = cross(side[0], side[1]);
        const double altitude = length(area) / std::max({length(side[0]), length(side[1]), length(side[2])});
        for (const Index v : t) {
            for (std::size_t k = 0; k < 3; ++k) normal[at(v)][k] += area[k];
            reach[at(v)] = std::min(reach[at(v)], altitude);
        }
    }
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(mesh.connectivity);
    std::vector<Point> points = mesh.points;
    RandomUnit random(seed);
    for (std::size_t v = 0; v < points.size(); ++v) {
        const double radius = fraction * reach[v] * std::sqrt(random());
        const double angle = 2.0 * std::numbers::pi * random();
        if (on_boundary[v] != 0) continue;
        const auto [first, second] = tangent_frame(normal[v]);
        for (std::size_t k = 0; k < 3; ++k) {
            points[v][k] += radius * (std::cos(angle) * first[k] + std::sin(angle) * second[k]);
        }
    }
    return make_surface_mesh(std::move(points), triangles);
}

}  // namespace ricci
