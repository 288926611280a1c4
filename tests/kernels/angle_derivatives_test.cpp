// Derivatives of corner angles against central differences, for every geometry and every scheme.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "kernels/face_kernels.h"
#include "tests/support/random.h"

namespace ricci {
namespace {

using testing::Random;

/// One triangle under a scheme: vertices 0, 1, 2.
struct PackedTriangle {
    std::vector<Index> tail = {0, 1, 2};
    std::vector<double> eta, eps, u;

    [[nodiscard]] PackedCircles view() const { return {tail, eta, eps, u}; }
};

struct Derivatives {
    std::array<double, 3> angle, off, diagonal;
    std::int64_t broken;
};

Derivatives evaluate(Geometry geometry, const PackedTriangle& t) {
    std::vector<double> angle(3), off(3), diagonal(3);
    Derivatives d{};
    d.broken = evaluate_faces(geometry, t.view(), {angle, off, diagonal, {}}, false);
    for (std::size_t k = 0; k < 3; ++k) {
        d.angle[k] = angle[k];
        d.off[k] = off[k];
        d.diagonal[k] = diagonal[k];
    }
    return d;
}

struct SchemeCase {
    const char* name;
    double eps, eta_low, eta_high;
};

// Vertex scaling takes eta = lambda^2/2 (plane) or lambda^2/8: chords between 0.45 and 0.77 here.
constexpr std::array kSchemes = {
    SchemeCase{"vertex scaling", 0, 0.1, 0.3},
    SchemeCase{"tangential", 1, 1, 1},
    SchemeCase{"Thurston", 1, 0, 1},
    SchemeCase{"inversive distance", 1, 1, 1.6},
    SchemeCase{"virtual radius", -1, 1.5, 2.0},
};
constexpr std::array kGeometries = {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical};

PackedTriangle random_triangle(const SchemeCase& scheme, Geometry geometry, Random& random) {
    PackedTriangle t;
    for (int k = 0; k < 3; ++k) {
        t.eta.push_back(random.uniform(scheme.eta_low, scheme.eta_high));
        t.eps.push_back(scheme.eps);
        // Curved geometries: radii around 0.2, well below the pole of the formulas at u = 0.
        t.u.push_back(geometry == Geometry::euclidean || scheme.eps == 0 ? random.uniform(-0.3, 0.3)
                                                                         : random.uniform(-2.2, -1.6));
    }
    return t;
}

/// Compares derivatives with central differences. Returns false where the triangle is broken.
bool check_triangle(Geometry geometry, PackedTriangle t, const std::string& what) {
    const Derivatives d = evaluate(geometry, t);
    if (d.broken != 0) return false;
    for (const double a : d.angle)
        if (a < 0.15 || a > 2.8)
            return false;  // near-degenerate: differences would not resolve the third derivative
    const double step = 1e-4;
    for (std::size_t j = 0; j < 3; ++j) {
        const double u = t.u[j];
        t.u[j] = u + step;
        const Derivatives up = evaluate(geometry, t);
        t.u[j] = u - step;
        const Derivatives down = evaluate(geometry, t);
        t.u[j] = u;
        for (std::size_t i = 0; i < 3; ++i) {
            const double difference = (up.angle[i] - down.angle[i]) / (2 * step);
            // Halfedge k joins corners k and k+1: off[k] is both d theta_k/d u_{k+1} and d theta_{k+1}/d u_k.
            const double exact = i == j ? d.diagonal[i] : d.off[(i + 1) % 3 == j ? i : j];
            // step^2/6 times a third derivative below 2000, and eps/step = 2e-12.
            EXPECT_NEAR(exact, difference, 4e-6 * (1 + std::abs(exact)))
                << what << ": d theta_" << i << " / d u_" << j;
        }
    }
    return true;
}

TEST(AngleDerivatives, AgreeWithDifferencesForEveryGeometryAndScheme) {
    Random random(2);
    for (const Geometry geometry : kGeometries)
        for (const SchemeCase& scheme : kSchemes) {
            int tested = 0;
            for (int trial = 0; trial < 200; ++trial)
                tested += check_triangle(geometry, random_triangle(scheme, geometry, random),
                                         std::string(name_of(geometry)) + ", " + scheme.name)
                              ? 1
                              : 0;
            EXPECT_GT(tested, 60) << name_of(geometry) << ' ' << scheme.name;
        }
}

TEST(AngleDerivatives, SchemesMayDifferFromVertexToVertex) {
    Random random(3);
    int tested = 0;
    for (int trial = 0; trial < 300; ++trial)
        for (const Geometry geometry : kGeometries) {
            PackedTriangle t = random_triangle({"mixed", 1, 1.2, 1.6}, geometry, random);
            t.eps = {1.0, 0.0, -1.0};
            tested += check_triangle(geometry, t, "mixed") ? 1 : 0;
        }
    EXPECT_GT(tested, 100);
}

TEST(AngleDerivatives, RowsOfAEuclideanTriangleSumToZero) {
    Random random(4);
    for (const SchemeCase& scheme : kSchemes)
        for (int trial = 0; trial < 100; ++trial) {
            const Derivatives d =
                evaluate(Geometry::euclidean, random_triangle(scheme, Geometry::euclidean, random));
            if (d.broken != 0) continue;
            for (std::size_t i = 0; i < 3; ++i) {
                const double size =
                    std::abs(d.off[i]) + std::abs(d.off[(i + 2) % 3]) + std::abs(d.diagonal[i]);
                // Scaling all circles changes no angle. Cancellation in the angle's own rounding: sizes up to
                // 1e3.
                EXPECT_NEAR(d.diagonal[i] + d.off[i] + d.off[(i + 2) % 3], 0.0, 1e-13 * (1 + size * size))
                    << scheme.name;
            }
        }
}

TEST(AngleDerivatives, EuclideanVertexScalingIsHalfTheCotangent) {
    Random random(5);
    for (int trial = 0; trial < 200; ++trial) {
        const std::vector<Index> tail = {0, 1, 2};
        const std::vector<double> log_chord = random.uniforms(3, -0.3, 0.3),
                                  u = random.uniforms(3, -0.02, 0.02);
        std::vector<double> angle(3), off(3), diagonal(3);
        ASSERT_EQ(evaluate_faces<double>(Geometry::euclidean, {tail, log_chord, u},
                                         {angle, off, diagonal, {}}, false),
                  0);
        for (std::size_t k = 0; k < 3; ++k) {
            // Halfedge k lies opposite corner k+2; angles above 0.2 here, so the cotangent amplifies 1e-15
            // by 25.
            EXPECT_NEAR(off[k], 0.5 / std::tan(angle[(k + 2) % 3]), 1e-13);
            EXPECT_NEAR(diagonal[k], -(off[k] + off[(k + 2) % 3]), 1e-13);
        }
    }
}

TEST(AngleDerivatives, VertexScalingIsTheCirclePackingWithEpsilonZero) {
    Random random(6);
    for (const Geometry geometry : kGeometries)
        for (int trial = 0; trial < 100; ++trial) {
            PackedTriangle t = random_triangle(kSchemes[0], geometry, random);
            std::vector<double> log_chord(3);
            for (std::size_t k = 0; k < 3; ++k)
                log_chord[k] = 0.5 * std::log((geometry == Geometry::euclidean ? 2.0 : 8.0) * t.eta[k]);
            std::vector<double> angle(3), off(3), diagonal(3), area(1), packed_area(1);
            const auto broken = evaluate_faces<double>(geometry, {t.tail, log_chord, t.u},
                                                       {angle, off, diagonal, area}, false);
            const Derivatives d = evaluate(geometry, t);
            ASSERT_EQ(broken, d.broken);
            if (broken != 0) continue;
            evaluate_faces(geometry, t.view(), {{}, {}, {}, packed_area}, false);
            EXPECT_NEAR(area[0], packed_area[0], 1e-14);
            for (std::size_t k = 0; k < 3; ++k) {
                // The same function by different roundings; derivatives are up to 1/sin(angle), their
                // condition its square.
                const double condition = 1 / std::pow(std::sin(d.angle[k]), 2) +
                                         std::abs(off[k]) * std::abs(off[k]) + diagonal[k] * diagonal[k];
                EXPECT_NEAR(angle[k], d.angle[k], 1e-14 * (1 + condition));
                EXPECT_NEAR(off[k], d.off[k], 1e-13 * (1 + condition));
                EXPECT_NEAR(diagonal[k], d.diagonal[k], 1e-13 * (1 + condition));
            }
        }
}

/// The length formulas of Zhang et al. 2014, table 1, in long double.
long double printed_length(Geometry geometry, double eta, double ei, double ej, double ui, double uj) {
    const long double a = ei * std::exp(2 * static_cast<long double>(ui)),
                      b = ej * std::exp(2 * static_cast<long double>(uj));
    const long double pair = eta * std::exp(static_cast<long double>(ui) + static_cast<long double>(uj));
    if (geometry == Geometry::hyperbolic)
        return std::acosh((4 * pair + (1 + a) * (1 + b)) / ((1 - a) * (1 - b)));
    if (geometry == Geometry::spherical)
        return std::acos((-4 * pair + (1 - a) * (1 - b)) / ((1 + a) * (1 + b)));
    return std::sqrt(2 * pair + a + b);
}

TEST(PackedEdgeLengths, FollowThePrintedFormulas) {
    Random random(7);
    for (const Geometry geometry : kGeometries)
        for (const SchemeCase& scheme : kSchemes) {
            const PackedTriangle t = random_triangle(scheme, geometry, random);
            std::vector<double> length(3);
            packed_edge_lengths(geometry, t.view(), length);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t j = (k + 1) % 3;
                const long double expected =
                    printed_length(geometry, t.eta[k], t.eps[k], t.eps[j], t.u[k], t.u[j]);
                EXPECT_NEAR(length[k], static_cast<double>(expected), 1e-14)
                    << name_of(geometry) << ' ' << scheme.name;
            }
        }
}

TEST(PackedEdgeLengths, TangentCirclesAddTheirRadii) {
    const double r[] = {0.3, 0.7, 0.5};
    const auto u_of = [](Geometry geometry, double radius) {
        if (geometry == Geometry::hyperbolic) return std::log(std::tanh(radius / 2));
        if (geometry == Geometry::spherical) return std::log(std::tan(radius / 2));
        return std::log(radius);
    };
    for (const Geometry geometry : kGeometries) {
        PackedTriangle t;
        t.eta.assign(3, 1.0);
        t.eps.assign(3, 1.0);
        for (const double radius : r) t.u.push_back(u_of(geometry, radius));
        std::vector<double> length(3);
        packed_edge_lengths(geometry, t.view(), length);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(length[k], r[k] + r[(k + 1) % 3], 4e-15);
        // eta = 0: circles meet at right angles, Pythagoras in each geometry.
        t.eta.assign(3, 0.0);
        packed_edge_lengths(geometry, t.view(), length);
        const double legs[] = {r[0], r[1]};
        const double expected =
            geometry == Geometry::hyperbolic  ? std::acosh(std::cosh(legs[0]) * std::cosh(legs[1]))
            : geometry == Geometry::spherical ? std::acos(std::cos(legs[0]) * std::cos(legs[1]))
                                              : std::hypot(legs[0], legs[1]);
        EXPECT_NEAR(length[0], expected, 4e-15);
    }
}

}  // namespace
}  // namespace ricci
