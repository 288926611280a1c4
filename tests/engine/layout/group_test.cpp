// Deck transformation groups: exact ones, invariances, closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "engine/surfaces/regular_map.h"
#include "kernels/delaunay.h"
#include "tests/engine/layout/structure_samples.h"
#include "tests/support/flat_torus.h"

namespace ricci {
namespace {

using namespace ricci::testing;
using std::numbers::pi;

/// Random words of up to four letters, none trivial for certain, and their traces.
std::vector<double> sample_traces(const SurfaceGroup& group, int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> traces;
    for (int k = 0; k < count; ++k) {
        Word word;
        for (Index n = 1 + random.below(Index{4}); n > 0; --n) {
            const Index letter = 1 + random.below(static_cast<Index>(group.letters.size()));
            word.push_back(random.below(2) == 0 ? letter : -letter);
        }
        if (!reduced(word).empty()) traces.push_back(trace(product_of(group, reduced(word))));
    }
    return traces;
}

TEST(ExactGroups, TracesOfBolzaAreIntegersOfItsField) {
    // The group is arithmetic over Q(sqrt 2): a trace is m + n sqrt 2 with m - n sqrt 2 in [-2, 2].
    const SurfaceMesh mesh = make_bolza();
    const SurfaceStructure s = structure_of(mesh);
    EXPECT_LE(s.group.relator_error, 1e-10);
    const double root = std::numbers::sqrt2;
    double least = 1e300;
    for (const double t : sample_traces(s.group, 300, 11)) {
        double best = 1e300;
        const auto middle = std::lround(t / (2 * root));  // n is within 2 / (2 sqrt 2) of it
        for (long n = middle - 2; n <= middle + 2; ++n) {
            const double m = std::round(t - static_cast<double>(n) * root);
            if (std::abs(m - static_cast<double>(n) * root) > 2 + 1e-6) continue;
            best = std::min(best, std::abs(m + static_cast<double>(n) * root - t));
        }
        EXPECT_LE(best, 1e-9 * std::max(1.0, t)) << t;
        if (t > 2 + 1e-6) least = std::min(least, t);
    }
    // No trace below the systole's, 2 (1 + sqrt 2); the identity has 2.
    EXPECT_GE(least, 2 * (1 + root) - 1e-9);
}

TEST(ExactGroups, TracesOfKleinsQuarticAreIntegersOfItsField) {
    // Over Q(cos 2 pi / 7): a + b c + d c^2, c = 2 cos(2 pi k / 7), the conjugates k = 2, 3 in [-2, 2].
    const SurfaceMesh mesh = make_klein_quartic();
    const SurfaceStructure s = structure_of(mesh);
    EXPECT_LE(s.group.relator_error, 1e-10);
    std::array<double, 3> c{};
    for (std::size_t k = 0; k < 3; ++k) c[k] = 2 * std::cos(2 * pi * static_cast<double>(k + 1) / 7);
    double least = 1e300;
    for (const double t : sample_traces(s.group, 200, 12)) {
        // From t, and p, q for the conjugates, d = sum over k of t_k / ((c_k - c_i)(c_k - c_j)); likewise b.
        double best = 1e300;
        const double d0 = t / ((c[0] - c[1]) * (c[0] - c[2])),
                     reach_d = 2 / std::abs((c[1] - c[0]) * (c[1] - c[2])) +
                               2 / std::abs((c[2] - c[0]) * (c[2] - c[1]));
        for (double d = std::ceil(d0 - reach_d); d <= d0 + reach_d; ++d) {
            // t - p = (c0 - c1)(b + d (c0 + c1)), p in [-2, 2].
            const double b1 = (t - 2) / (c[0] - c[1]) - d * (c[0] + c[1]),
                         b2 = (t + 2) / (c[0] - c[1]) - d * (c[0] + c[1]);
            for (double b = std::ceil(std::min(b1, b2) - 1e-6); b <= std::max(b1, b2) + 1e-6; ++b) {
                const double a = std::round(t - b * c[0] - d * c[0] * c[0]);
                const double conjugate = a + b * c[2] + d * c[2] * c[2];
                if (std::abs(conjugate) > 2 + 1e-6) continue;
                best = std::min(best, std::abs(a + b * c[0] + d * c[0] * c[0] - t));
            }
        }
        EXPECT_LE(best, 1e-9 * std::max(1.0, t)) << t;
        if (t > 2 + 1e-6) least = std::min(least, t);
    }
    EXPECT_GE(least, 2 * std::cosh(3.935946 / 2) - 1e-5);  // the systole to its printed digits
}

TEST(ExactGroups, FinerPatternsHaveTheSameTraces) {
    // Subdividing equilateral triangles changes nothing of the conformal class: the whole set of traces of
    // short words is that of the coarse pattern, as far as the loops are the same. Checked through the
    // arithmetic again.
    const SurfaceMesh mesh = generated("bolza", 1000, 0.0);
    const SurfaceStructure s = structure_of(mesh);
    for (const double t : sample_traces(s.group, 60, 13)) {
        double best = 1e300;
        const auto middle = std::lround(t / (2 * std::numbers::sqrt2));
        for (long n = middle - 2; n <= middle + 2; ++n) {
            const double x = static_cast<double>(n) * std::numbers::sqrt2, m = std::round(t - x);
            if (std::abs(m - x) <= 2 + 1e-6) best = std::min(best, std::abs(m + x - t));
        }
        EXPECT_LE(best, 1e-9 * std::max(1.0, t)) << t;
    }
}

/// Traces of the generators, of their products in pairs, in order.
std::vector<double> marked_traces(const SurfaceStructure& s, const std::vector<Word>& words) {
    std::vector<double> traces;
    for (std::size_t i = 0; i < words.size(); ++i) {
        traces.push_back(trace(product_of(s.group, words[i])));
        traces.push_back(trace(product_of(s.group, product(words[i], words[(i + 1) % words.size()]))));
    }
    return traces;
}

void expect_equal_traces(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], tolerance * std::max(1.0, a[k]));
}

std::vector<Word> single_letters(const SurfaceStructure& s) {
    std::vector<Word> words;
    for (Index k = 1; k <= s.basis->letters(); ++k) words.push_back({k});
    return words;
}

SurfaceMesh inverted(const SurfaceMesh& mesh) {
    // x -> (x - c) / |x - c|^2 from a point off the surface.
    SurfaceMesh copy = mesh;
    const Point c = {0.31, 5.0, 2.7};
    for (Point& p : copy.points) {
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) square += (p[k] - c[k]) * (p[k] - c[k]);
        for (std::size_t k = 0; k < 3; ++k) p[k] = (p[k] - c[k]) / square;
    }
    return make_surface_mesh(copy.points, triangles_of(copy.connectivity));
}

TEST(GroupInvariance, MoebiusInversionOfTheVertices) {
    const SurfaceMesh mesh = generated("eight", 3000);
    StructureOptions options;
    options.flow.delaunay = false;  // then conformal invariants are unchanged exactly
    options.base = 17;
    options.goal = 1e-14;
    const SurfaceMesh other = inverted(mesh);
    const SurfaceStructure a = structure_of(mesh, options), b = structure_of(other, options);
    // The lengths that choose the loops are conformally invariant but for rounding, so the loops are the
    // same.
    ASSERT_EQ(a.basis->relator(), b.basis->relator());
    expect_equal_traces(marked_traces(a, single_letters(a)), marked_traces(b, single_letters(b)), 1e-8);
}

TEST(GroupInvariance, MoebiusInversionOfASampleMesh) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight.off");
    const SurfaceMesh mesh = load_mesh(path).components.at(0);
    StructureOptions options;
    options.base = 100;
    options.goal = 1e-14;
    const SurfaceMesh other = inverted(mesh);
    // With the isometric Delaunay flips where neither mesh needs any; without them in any case.
    const bool both_delaunay = count_non_delaunay<double>(intrinsic_triangulation<double>(mesh), {}) == 0 &&
                               count_non_delaunay<double>(intrinsic_triangulation<double>(other), {}) == 0;
    for (const bool delaunay : {false, true}) {
        if (delaunay && !both_delaunay) continue;
        options.flow.delaunay = delaunay;
        const SurfaceStructure a = structure_of(mesh, options), b = structure_of(other, options);
        ASSERT_EQ(a.basis->relator(), b.basis->relator());
        expect_equal_traces(marked_traces(a, single_letters(a)), marked_traces(b, single_letters(b)), 1e-8);
    }
}

/// Words, in another structure's letters, of this one's generators as closed edge paths.
std::vector<Word> words_in(const SurfaceStructure& s, const SurfaceMesh& mesh, const SurfaceStructure& other,
                           const SurfaceMesh& other_mesh, const std::vector<Index>& number) {
    // Halfedges of the other mesh by their ends (simple meshes).
    std::map<std::pair<Index, Index>, Index> halfedge;
    for (Index h = 0; h < other_mesh.connectivity.halfedge_count(); ++h)
        halfedge[{other_mesh.connectivity.tail[at(h)], other_mesh.connectivity.head(h)}] = h;
    std::vector<Word> words;
    for (Index k = 0; k < s.basis->letters(); ++k) {
        EdgePath path;
        for (const Step step : s.basis->loop_path(k))
            path.push_back(halfedge.at({number[at(step_tail(mesh.connectivity, step))],
                                        number[at(step_head(mesh.connectivity, step))]}));
        words.push_back(other.basis->word_of_path(path));
    }
    return words;
}

TEST(GroupInvariance, RelabellingAndAnotherBaseConjugate) {
    const SurfaceMesh mesh = generated("eight", 2500);
    Random random(21);
    const std::vector<Index> number = random.permutation(mesh.connectivity.vertex_count);
    const SurfaceMesh other = relabelled(mesh, number, random);
    StructureOptions options;
    options.goal = 1e-14;
    options.base = 5;
    const SurfaceStructure a = structure_of(mesh, options);
    for (const Index base : {Index{5}, Index{700}}) {
        options.base = number[at(base)];
        const SurfaceStructure b = structure_of(other, options);
        // The path starts at a's base, which b joins to its own by the tree: one conjugation for all letters.
        // Traces of products show that it is the same one.
        const std::vector<Word> words = words_in(a, mesh, b, other, number);
        expect_equal_traces(marked_traces(a, single_letters(a)), marked_traces(b, words), 1e-9);
    }
}

TEST(Torus, ModulusConvergesToItsClosedForm) {
    // R/r = 2.5: i sqrt(5.25), up to the modular group; second order in h.
    const std::complex<double> exact(0, std::sqrt(5.25));
    std::vector<double> errors;
    for (const Index faces : {1000, 4000, 16000}) {
        const SurfaceMesh mesh = generated("torus", faces, 0.0);
        const SurfaceStructure s = structure_of(mesh);
        ASSERT_EQ(s.group.generators.size(), 2U);
        const auto shift = [&](std::size_t k) {
            const auto m = plane_matrix(s.group.generators[k].element);
            EXPECT_NEAR(m[0], 1.0, 1e-9);  // a translation
            return std::complex<double>(m[2], m[5]);
        };
        std::complex<double> a = shift(0), b = shift(1);
        const Lattice lattice = lattice_of(s.flow.triangulation, s.flow.edge_length);
        reduce(a, b);
        if ((b / a).imag() < 0) b = -b;
        EXPECT_NEAR(std::abs(b / a - lattice.modulus()), 0.0, 1e-9);
        // Area one.
        EXPECT_NEAR(std::abs((std::conj(a) * b).imag()), 1.0, 1e-9);
        errors.push_back(std::abs(b / a - exact));
    }
    for (std::size_t k = 0; k + 1 < errors.size(); ++k) {
        const double order = std::log2(errors[k] / errors[k + 1]);
        EXPECT_GT(order, 1.8);
        EXPECT_LT(order, 2.3);
    }
}

TEST(Boundary, HolonomyIsAsLongAsTheBoundary) {
    for (const char* name : {"pants", "genus-g-one-boundary"}) {
        const SurfaceMesh mesh = generated(name, 1500);
        StructureOptions options;
        options.goal = 1e-14;
        const SurfaceStructure s = structure_of(mesh, options);
        EXPECT_LE(s.group.relator_error, 1e-10);
        for (Index j = 0; j < s.basis->boundaries(); ++j) {
            // Boundary edges are geodesic in the final metric: their length is that of the flow's u.
            double length = 0;
            const std::vector<double> edge = final_edge_lengths(mesh, s.flow.conformal_factor, -1);
            bool kept = true;
            for (const Index h : s.basis->boundary_walk(j)) {
                length += edge[at(h)];
                // An edge that was flipped away has no length of its own there.
                Index sides = 0;
                for (Index c = 0; c < s.refinement->corner_count(); ++c)
                    sides +=
                        s.refinement->input_halfedge[at(c)] == h && s.refinement->final_halfedge[at(c)] >= 0
                            ? 1
                            : 0;
                kept = kept && sides == 1;
            }
            if (!kept) continue;
            const double t = trace(s.group.letters[at(s.basis->loops() + j)]);
            EXPECT_NEAR(2 * std::acosh(t / 2), length, 1e-9) << name << " " << j;
        }
    }
}

TEST(Precision, ExtendedArithmeticClosesGroupsThatReachFar) {
    // A row of ten rings: canonical words reach far beyond what double holds.
    const SurfaceMesh mesh = generated("genus-g", 4000, 0.3, 10);
    StructureOptions options;
    options.max_digits = 16;
    const SurfaceStructure plain = structure_of(mesh, options);
    EXPECT_GT(plain.group.relator_error, 1e-8) << "no test: double does";
    options.max_digits = 800;
    const SurfaceStructure s = structure_of(mesh, options);
    EXPECT_LE(s.group.relator_error, 1e-10);
    EXPECT_GT(s.group.digits, 16);
    EXPECT_LE(s.layout.closing_error, 1e-10);
    EXPECT_EQ(s.layout.flipped, 0);
}

TEST(Precision, SampleMeshesOfHighGenus) {
    for (const char* name :
         {"meshes/closed_g5plus/engine_g12.obj", "meshes/closed_g5plus/gyroidpuzzle_g15.obj"}) {
        const std::string path = data_file(name);
        if (path.empty()) GTEST_SKIP() << name << " not found";
        const SurfaceMesh mesh = load_mesh(path).components.at(0);
        const SurfaceStructure s = structure_of(mesh);
        EXPECT_LE(s.group.relator_error, 1e-8) << name;
        EXPECT_LE(s.layout.closing_error, 1e-8) << name;
        EXPECT_EQ(s.layout.flipped, 0) << name;
    }
}

TEST(Cones, FlatMetricWithOneConeHasRigidMotions) {
    const SurfaceMesh mesh = generated("eight", 2000);
    StructureOptions options;
    options.flow.cones = {{40, -4 * pi}};
    const SurfaceStructure s = structure_of(mesh, options);
    EXPECT_EQ(s.kappa, 0);
    EXPECT_LE(s.group.relator_error, 1e-8);
    EXPECT_LE(s.layout.closing_error, 1e-9);
    EXPECT_EQ(s.layout.flipped, 0);
    // The circle around the cone turns by its angle, 6 pi: a rotation by no angle at all, as a motion, about
    // the cone.
    ASSERT_EQ(s.basis->cones().size(), 1U);
    const Isometry<double>& around = s.group.letters.back();
    EXPECT_LT(distance_to_identity(around), 1e-8);
}

TEST(Cones, PolyhedralSphereUnfolds) {
    const SurfaceMesh mesh = generated("sphere", 1500);
    StructureOptions options;
    for (const Index v : {0, 100, 300, 500}) options.flow.cones.push_back({v, pi});
    const SurfaceStructure s = structure_of(mesh, options);
    EXPECT_LE(s.group.relator_error, 1e-9);
    EXPECT_EQ(s.layout.flipped, 0);
    EXPECT_EQ(s.cut.sides.size() % 2, 0U);
    // Cones of curvature pi: half turns.
    for (const Isometry<double>& x : s.group.letters) EXPECT_NEAR(x.a.re, 0.0, 1e-9);
}

}  // namespace
}  // namespace ricci
