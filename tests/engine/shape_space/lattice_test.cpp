#include "engine/shape_space/lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;
using testing::structure_of;
using Complex64 = std::complex<double>;

Complex64 combine(const LatticeCoefficients& c, Complex64 a, Complex64 b) {
    return static_cast<double>(c[0]) * a + static_cast<double>(c[1]) * b;
}

/// Defining properties of a reduced basis, against the generators it came from.
void expect_reduced(const Lattice& lattice, Complex64 a, Complex64 b, double tolerance) {
    const auto& p = lattice.first_coefficients;
    const auto& q = lattice.second_coefficients;
    EXPECT_EQ(std::abs(p[0] * q[1] - p[1] * q[0]), 1);
    EXPECT_LE(std::abs(combine(p, a, b) - lattice.first), tolerance * std::abs(lattice.first));
    EXPECT_LE(std::abs(combine(q, a, b) - lattice.second), tolerance * std::abs(lattice.second));
    const Complex64 tau = lattice.modulus;
    EXPECT_LE(std::abs(lattice.second / lattice.first - tau), 2 * kLatticeTie);
    EXPECT_LE(std::abs(tau.real()), 0.5);
    EXPECT_GT(tau.real(), -0.5);
    EXPECT_GE(std::abs(tau), 1.0 - 1e-15);
    EXPECT_GT(tau.imag(), 0.0);
    EXPECT_TRUE(p[0] > 0 || (p[0] == 0 && p[1] > 0));
    EXPECT_DOUBLE_EQ(lattice.length_ratio, std::abs(tau));
    EXPECT_NEAR(std::abs(lattice.length_ratio * std::polar(1.0, lattice.angle) - tau), 0.0,
                1e-14 * std::abs(tau));
}

/// A generator pair of the lattice 1, tau, turned, scaled and hidden behind a random unimodular matrix.
struct Hidden {
    Complex64 a, b;
};
Hidden hide(Complex64 tau, Random& random, int rounds) {
    std::int64_t m[4] = {1, 0, 0, 1};
    for (int k = 0; k < rounds; ++k) {
        const std::int64_t by = random.below(std::int64_t{5}) - 2;
        const std::size_t row = k % 2 == 0 ? 0 : 2;
        m[row] += by * m[2 - row];
        m[row + 1] += by * m[3 - row];
    }
    const Complex64 scale = std::polar(random.uniform(0.1, 10.0), random.uniform(0.0, 7.0));
    return {scale * combine({m[0], m[1]}, 1.0, tau), scale * combine({m[2], m[3]}, 1.0, tau)};
}

TEST(Lattice, ReducesWhateverBasisItIsGiven) {
    Random random(1);
    for (int trial = 0; trial < 400; ++trial) {
        const double x = random.uniform(-0.49, 0.49), y = std::sqrt(1 - x * x) + random.uniform(0.01, 3.0);
        const Hidden h = hide({x, y}, random, 8);
        for (const bool swapped : {false, true}) {
            const Complex64 a = swapped ? h.b : h.a, b = swapped ? h.a : h.b;
            const Lattice lattice = reduce_lattice(a, b);
            // Coefficients reach some thousand: so many roundings of a generator.
            expect_reduced(lattice, a, b, 1e-11);
            EXPECT_LE(std::abs(lattice.modulus - Complex64(x, y)), 1e-9);
        }
    }
}

TEST(Lattice, TiesGoToTheRightSideWhateverTheRounding) {
    const double root = std::sqrt(3.0) / 2;
    const std::vector<std::pair<Complex64, Complex64>> cases = {
        {{-0.5, 2.0}, {0.5, 2.0}},    {{0.5, 2.0}, {0.5, 2.0}},      {{0.5, root}, {0.5, root}},
        {{-0.5, root}, {0.5, root}},  {{-0.28, 0.96}, {0.28, 0.96}},  // |tau| = 1
        {{0.28, 0.96}, {0.28, 0.96}}, {{0.0, 1.0}, {0.0, 1.0}},
    };
    Random random(2);
    for (const auto& [tau, expected] : cases)
        for (int trial = 0; trial < 200; ++trial) {
            const Complex64 noisy =
                tau + Complex64(random.uniform(-1e-10, 1e-10), random.uniform(-1e-10, 1e-10));
            const Hidden h = hide(noisy, random, 4);
            const Lattice lattice = reduce_lattice(h.a, h.b);
            EXPECT_LE(std::abs(lattice.modulus - expected), 1e-9) << tau;
            if (std::abs(expected.real()) == 0.5) {
                EXPECT_EQ(lattice.modulus.real(), 0.5);
            }
            if (std::abs(expected) < 1.0 + 1e-12) {
                EXPECT_NEAR(std::abs(lattice.modulus), 1.0, 1e-15);
            }
        }
    // Beyond the tolerance the side is what it is.
    EXPECT_NEAR(reduce_lattice(1.0, {-0.499, 2.0}).modulus.real(), -0.499, 1e-12);
}

TEST(Lattice, AMirrorImageHasMinusTheConjugate) {
    Random random(3);
    for (int trial = 0; trial < 100; ++trial) {
        const Hidden h = hide({random.uniform(-0.49, 0.49), random.uniform(1.1, 4.0)}, random, 6);
        const Complex64 tau = reduce_lattice(h.a, h.b).modulus,
                        mirror = reduce_lattice(std::conj(h.a), std::conj(h.b)).modulus;
        EXPECT_LE(std::abs(mirror + std::conj(tau)), 1e-10);
    }
}

TEST(Lattice, RefusesWhatSpansNone) {
    EXPECT_THROW(reduce_lattice(1.0, 2.0), std::invalid_argument);
    EXPECT_THROW(reduce_lattice(0.0, {0.0, 1.0}), std::invalid_argument);
    EXPECT_THROW(reduce_lattice(1.0, {std::nan(""), 1.0}), std::invalid_argument);
    EXPECT_THROW(reduce_lattice({1.0, 1e-17}, {1e9, 1e-9}), std::invalid_argument);
    EXPECT_THROW(torus_lattice(SurfaceGroup{}), std::invalid_argument);
    const Lattice square = reduce_lattice(1.0, {0.0, 1.0});
    EXPECT_THROW(lattice_spectrum(square, 0.0), std::invalid_argument);
    EXPECT_THROW(lattice_spectrum(square, std::numeric_limits<double>::infinity()), std::invalid_argument);
    EXPECT_THROW(lattice_spectrum(square, 1.0, -1), std::invalid_argument);
    EXPECT_THROW(lattice_spectrum(square, 1e5), std::invalid_argument);
}

TEST(Lattice, SpectrumIsThatOfBruteForce) {
    Random random(4);
    for (int trial = 0; trial < 40; ++trial) {
        const Hidden h = hide({random.uniform(-0.5, 0.5), random.uniform(1.0, 5.0)}, random, 4);
        const Lattice lattice = reduce_lattice(h.a, h.b);
        const LatticeSpectrum spectrum = lattice_spectrum(lattice, 9.3);
        EXPECT_EQ(spectrum.complete_up_to, 9.3);
        std::vector<double> expected;
        for (std::int64_t n = -30; n <= 30; ++n)
            for (std::int64_t m = -30; m <= 30; ++m) {
                const double length = std::abs(combine({m, n}, 1.0, lattice.modulus));
                if ((m > 0 || (m == 0 && n > 0)) && length <= 9.3) expected.push_back(length);
            }
        std::sort(expected.begin(), expected.end());
        ASSERT_EQ(spectrum.lengths.size(), expected.size());
        std::map<LatticeCoefficients, int> seen;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            const LatticeLength& entry = spectrum.lengths[k];
            EXPECT_NEAR(entry.length, expected[k], 1e-12);
            EXPECT_GE(entry.length, spectrum.lengths[k == 0 ? 0 : k - 1].length);
            // The coefficients are those of the generators that came in.
            EXPECT_NEAR(std::abs(combine(entry.coefficients, h.a, h.b)) / std::abs(lattice.first),
                        entry.length, 1e-11);
            EXPECT_EQ(entry.power, std::gcd(entry.coefficients[0], entry.coefficients[1]));
            EXPECT_EQ(entry.primitive(), entry.power == 1);
            EXPECT_TRUE(entry.coefficients[0] > 0 ||
                        (entry.coefficients[0] == 0 && entry.coefficients[1] > 0));
            EXPECT_EQ(++seen[entry.coefficients], 1);
        }
    }
}

TEST(Lattice, MultiplicitiesOfSquareAndHexagon) {
    // Representations of 1, 2, 4, 5, 8, 9, 10, 13, 16, 17, 18, 20, 25 by x^2 + y^2, of 1, 3, 4, 7, 9 by x^2 +
    // xy + y^2, up to sign.
    const auto multiplets = [](const LatticeSpectrum& s) {
        std::vector<std::int64_t> result;
        for (std::size_t k = 0; k < s.lengths.size();
             k += static_cast<std::size_t>(s.lengths[k].multiplicity))
            result.push_back(s.lengths[k].multiplicity);
        return result;
    };
    const Lattice square = reduce_lattice({3.0, 1.0}, {-1.0, 3.0});
    EXPECT_EQ(multiplets(lattice_spectrum(square, 5.0)),
              (std::vector<std::int64_t>{2, 2, 2, 4, 2, 2, 4, 4, 2, 4, 2, 4, 6}));
    const Lattice hexagon = reduce_lattice(1.0, std::polar(1.0, std::numbers::pi / 3));
    EXPECT_EQ(multiplets(lattice_spectrum(hexagon, 3.0)), (std::vector<std::int64_t>{3, 3, 3, 6, 3}));
    // A count in the middle of a multiplet completes it.
    const LatticeSpectrum five = lattice_spectrum(hexagon, 0.0, 10);
    EXPECT_EQ(five.lengths.size(), 15U);
    EXPECT_NEAR(five.complete_up_to, std::sqrt(7.0), 1e-12);
    EXPECT_EQ(lattice_spectrum(hexagon, 0.0, 9).lengths.size(), 9U);
}

TEST(Lattice, CountsReachFarOnLongAndOnRoundTori) {
    for (const double height : {1.0, 9.5, 3e4})
        for (const std::int64_t count : {1, 7, 500, 20000}) {
            const Lattice lattice = reduce_lattice(1.0, {0.3, height});
            const LatticeSpectrum spectrum = lattice_spectrum(lattice, 0.0, count);
            EXPECT_GE(static_cast<std::int64_t>(spectrum.lengths.size()), count);
            EXPECT_LE(static_cast<std::int64_t>(spectrum.lengths.size()), count + 24);
            EXPECT_EQ(spectrum.lengths.size(),
                      lattice_spectrum(lattice, spectrum.complete_up_to).lengths.size());
        }
}

TEST(Lattice, WordsAreProductsOfPowers) {
    EXPECT_EQ(lattice_word({2, -1}), (Word{1, 1, -2}));
    EXPECT_EQ(lattice_word({0, 3}), (Word{2, 2, 2}));
    EXPECT_EQ(lattice_word({0, 0}), Word{});
}

SurfaceMesh revolution(Index faces, double jitter = 0.0) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    options.seed = 7;
    return generate("torus", options);
}

TEST(Lattice, TorusOfRevolutionConvergesInSecondOrder) {
    // tau = i sqrt(5.25), so 1, 2, 2.29129, 2.5, 2.5, 3, 3.04138, 3.04138.
    const double y = std::sqrt(5.25);
    const std::vector<double> exact = {1, 2, y, 2.5, 2.5, 3, std::hypot(2.0, y), std::hypot(2.0, y)};
    for (const double jitter : {0.0, 0.3}) {
        std::vector<double> error;
        for (const Index faces : {1000, 4000, 16000}) {
            const SurfaceStructure s = structure_of(revolution(faces, jitter));
            const LatticeSpectrum spectrum = lattice_spectrum(torus_lattice(s.group), 0.0, 8);
            ASSERT_EQ(spectrum.lengths.size(), 8U);
            double worst = 0.0;
            for (std::size_t k = 0; k < 8; ++k)
                worst = std::max(worst, std::abs(spectrum.lengths[k].length - exact[k]));
            error.push_back(worst);
        }
        EXPECT_LT(error[2], 2e-3) << jitter;
        EXPECT_NEAR(0.5 * std::log2(error[0] / error[2]), 2.0, jitter == 0.0 ? 0.1 : 0.4) << jitter;
    }
}

TEST(Lattice, CoefficientsAreThoseOfTheCanonicalGenerators) {
    const SurfaceStructure s = structure_of(testing::bumpy_torus(14, 9, 0.2, 5));
    const Lattice lattice = torus_lattice(s.group);
    expect_reduced(lattice, translation_of(s.group.generators[0].element),
                   translation_of(s.group.generators[1].element), 1e-9);
    for (const LatticeLength& entry : lattice_spectrum(lattice, 4.0).lengths) {
        Isometry<double> element;
        for (const Index letter : lattice_word(entry.coefficients)) {
            const Isometry<double>& g = s.group.generators[at(generator_of(letter))].element;
            element = compose(0, element, letter > 0 ? g : inverse(g));
        }
        EXPECT_NEAR(std::abs(translation_of(element)), entry.length * std::abs(lattice.first), 1e-9);
    }
    // The flat torus has area 1.
    EXPECT_NEAR((std::conj(lattice.first) * lattice.second).imag(), 1.0, 1e-9);
}

SurfaceMesh mirrored(const SurfaceMesh& mesh) {
    std::vector<Triangle> triangles = triangles_of(mesh.connectivity);
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
    return make_surface_mesh(mesh.points, triangles);
}

Complex64 modulus_of(const SurfaceMesh& mesh, bool delaunay = true) {
    StructureOptions options;
    options.flow.tolerance = 1e-12;
    options.flow.delaunay = delaunay;
    return torus_lattice(structure_of(mesh, options).group).modulus;
}

TEST(Lattice, ModulusIsConformallyInvariant) {
    const SurfaceMesh mesh = testing::bumpy_torus(16, 11, 0.15, 8);
    const Complex64 tau = modulus_of(mesh);
    ASSERT_GT(std::abs(tau.real()), 1e-4);  // not symmetric: a mirror image differs
    // Rounding of a metric that is flat to 1e-12.
    EXPECT_LE(std::abs(modulus_of(mirrored(mesh)) + std::conj(tau)), 1e-9);
    SurfaceMesh scaled = mesh;
    for (Point& p : scaled.points)
        for (double& x : p) x *= 1234.5;
    EXPECT_LE(std::abs(modulus_of(make_surface_mesh(scaled.points, triangles_of(mesh.connectivity))) - tau),
              1e-9);
    Random random(6);
    const SurfaceMesh other =
        testing::relabelled(mesh, random.permutation(mesh.connectivity.vertex_count), random);
    EXPECT_LE(std::abs(modulus_of(other) - tau), 1e-9);
    // The same flat surface with other edges.
    EXPECT_LE(std::abs(modulus_of(testing::scrambled(mesh, 400, 3)) - tau), 1e-9);
}

/// A torus of revolution in staggered rows: all triangles are acute, so all edges are Delaunay by a margin.
SurfaceMesh staggered_torus(Index n, Index rows) {
    std::vector<Point> points;
    std::vector<Triangle> triangles;
    const auto vertex = [&](Index i, Index j) { return (j % rows) * n + i % n; };
    for (Index j = 0; j < rows; ++j)
        for (Index i = 0; i < n; ++i) {
            const double u = 2 * std::numbers::pi * (i + (j % 2) / 2.0) / n,
                         v = 2 * std::numbers::pi * j / rows;
            points.push_back(
                {(2.5 + std::cos(v)) * std::cos(u), (2.5 + std::cos(v)) * std::sin(u), std::sin(v)});
            const Index above = i + j % 2;  // the vertex above, between i and i + 1, is i or i + 1
            triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(above, j + 1)});
            triangles.push_back({vertex(i + 1, j), vertex(above + 1, j + 1), vertex(above, j + 1)});
        }
    return make_surface_mesh(std::move(points), triangles);
}

TEST(Lattice, AMoebiusInversionChangesNothing) {
    const SurfaceMesh mesh = testing::bumpy_torus(16, 11, 0.15, 8);
    for (const Point& centre : {Point{3.5, 1.0, 2.0}, Point{0.1, 0.2, -0.3}})
        EXPECT_LE(std::abs(modulus_of(testing::inverted(mesh, centre), false) - modulus_of(mesh, false)),
                  1e-8);
    // With Delaunay flips where both meshes are Delaunay: from afar an inversion is nearly a similarity.
    const SurfaceMesh round = staggered_torus(60, 20);
    const SurfaceMesh other = testing::inverted(round, {11.0, 4.0, 7.0});
    for (const SurfaceMesh* m : {&round, &other})
        ASSERT_EQ(count_non_delaunay(intrinsic_triangulation<double>(*m), {}), 0);
    EXPECT_LE(std::abs(modulus_of(other) - modulus_of(round)), 1e-8);
}

TEST(Lattice, IntrinsicTorusOfOneVertexIsExact) {
    // Sides 1, 1.3, 2.2: b = 1.3 e^(i angle) with |1 + b| = 2.2 or the mirror image's.
    const double cosine = (2.2 * 2.2 - 1.0 - 1.3 * 1.3) / (2 * 1.3);
    const Complex64 b = 1.3 * Complex64(cosine, std::sqrt(1 - cosine * cosine));
    const Complex64 expected = reduce_lattice(1.0, b).modulus,
                    tau = modulus_of(testing::intrinsic_mesh(testing::one_vertex_torus(1.0L, 1.3L, 2.2L)));
    EXPECT_LE(std::min(std::abs(tau - expected), std::abs(tau + std::conj(expected))), 1e-14);
}

TEST(Lattice, KittenIsThatOfTheThesis) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g1/kitten.obj");
    const Lattice lattice = torus_lattice(structure_of(testing::load_component(path)).group);
    const std::vector<double> table = {1.0000, 2.0000, 2.1716, 2.3889, 2.3926, 2.9493, 2.9552, 2.9999};
    const LatticeSpectrum spectrum = lattice_spectrum(lattice, 0.0, 8);
    ASSERT_EQ(spectrum.lengths.size(), table.size());
    for (std::size_t k = 0; k < table.size(); ++k)
        EXPECT_NEAR(spectrum.lengths[k].length, table[k], 0.005 * table[k]);
}

}  // namespace
}  // namespace ricci
