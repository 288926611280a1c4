#include "bench/space_deformation.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bench/mesh_variants.h"
#include "bench/random_numbers.h"

namespace ricci::bench {
namespace {

/// A map of space in coordinates in which the surface has diameter about one.
struct Deformation {
    Frame frame{};
    Point stretch{};                        // logarithms
    double taper = 0, twist = 0, bend = 0;  // per unit of the first coordinate
    std::array<Point, 4> wave_vector{}, wave_direction{};
    std::array<double, 4> wave_phase{};
};

Deformation random_deformation(std::uint64_t seed) {
    RandomNumbers random(seed);
    Deformation d;
    d.frame = random_frame(random);
    for (double& s : d.stretch) s = random.uniform(-0.8, 0.8);
    d.taper = random.uniform(-0.9, 0.9);
    d.twist = random.uniform(-1.6, 1.6);
    d.bend = random.uniform(-1.4, 1.4);
    for (std::size_t w = 0; w < d.wave_vector.size(); ++w) {
        const double number = random.uniform(0.5, 1.5) * 2.0 * std::numbers::pi;
        const Point direction = random.direction();
        d.wave_vector[w] = {number * direction[0], number * direction[1], number * direction[2]};
        d.wave_direction[w] = random.direction();
        d.wave_phase[w] = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
    return d;
}

/// Along the first axis, arcs of curvature `bend` in the plane of the first two.
Point bent(const Point& p, double bend) {
    if (std::abs(bend) < 1e-9) return p;
    const double angle = bend * p[0], radius = 1.0 / bend - p[1];
    return {radius * std::sin(angle), 1.0 / bend - radius * std::cos(angle), p[2]};
}

Point image(const Deformation& d, double strength, const Point& p) {
    Point q{};
    for (std::size_t k = 0; k < 3; ++k) q[k] = std::exp(strength * d.stretch[k]) * dot(d.frame[k], p);
    const double width = std::exp(strength * d.taper * q[0]), angle = strength * d.twist * q[0];
    const double c = std::cos(angle), s = std::sin(angle);
    q = bent({q[0], width * (c * q[1] - s * q[2]), width * (s * q[1] + c * q[2])}, strength * d.bend);
    Point moved = q;
    for (std::size_t w = 0; w < d.wave_vector.size(); ++w) {
        // Amplitude by wave length: the derivative is at most 0.12 per wave.
        const double amplitude = 0.12 * strength / std::sqrt(dot(d.wave_vector[w], d.wave_vector[w]));
        moved = plus(moved, d.wave_direction[w],
                     amplitude * std::sin(dot(d.wave_vector[w], q) + d.wave_phase[w]));
    }
    return moved;
}

void measure_stretch(const SurfaceMesh& before, DeformedMesh& after) {
    std::vector<double> ratio;
    for (std::size_t h = 0; h < before.edge_length.size(); ++h)
        ratio.push_back(after.mesh.edge_length[h] / before.edge_length[h]);
    double mean = 0.0;
    for (const double r : ratio) mean += r / static_cast<double>(ratio.size());
    after.largest_stretch = *std::max_element(ratio.begin(), ratio.end()) / mean;
    after.smallest_stretch = *std::min_element(ratio.begin(), ratio.end()) / mean;
}

}  // namespace

DeformedMesh deform_space(const SurfaceMesh& mesh, double strength, std::uint64_t seed) {
    const Deformation deformation = random_deformation(seed);
    const Box box = bounding_box(mesh);
    const double angle_before = smallest_angle(mesh);
    constexpr int kTries = 14;  // 0.8^14 < 1/20
    double tried = strength;
    for (int k = 0; k < kTries; ++k, tried *= 0.8) {
        std::vector<Point> points = mesh.points;
        for (Point& p : points) {
            Point q = plus(p, box.middle, -1.0);
            for (double& x : q) x /= box.diagonal;
            p = image(deformation, tried, q);
        }
        DeformedMesh result{make_surface_mesh(std::move(points), triangles_of(mesh.connectivity)), tried, 0.0,
                            0.0};
        measure_stretch(mesh, result);
        const bool sound = smallest_angle(result.mesh) >= angle_before / 3.0 &&
                           result.largest_stretch <= 6.0 && result.smallest_stretch >= 1.0 / 6.0;
        if (sound) return result;
    }
    throw std::runtime_error("deform_space: no strength keeps the triangles sound");
}

}  // namespace ricci::bench
