// Groups whose traces are known to be algebraic integers of a small field.
//
// The equilateral surfaces of the patterns {3,7} and {3,8} have so many symmetries that their hyperbolic
// metric can only be that of Klein's quartic and of Bolza's surface. Their groups are derived from quaternion
// algebras: traces are algebraic integers of the field of the algebra, and all other conjugates of a trace
// lie in [-2, 2] (Takeuchi 1975, A characterization of arithmetic Fuchsian groups).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "engine/surfaces/regular_map.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;
using testing::structure_of;

constexpr double kSlack = 1e-9;

/// Distance of t from the nearest m + n sqrt 2 with |m - n sqrt 2| <= 2, m and n even: cosh of half a length
/// is in Z[sqrt 2] on Bolza's surface (Aurich, Bogomolny, Steiner 1991).
double distance_to_bolza_traces(double t) {
    constexpr double kRoot = std::numbers::sqrt2;
    double nearest = t;
    for (double n = 2 * std::floor((t - 2) / (4 * kRoot)); n <= (t + 2) / (2 * kRoot) + 2; n += 2) {
        const double m = 2 * std::round((t - n * kRoot) / 2);
        if (std::abs(m - n * kRoot) <= 2 + kSlack) nearest = std::min(nearest, std::abs(t - m - n * kRoot));
    }
    return nearest;
}

/// Distance of t from the nearest a + b c + d c^2, c = 2 cos(2 pi / 7), with both conjugates in [-2, 2].
double distance_to_klein_traces(double t) {
    std::array<double, 3> c{};
    for (std::size_t k = 0; k < 3; ++k)
        c[k] = 2 * std::cos(2 * static_cast<double>(k + 1) * std::numbers::pi / 7);
    // t - s_k = (c_0 - c_k) (b + d (c_0 + c_k)) for the conjugates s_k, k = 1, 2.
    const auto conjugate_at = [&](std::size_t k, double a, double b, double d) {
        return a + b * c[k] + d * c[k] * c[k];
    };
    double nearest = t;
    const double low1 = (t - 2) / (c[0] - c[1]), high1 = (t + 2) / (c[0] - c[1]);
    const double low2 = (t - 2) / (c[0] - c[2]), high2 = (t + 2) / (c[0] - c[2]);
    const double spread = c[1] - c[2];
    for (double d = std::floor((low1 - high2) / spread); d <= (high1 - low2) / spread + 1; ++d)
        for (double b = std::floor(low1 - d * (c[0] + c[1])); b <= high1 - d * (c[0] + c[1]) + 1; ++b) {
            const double a = std::round(t - b * c[0] - d * c[0] * c[0]);
            if (std::abs(conjugate_at(1, a, b, d)) > 2 + kSlack ||
                std::abs(conjugate_at(2, a, b, d)) > 2 + kSlack)
                continue;
            nearest = std::min(nearest, std::abs(t - conjugate_at(0, a, b, d)));
        }
    return nearest;
}

/// The canonical generators, and random words of up to four letters of the basis, which are short: in double,
/// a word of long elements that cancel would show the rounding of their product.
std::vector<double> traces_of(const SurfaceGroup& group, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> traces;
    for (const GroupGenerator& g : group.generators) traces.push_back(testing::trace_size(g.element));
    for (int i = 0; i < 200; ++i) {
        Isometry<double> x;
        for (int k = 0; k < 1 + i % 4; ++k) {
            const Isometry<double>& g = group.letters[random.below(group.letters.size())];
            x = compose(-1, x, random.below(2) == 0 ? g : inverse(g));
        }
        traces.push_back(testing::trace_size(x));
    }
    return traces;
}

void expect_arithmetic(const SurfaceMesh& mesh, double systole, double (*distance_to_traces)(double)) {
    const SurfaceStructure s = structure_of(mesh);
    EXPECT_LE(s.group.relator_error, 1e-10);
    std::size_t hyperbolic = 0;
    for (const double t : traces_of(s.group, 1)) {
        // A word of two inverse letters is 1.
        if (std::abs(t - 2) < 1e-6) continue;
        EXPECT_GE(2 * std::acosh(t / 2), systole - 1e-9);
        EXPECT_LE(distance_to_traces(t), kSlack * t) << "trace " << t;
        ++hyperbolic;
    }
    EXPECT_GT(hyperbolic, 100u);
}

const double kBolzaSystole = 2 * std::acosh(1 + std::numbers::sqrt2);  // 3.057142
// 3.935946 = 2 arcosh(tr / 2), tr = 1 + c + c^2 = 3.801938 + ..., c = 2 cos(2 pi / 7) (Vogeler 2003).
constexpr double kKleinSystole = 3.935946;

TEST(ArithmeticGroups, BolzasTracesAreIntegersOfItsField) {
    expect_arithmetic(make_bolza(), kBolzaSystole, distance_to_bolza_traces);
}

TEST(ArithmeticGroups, KleinsTracesAreIntegersOfItsField) {
    expect_arithmetic(make_klein_quartic(), kKleinSystole - 1e-6, distance_to_klein_traces);
}

TEST(ArithmeticGroups, SubdivisionKeepsTheSymmetryAndSoTheGroup) {
    expect_arithmetic(testing::generated("bolza", 256), kBolzaSystole, distance_to_bolza_traces);
    expect_arithmetic(testing::generated("klein-quartic", 56 * 16), kKleinSystole - 1e-6,
                      distance_to_klein_traces);
}

TEST(ArithmeticGroups, OtherTrianglesOfTheSameSurfaceGiveTheSameGroup) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        expect_arithmetic(testing::scrambled(make_bolza(), 200, seed), kBolzaSystole,
                          distance_to_bolza_traces);
        expect_arithmetic(testing::scrambled(make_klein_quartic(), 300, seed), kKleinSystole - 1e-6,
                          distance_to_klein_traces);
    }
}

TEST(ArithmeticGroups, AnotherSurfaceIsNotArithmetic) {
    // Traces of a surface without symmetry miss the ring by more than the tolerance: the test can fail.
    SurfaceMesh mesh = make_bolza();
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h)
        mesh.edge_length[at(h)] *= 1 + 1e-5 * mesh.connectivity.edge[at(h)];
    const SurfaceStructure s = structure_of(mesh);
    std::size_t missed = 0;
    for (const double t : traces_of(s.group, 1)) missed += distance_to_bolza_traces(t) > kSlack * t ? 1 : 0;
    EXPECT_GT(missed, 100u);
}

TEST(ArithmeticGroups, ShortestElementsAttainTheSystole) {
    // Every shortest loop of Bolza's surface is a word of few letters in a basis of short loops.
    const SurfaceStructure s = structure_of(make_bolza());
    double shortest = 1e300;
    std::vector<Isometry<double>> balls{{}};
    for (int length = 0; length < 3; ++length) {
        std::vector<Isometry<double>> next;
        for (const Isometry<double>& x : balls)
            for (const Isometry<double>& g : s.group.letters)
                for (const Isometry<double>& y : {g, inverse(g)}) next.push_back(compose(-1, x, y));
        for (const Isometry<double>& x : next)
            if (testing::trace_size(x) > 2 + 1e-6) shortest = std::min(shortest, testing::trace_size(x));
        balls = std::move(next);
    }
    EXPECT_NEAR(2 * std::acosh(shortest / 2), kBolzaSystole, 1e-10);
}

}  // namespace
}  // namespace ricci
