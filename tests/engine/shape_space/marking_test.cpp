#include "engine/shape_space/marking.h"

#include <gtest/gtest.h>

#include <set>

#include "engine/remesh/resample.h"
#include "engine/shape_space/drawn_geodesic.h"
#include "engine/surfaces/generate.h"
#include "tests/engine/layout/layout_checks.h"
#include "tests/engine/shape_space/marked_surface.h"

namespace ricci {
namespace {

using testing::around;
using testing::at;
using testing::bent_row;
using testing::coarse_of;
using testing::difference;
using testing::load_component;
using testing::marked;
using testing::MarkedSurface;
using testing::RowType;

double gap_of(const MarkedSurface& m, const std::string& name) {
    for (const MarkingChoice& c : m.coordinates.choices)
        if (c.name == name) return c.gap;
    throw std::out_of_range("no choice " + name);
}

class Markings : public ::testing::TestWithParam<RowType> {
  protected:
    void SetUp() override { m_ = marked(bent_row(GetParam().rings, GetParam().part)); }
    MarkedSurface m_;
};

/// a and b are simple, meet once, positively; handles are disjoint; [a,b] is simple and misses them all.
TEST_P(Markings, HandlesAreOneHoledTori) {
    std::vector<ClosedGeodesic> a, b, e;
    for (const MarkedHandle& h : m_.marking.handles) {
        a.push_back(m_.geodesic({h.vertex, h.a}));
        b.push_back(m_.geodesic({h.vertex, h.b}));
        e.push_back(m_.geodesic(around(h)));
        // The directions where they cross: <n_a x n_b, point> > 0.
        const Minkowski n = axis_normal(h.a), m = axis_normal(h.b), x = line_crossing(-1, n, m);
        const double frame = n[0] * (m[1] * x[2] - m[2] * x[1]) + n[1] * (m[2] * x[0] - m[0] * x[2]) +
                             n[2] * (m[0] * x[1] - m[1] * x[0]);
        EXPECT_TRUE(lines_cross(n, m));
        EXPECT_GT(frame, 0);
    }
    ASSERT_EQ(static_cast<Index>(a.size()), GetParam().genus);
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(crossings(a[i], b[i], *m_.coarse), 1);
        for (const ClosedGeodesic* g : {&a[i], &b[i], &e[i]}) EXPECT_EQ(self_crossings(*g, *m_.coarse), 0);
        for (std::size_t j = 0; j < a.size(); ++j) {
            EXPECT_EQ(crossings(e[i], a[j], *m_.coarse), 0);
            EXPECT_EQ(crossings(e[i], b[j], *m_.coarse), 0);
            if (i == j) continue;
            EXPECT_EQ(crossings(a[i], a[j], *m_.coarse), 0);
            EXPECT_EQ(crossings(a[i], b[j], *m_.coarse), 0);
            EXPECT_EQ(crossings(b[i], b[j], *m_.coarse), 0);
        }
    }
}

/// inner * added = outer; all three have the length of what they are said to be; x(k) is simple and misses
/// handles, boundaries and the other curves of the chain. The frames of the links fit.
TEST_P(Markings, LinksArePants) {
    const Marking& m = m_.marking;
    const auto [g, r, rings, part] = GetParam();
    if (g == 1 && r == 1) return;
    ASSERT_EQ(static_cast<Index>(m.links.size()), g + r - 2);
    Isometry<Exact> before = m.first.element;
    std::vector<ClosedGeodesic> chain, others;
    for (const MarkedHandle& h : m.handles) {
        others.push_back(m_.geodesic({h.vertex, h.a}));
        others.push_back(m_.geodesic({h.vertex, h.b}));
    }
    const std::vector<Index> loops = boundary_halfedges(*m_.coarse);
    for (const Index h : loops) others.push_back(m_.geodesic(boundary_curve(*m_.exact, h)));
    std::set<Index> handles, boundaries;
    if (g == 0) boundaries.insert(m.boundaries[0]);
    for (std::size_t k = 0; k < m.links.size(); ++k) {
        const ChainLink& l = m.links[k];
        const Isometry<Exact> miss = product(l.inner, l.added, inverse(l.outer));
        EXPECT_LT(static_cast<double>(distance_to_identity(miss)), 1e-30);
        EXPECT_LT(static_cast<double>(
                      distance_to_identity(product(conjugated(l.inner, l.to_previous), inverse(before)))),
                  1e-30)
            << "inner is the curve of the link before, in its frame";
        before = l.outer;
        // Pants on the left of inner and added, on the right of outer.
        const Minkowski inner = axis_normal(l.inner), added = axis_normal(l.added),
                        outer = axis_normal(l.outer);
        EXPECT_LT(minkowski(inner, added), -1);
        EXPECT_GT(minkowski(inner, outer), 1);
        EXPECT_GT(minkowski(added, outer), 1);
        if (l.handle >= 0) {
            EXPECT_TRUE(handles.insert(l.handle).second);
            EXPECT_TRUE(boundaries.empty()) << "handles first";
            const MarkedHandle& h = l.torus;
            const Isometry<Exact> around_it = product(h.a, h.b, inverse(h.a), inverse(h.b));
            const double one =
                             static_cast<double>(distance_to_identity(product(around_it, inverse(l.added)))),
                         other = static_cast<double>(distance_to_identity(product(around_it, l.added)));
            EXPECT_LT(std::min(one, other), 1e-25);
        } else {
            EXPECT_TRUE(boundaries.insert(l.boundary).second);
            EXPECT_NEAR(translation_length(l.added),
                        translation_length(boundary_curve(*m_.exact, loops[at(l.boundary)]).element), 1e-12);
        }
        if (k + 1 == m.links.size()) break;
        chain.push_back(m_.geodesic({l.vertex, l.outer}));
    }
    for (std::size_t k = 0; k < chain.size(); ++k) {
        EXPECT_EQ(self_crossings(chain[k], *m_.coarse), 0) << "x" << k + 2;
        for (const ClosedGeodesic& o : others)
            EXPECT_EQ(crossings(chain[k], o, *m_.coarse), 0) << "x" << k + 2;
        for (std::size_t j = 0; j < k; ++j) EXPECT_EQ(crossings(chain[k], chain[j], *m_.coarse), 0);
    }
    EXPECT_EQ(std::set<Index>(m.boundaries.begin(), m.boundaries.end()).size(), loops.size());
}

INSTANTIATE_TEST_SUITE_P(Types, Markings, ::testing::ValuesIn(testing::row_types()), [](const auto& row) {
    return "g" + std::to_string(row.param.genus) + "b" + std::to_string(row.param.boundaries);
});

/// The complete spectrum with the homology class of every geodesic, boundaries filled in, from its word.
struct Classified {
    std::vector<ClosedGeodesic> geodesics;
    std::vector<Word> words;
    std::vector<bool> separating;
};
Classified classified(const SurfaceMesh& mesh, double length) {
    const SurfaceStructure s = make_sharp_structure(mesh, {}, 16);
    const CoarseSurface coarse = coarse_surface_of(mesh, s.flow, true, &*s.refinement, &*s.metric);
    SpectrumOptions options;
    options.max_length = length;
    const LengthSpectrum spectrum = length_spectrum(coarse, options);
    EXPECT_GE(spectrum.complete_up_to, length);
    Classified c;
    for (const ClosedGeodesic& g : spectrum.geodesics) {
        if (g.length > length) break;
        const Word word = canonical_word(s, draw_geodesic(s, mesh.connectivity, coarse, g).path);
        std::vector<Index> sum(s.group.generators.size(), 0);
        for (const Index letter : word) sum[at(generator_of(letter))] += letter > 0 ? 1 : -1;
        c.separating.push_back(
            std::all_of(sum.begin(), sum.begin() + 2 * s.canonical.genus(), [](Index n) { return n == 0; }));
        c.geodesics.push_back(g);
        c.words.push_back(word);
    }
    return c;
}

/// a1 is the shortest that does not separate; b1, up to turns along it, the shortest that meets it once.
TEST(Marking, FirstHandleIsTheShortest) {
    for (const RowType& t : {RowType{2, 0, 2, RowPart::whole}, RowType{1, 2, 3, RowPart::right},
                             RowType{1, 1, 2, RowPart::right}, RowType{2, 1, 4, RowPart::right}}) {
        const SurfaceMesh mesh = bent_row(t.rings, t.part);
        const MarkedSurface m = marked(mesh);
        double shortest_b = 1e300;
        Isometry<Exact> b = m.marking.handles[0].b;
        const Isometry<Exact>& a = m.marking.handles[0].a;
        for (int k = 0; k < 10; ++k) b = product(inverse(a), b);
        for (int k = 0; k < 20; ++k, b = product(a, b))
            shortest_b = std::min(shortest_b, translation_length(b));
        const Classified c = classified(mesh, shortest_b + 1e-6);
        const auto first = std::find(c.separating.begin(), c.separating.end(), false) - c.separating.begin();
        EXPECT_NEAR(c.geodesics.at(static_cast<std::size_t>(first)).length, m.length("a1"), 1e-9);
        const CoarseSurface& s = *m.coarse;
        const ClosedGeodesic a1 = m.geodesic({m.marking.handles[0].vertex, a});
        SpectrumOptions options;
        options.max_length = shortest_b + 1e-6;
        double found = 0;
        for (const ClosedGeodesic& g : length_spectrum(s, options).geodesics)
            if (found == 0 && crossings(g, a1, s) == 1 && self_crossings(g, s) == 0) found = g.length;
        EXPECT_NEAR(found, shortest_b, 1e-9) << testing::text_of(t);
    }
}

/// Four holes: every curve around two of them comes from a perpendicular of length d between these,
/// cosh(x/2) = sinh(c/2) sinh(c'/2) cosh d - cosh(c/2) cosh(c'/2). The chain took the shortest from c1.
TEST(Marking, TakesTheNearestHole) {
    for (const std::uint64_t seed : {5, 6, 7, 8}) {
        const SurfaceMesh mesh = bent_row(3, RowPart::upper, 700, 0.2, seed);
        const MarkedSurface m = marked(mesh);
        std::array<double, 4> c{};
        for (std::size_t j = 0; j < 4; ++j) c[j] = m.length("c" + std::to_string(j + 1));
        for (std::size_t j = 1; j < 4; ++j)
            EXPECT_LE(c[0], c[j] + 1e-12) << "the chain starts at the shortest";
        const auto distance = [&](double x, std::size_t j) {
            return std::acosh((std::cosh(x / 2) + std::cosh(c[0] / 2) * std::cosh(c[j] / 2)) /
                              (std::sinh(c[0] / 2) * std::sinh(c[j] / 2)));
        };
        const double taken = distance(m.length("x2"), 1);
        // Beyond this length all perpendiculars are longer.
        double enough = 0;
        for (std::size_t j = 1; j < 4; ++j)
            enough = std::max(
                enough,
                2 * std::acosh(std::max(1.0, std::sinh(c[0] / 2) * std::sinh(c[j] / 2) * std::cosh(taken) -
                                                 std::cosh(c[0] / 2) * std::cosh(c[j] / 2))));
        const SurfaceStructure s = make_sharp_structure(mesh, {}, 16);
        const CoarseSurface coarse = coarse_surface_of(mesh, s.flow, true, &*s.refinement, &*s.metric);
        SpectrumOptions options;
        options.max_length = enough + 0.01;
        const LengthSpectrum spectrum = length_spectrum(coarse, options);
        // Generators c(k) of the group and holes of the chain go by the boundary's length (all differ).
        std::vector<std::size_t> hole_of;
        for (Index k = 0; k < 4; ++k) {
            const Word letter{k + 1};
            std::size_t nearest = 0;
            for (std::size_t j = 1; j < 4; ++j)
                if (std::abs(word_length(s, letter) - c[j]) < std::abs(word_length(s, letter) - c[nearest]))
                    nearest = j;
            hole_of.push_back(nearest);
        }
        ASSERT_EQ(std::set<std::size_t>(hole_of.begin(), hole_of.end()).size(), 4U);
        double best = 1e300;
        for (const ClosedGeodesic& g : spectrum.geodesics) {
            if (self_crossings(g, coarse) != 0) continue;
            std::array<Index, 4> sum{};
            for (const Index letter : canonical_word(s, draw_geodesic(s, mesh.connectivity, coarse, g).path))
                sum[hole_of[at(generator_of(letter))]] += letter > 0 ? 1 : -1;
            // Modulo c1 + c2 + c3 + c4 = 0: those that c1 is not together with.
            std::vector<std::size_t> with;
            for (std::size_t j = 1; j < 4; ++j)
                if (sum[j] == sum[0]) with.push_back(j);
            if (with.size() == 1) best = std::min(best, distance(g.length, with[0]));
        }
        EXPECT_NEAR(best, taken, 1e-8) << "seed " << seed;
    }
}

/// Exact products: a curve of 60 letters is a closed geodesic of the final metric of the fine triangulation
/// too, drawn there it closes and is as long.
TEST(Marking, LongWordsAreGeodesicsOfTheFineSurface) {
    const SurfaceMesh mesh = bent_row(2, RowPart::whole);
    const SurfaceStructure s = make_sharp_structure(mesh, {}, 800);
    const MarkedSurface m = marked(coarse_surface_of(mesh, s.flow, true, &*s.refinement, &*s.metric));
    const MarkedHandle& h = m.marking.handles[0];
    // Many letters and yet short enough to draw: a^k b a^k b^-1 ..., a the systole.
    Isometry<Exact> power;
    for (int k = 0; k < 13; ++k) power = product(power, h.a);
    const BasedCurve curve{h.vertex, product(product(power, h.b), h.b, inverse(power), h.b)};
    const ClosedGeodesic g = m.geodesic(curve);
    EXPECT_NEAR(g.length, translation_length(curve.element), 1e-12);
    const SurfaceCurve drawn = draw_geodesic(s, mesh.connectivity, *m.coarse, g);
    EXPECT_NEAR(drawn.length / g.length, 1, 1e-8);
    EXPECT_LT(drawn.closing_error, 1e-6);
    // And the deck transformations of the fine surface agree, in double where these reach.
    for (const LengthCoordinate& c : m.coordinates.lengths) {
        const SurfaceCurve d = draw_geodesic(s, mesh.connectivity, *m.coarse, m.geodesic(c.curve));
        EXPECT_NEAR(loop_length(s, d.path), c.length, 1e-7 * c.length) << c.name;
    }
}

TEST(Marking, EndsWithItsBudget) {
    MarkingOptions options;
    options.budget = 50;
    EXPECT_THROW(make_marking(coarse_of(bent_row(2, RowPart::whole)), options), std::runtime_error);
    EXPECT_THROW(make_marking(coarse_of(bent_row(5, RowPart::upper)), options), std::runtime_error);
}

TEST(Marking, SymmetryIsANearTie) {
    RICCI_DATA_FILE_OR_SKIP(eight, "meshes/closed_g2/eight.off");
    const MarkedSurface m = marked(load_component(eight));
    EXPECT_LT(gap_of(m, "a1"), 1e-3);
    EXPECT_NEAR(m.length("a1") / m.length("a2"), 1, 1e-3);
    EXPECT_GE(gap_of(m, "b1"), 0.0);
    EXPECT_GT(gap_of(m, "twist of b1"), 0.09) << "twist 0 is well inside";
    // An exactly symmetric one: the tie is a tie, whichever is taken gives the same numbers.
    const MarkedSurface row = marked(make_ring_row(800, 2, RowPart::whole));
    EXPECT_LT(gap_of(row, "a1"), 1e-9);
    EXPECT_NEAR(row.length("a1"), row.length("a2"), 1e-8);
    EXPECT_NEAR(row.length("b1"), row.length("b2"), 1e-8);
    EXPECT_LT(row.coordinates.smallest_gap, 1e-9);
}

TEST(Marking, NoiseKeepsTheMarkingOfTheCup) {
    RICCI_DATA_FILE_OR_SKIP(file, "meshes/closed_g2/cup.off");
    const SurfaceMesh cup = load_component(file);
    const MarkedSurface m = marked(cup);
    EXPECT_GT(m.coordinates.smallest_gap, 0.01);
    Point low = cup.points[0], high = cup.points[0];
    for (const Point& p : cup.points)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    const double diagonal = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    SurfaceMesh noisy = cup;
    testing::Random random(1);
    for (Point& p : noisy.points)
        for (double& x : p) x += random.uniform(-1e-3, 1e-3) * diagonal;
    const MarkedSurface n = marked(make_surface_mesh(noisy.points, triangles_of(cup.connectivity)));
    EXPECT_LT(difference(m.lengths(), n.lengths()), 0.01);
    EXPECT_GT(difference(m.lengths(), n.lengths()), 1e-6);
}

/// Thesis, Table 5.
TEST(Marking, ResolutionsOfTheCupAgree) {
    RICCI_DATA_FILE_OR_SKIP(file, "meshes/closed_g2/cup.off");
    const SurfaceMesh cup = load_component(file);
    std::vector<std::vector<double>> all{marked(cup).lengths()};
    for (const Index faces : {10000, 40000, 5000}) all.push_back(marked(resample(cup, faces).mesh).lengths());
    for (std::size_t k = 0; k < all[0].size(); ++k) {
        // Decimation to 5,000 faces, a quarter of them, moves the surface itself: by 0.5 %.
        double low = 1e300, high = 0;
        std::string figures;
        for (std::size_t i = 0; i < all.size(); ++i) {
            ASSERT_EQ(all[i].size(), 7U);
            low = std::min(low, all[i][k]);
            high = std::max(high, all[i][k]);
            figures += " " + std::to_string(all[i][k]);
            EXPECT_LT(high / low - 1, i < 3 ? 0.002 : 0.006) << "coordinate " << k << ":" << figures;
        }
        RecordProperty("coordinate" + std::to_string(k), figures);
    }
}

TEST(Marking, DataHaveMarkings) {
    struct Sample {
        const char* file;
        std::size_t coordinates;
    };
    for (const Sample& sample :
         {Sample{"closed_g2/brezel.obj", 7}, Sample{"closed_g3/3holes.off", 13},
          Sample{"closed_g3/elephant.off", 13}, Sample{"closed_g3/genus3.off", 13},
          Sample{"families/fertility_resolutions/fertility_1013v.obj", 19},
          Sample{"handles_with_boundary/featuretype_g1b16.stl", 49},
          Sample{"multi_boundary/plane_holes_b27.obj", 76}, Sample{"pants/letterB-TA002.off", 3},
          Sample{"handles_with_boundary/chipped-torus_g1b1.obj", 3},
          Sample{"multi_boundary/pipes_b6.off", 13}, Sample{"closed_g5plus/engine_g12.obj", 67}}) {
        const std::string path = testing::data_file(std::string("meshes/") + sample.file);
        if (path.empty()) continue;
        SCOPED_TRACE(sample.file);
        MarkedSurface m;
        ASSERT_NO_THROW(m = marked(load_component(path)));
        EXPECT_EQ(m.coordinates.lengths.size(), sample.coordinates);
        for (const LengthCoordinate& c : m.coordinates.lengths)
            EXPECT_TRUE(std::isfinite(c.length)) << c.name;
        for (const FenchelNielsen& f : m.coordinates.pants) EXPECT_TRUE(std::isfinite(f.twist)) << f.name;
    }
}

/// Bolza's surface: the systole, 12 times.
TEST(Marking, BolzaStartsWithItsSystole) {
    GenerateOptions options;
    options.faces = 256;
    const MarkedSurface m = marked(generate("bolza", options));
    EXPECT_NEAR(m.length("a1"), 2 * std::acosh(1 + std::sqrt(2.0)), 1e-9);
    EXPECT_LT(gap_of(m, "a1"), 1e-9);
}

}  // namespace
}  // namespace ricci
