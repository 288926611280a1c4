// What vectorised blocks must not change: a face's bits depend on the face alone.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "kernels/face_kernels.h"
#include "kernels/intrinsic_triangulation.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;
constexpr std::array kGeometries = {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical};

struct Faces {
    std::vector<Index> tail;
    std::vector<double> log_chord, eta, eps, u;

    [[nodiscard]] std::size_t count() const { return tail.size() / 3; }
    [[nodiscard]] ScaledChords<double> scaled() const { return {tail, log_chord, u}; }
    [[nodiscard]] PackedCircles packed() const { return {tail, eta, eps, u}; }
};

/// Loose triangles over shared vertices; sizes small enough for the sphere.
Faces random_faces(std::size_t faces, Random& random) {
    const Index vertices = 500;
    Faces f;
    for (std::size_t h = 0; h < 3 * faces; ++h) {
        f.tail.push_back(random.below(vertices));
        f.log_chord.push_back(random.uniform(-1.4, -0.9));
        f.eta.push_back(random.uniform(0.5, 1.0));
    }
    f.u = random.uniforms(at(vertices), -1.6, -1.3);
    f.eps.assign(at(vertices), 1.0);
    return f;
}

struct Results {
    std::vector<double> angle, off, diagonal, area;

    explicit Results(std::size_t faces)
        : angle(3 * faces), off(3 * faces), diagonal(3 * faces), area(faces) {}
    FaceFields<double> fields() { return {angle, off, diagonal, area}; }
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

Results evaluate(Geometry geometry, const Faces& faces, bool packed, bool parallel) {
    Results r(faces.count());
    if (packed) {
        evaluate_faces(geometry, faces.packed(), r.fields(), parallel);
    } else {
        evaluate_faces<double>(geometry, faces.scaled(), r.fields(), parallel);
    }
    return r;
}

TEST(FaceKernelBits, DoNotDependOnPositionOrBlock) {
    Random random(1);
    // Neither a multiple of the block (128) nor of the vector width.
    const Faces faces = random_faces(5003, random);
    const auto position = random.permutation(faces.count());
    Faces shuffled = faces;
    for (std::size_t f = 0; f < faces.count(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t to = 3 * position[f] + k;
            shuffled.tail[to] = faces.tail[3 * f + k];
            shuffled.log_chord[to] = faces.log_chord[3 * f + k];
            shuffled.eta[to] = faces.eta[3 * f + k];
        }
    for (const Geometry geometry : kGeometries)
        for (const bool packed : {false, true}) {
            const Results expected = evaluate(geometry, faces, packed, false);
            const Results moved = evaluate(geometry, shuffled, packed, false);
            Results back(faces.count());
            for (std::size_t f = 0; f < faces.count(); ++f) {
                back.area[f] = moved.area[position[f]];
                for (std::size_t k = 0; k < 3; ++k) {
                    back.angle[3 * f + k] = moved.angle[3 * position[f] + k];
                    back.off[3 * f + k] = moved.off[3 * position[f] + k];
                    back.diagonal[3 * f + k] = moved.diagonal[3 * position[f] + k];
                }
            }
            EXPECT_TRUE(same_bits(expected.angle, back.angle)) << name_of(geometry) << packed;
            EXPECT_TRUE(same_bits(expected.off, back.off)) << name_of(geometry) << packed;
            EXPECT_TRUE(same_bits(expected.diagonal, back.diagonal)) << name_of(geometry) << packed;
            EXPECT_TRUE(same_bits(expected.area, back.area)) << name_of(geometry) << packed;
        }
}

TEST(FaceKernelBits, AreTheSameInParallelAndWithOrWithoutDerivatives) {
    Random random(2);
    const Faces faces = random_faces(20011, random);
    for (const Geometry geometry : kGeometries)
        for (const bool packed : {false, true}) {
            const Results serial = evaluate(geometry, faces, packed, false);
            const Results parallel = evaluate(geometry, faces, packed, true);
            EXPECT_TRUE(same_bits(serial.angle, parallel.angle) && same_bits(serial.off, parallel.off) &&
                        same_bits(serial.diagonal, parallel.diagonal) &&
                        same_bits(serial.area, parallel.area))
                << name_of(geometry) << packed;
            // The kernel for angles alone is another instance of the same text.
            std::vector<double> angle(3 * faces.count());
            const FaceFields<double> angles_only{angle, {}, {}, {}};
            if (packed) {
                evaluate_faces(geometry, faces.packed(), angles_only, false);
            } else {
                evaluate_faces<double>(geometry, faces.scaled(), angles_only, false);
            }
            EXPECT_TRUE(same_bits(serial.angle, angle)) << name_of(geometry) << packed;
        }
}

TEST(FaceKernelBits, DoubleAgreesWithLongDoubleToRounding) {
    Random random(3);
    const Faces faces = random_faces(4000, random);
    const std::vector<long double> log_chord(faces.log_chord.begin(), faces.log_chord.end());
    std::vector<long double> angle(3 * faces.count()), area(faces.count());
    std::vector<double> off(3 * faces.count()), diagonal(3 * faces.count());
    for (const Geometry geometry : kGeometries) {
        const auto broken = evaluate_faces<long double>(geometry, {faces.tail, log_chord, faces.u},
                                                        {angle, off, diagonal, area}, false);
        ASSERT_EQ(broken, 0);
        const Results r = evaluate(geometry, faces, false, false);
        constexpr double eps = std::numeric_limits<double>::epsilon();
        for (std::size_t h = 0; h < angle.size(); ++h) {
            const std::size_t f = 3 * (h / 3);
            long double cotangents = 1;
            for (std::size_t k = f; k < f + 3; ++k) cotangents += std::abs(1 / std::tan(angle[k]));
            // Chords: sums of logarithms up to 3 (3 ulp) and the vector library's exp (4 ulp); the formula:
            // about 20 roundings. An angle moves by at most the sum of cotangents times the relative change
            // of the chords.
            const double bound = 30 * eps * 2 * static_cast<double>(cotangents);
            ASSERT_NEAR(static_cast<double>(r.angle[h] - angle[h]), 0.0, bound) << name_of(geometry);
            // Cotangents move by 1 + cot^2 times as much as the angles.
            const double slope = 1 + 4 * off[h] * off[h] + diagonal[h] * diagonal[h] +
                                 static_cast<double>(cotangents * cotangents);
            ASSERT_NEAR(r.off[h], off[h], bound * slope) << name_of(geometry);
            ASSERT_NEAR(r.diagonal[h], diagonal[h], bound * slope) << name_of(geometry);
            ASSERT_NEAR(static_cast<double>(r.area[h / 3] - area[h / 3]), 0.0, bound) << name_of(geometry);
        }
    }
}

TEST(FaceKernels, RelabellingVerticesPermutesCurvature) {
    const SurfaceMesh mesh = testing::bumpy_torus(9, 7);
    Random random(4);
    const auto number = random.permutation(mesh.connectivity.vertex_count);
    const SurfaceMesh other = testing::relabelled(mesh, number, random);
    for (const Geometry geometry : kGeometries) {
        const auto angle_sums = [&](const SurfaceMesh& m, const std::vector<double>& u) {
            const auto t = intrinsic_triangulation<double>(m);
            std::vector<double> angle(t.log_chord.size()), total(u.size());
            EXPECT_EQ(evaluate_faces<double>(geometry, {t.connectivity.tail, t.log_chord, u},
                                             {angle, {}, {}, {}}, false),
                      0);
            sum_corners<double>(t.connectivity.tail, angle, total);
            return total;
        };
        const std::vector<double> u = random.uniforms(at(mesh.connectivity.vertex_count), -1.0, -0.9);
        std::vector<double> moved_u(u.size());
        for (std::size_t v = 0; v < u.size(); ++v) moved_u[at(number[v])] = u[v];
        const auto expected = angle_sums(mesh, u), moved = angle_sums(other, moved_u);
        // Rotated faces and sums in another order: 6 angles, each within some 50 eps.
        for (std::size_t v = 0; v < u.size(); ++v) EXPECT_NEAR(moved[at(number[v])], expected[v], 1e-13);
    }
}

}  // namespace
}  // namespace ricci
