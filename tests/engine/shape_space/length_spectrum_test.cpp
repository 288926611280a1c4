// Length spectra: surfaces whose lengths are known in closed form, identities over all closed geodesics, and
// what must change nothing.
#include "engine/shape_space/length_spectrum.h"

#include "engine/remesh/resample.h"
#include "kernels/parallel.h"
#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::expect_same_lengths;
using testing::generated;
using testing::lengths_of;
using testing::lengths_up_to;
using testing::Random;
using testing::spectrum_up_to;
using testing::thinned;

struct Multiplet {
    double length;
    int count;
};

/// Primitive lengths with their multiplicities, powers added.
std::vector<double> with_powers(const std::vector<Multiplet>& primitive, double max_length) {
    std::vector<double> lengths;
    for (const Multiplet& m : primitive)
        for (int k = 1; k * m.length <= max_length; ++k)
            lengths.insert(lengths.end(), at(static_cast<Index>(m.count)), k * m.length);
    std::sort(lengths.begin(), lengths.end());
    return lengths;
}

/// cosh(l/2) = m + n sqrt 2; half the multiplicities of oriented geodesics in Aurich, Steiner 1988, table 1.
std::vector<double> bolza_lengths(double max_length) {
    const auto length = [](int m, int n) { return 2 * std::acosh(m + n * std::numbers::sqrt2); };
    return with_powers({{length(1, 1), 12},
                        {length(3, 2), 12},
                        {length(5, 3), 24},
                        {length(7, 5), 48},
                        {length(9, 6), 24},
                        {length(9, 7), 24},
                        {length(11, 8), 4},
                        {length(13, 9), 48}},
                       max_length);
}

/// Traces a + b c + d c^2, c = 2 cos(2 pi / 7); multiplicities: Vogeler, On the geometry of Hurwitz surfaces
/// (2003).
std::vector<double> klein_lengths(double max_length) {
    const double c = 2 * std::cos(2 * std::numbers::pi / 7);
    const auto length = [c](int a, int b, int d) { return 2 * std::acosh((a + b * c + d * c * c) / 2); };
    return with_powers({{length(2, 3, 1), 21},
                        {length(3, 6, 2), 28},
                        {length(6, 17, 8), 84},
                        {length(6, 20, 9), 84},
                        {length(10, 23, 10), 56}},
                       max_length);
}

/// The same intrinsic surface with vertices, faces and corners numbered anew.
SurfaceMesh renumbered(const SurfaceMesh& mesh, std::uint64_t seed) {
    Random random(seed);
    const Connectivity& c = mesh.connectivity;
    const std::vector<Index> vertex = random.permutation(c.vertex_count),
                             face = random.permutation(c.face_count());
    std::vector<Index> number(c.tail.size());
    for (Index f = 0; f < c.face_count(); ++f) {
        const Index turn = random.below(Index{3});
        for (Index k = 0; k < 3; ++k) number[at(3 * f + k)] = 3 * face[at(f)] + (k + turn) % 3;
    }
    std::vector<Index> tail(c.tail.size()), twin(c.tail.size());
    SurfaceMesh out = mesh;
    for (std::size_t h = 0; h < number.size(); ++h) {
        const std::size_t n = at(number[h]);
        tail[n] = vertex[at(c.tail[h])];
        twin[n] = c.twin[h] == kNoTwin ? kNoTwin : number[at(c.twin[h])];
        out.edge_length[n] = mesh.edge_length[h];
    }
    out.connectivity = connectivity_from_gluing(std::move(tail), std::move(twin), c.vertex_count);
    return out;
}

TEST(LengthSpectrum, BolzaIsExact) {
    const std::vector<double> exact = bolza_lengths(8.0);
    EXPECT_EQ(exact.size(), 208U);
    expect_same_lengths(lengths_up_to(make_bolza(), 8.0), exact, 1e-9);
    expect_same_lengths(lengths_up_to(subdivide_midpoint(make_bolza()), 6.2), bolza_lengths(6.2), 1e-9);
    for (const std::uint64_t seed : {1, 2, 3}) {
        const SurfaceMesh other = renumbered(testing::scrambled(make_bolza(), 200, seed), seed);
        expect_same_lengths(lengths_up_to(other, 7.0), bolza_lengths(7.0), 1e-9);
        const SurfaceMesh finer = testing::scrambled(testing::generated("bolza", 256), 2000, seed);
        expect_same_lengths(lengths_up_to(finer, 6.2), bolza_lengths(6.2), 1e-9);
    }
}

TEST(LengthSpectrum, KleinIsExact) {
    const std::vector<double> exact = klein_lengths(8.1);
    EXPECT_EQ(exact.size(), 294U);
    expect_same_lengths(lengths_up_to(make_klein_quartic(), 8.1), exact, 1e-9);
    expect_same_lengths(lengths_up_to(subdivide_midpoint(make_klein_quartic()), 6.0), klein_lengths(6.0),
                        1e-9);
    for (const std::uint64_t seed : {1, 2, 3}) {
        const SurfaceMesh other = renumbered(testing::scrambled(make_klein_quartic(), 300, seed), seed);
        expect_same_lengths(lengths_up_to(other, 6.0), klein_lengths(6.0), 1e-9);
    }
}

TEST(LengthSpectrum, ExactOnesDoNotDependOnTheVerticesThatStay) {
    for (const double spacing : {0.5, 0.9, 1.3}) {
        const SurfaceMesh bolza = testing::generated("bolza", 1024),
                          klein = testing::generated("klein-quartic", 896);
        expect_same_lengths(lengths_of(spectrum_up_to(thinned(bolza, spacing), 6.2)), bolza_lengths(6.2),
                            1e-9);
        expect_same_lengths(lengths_of(spectrum_up_to(thinned(klein, spacing), 6.0)), klein_lengths(6.0),
                            1e-9);
    }
}

TEST(LengthSpectrum, AnotherSurfaceHasOtherLengths) {
    // A slight change of Bolza's edges splits the multiplets: the tests above can fail.
    SurfaceMesh mesh = make_bolza();
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h)
        mesh.edge_length[at(h)] *= 1 + 1e-4 * mesh.connectivity.edge[at(h)];
    const std::vector<double> found = lengths_up_to(mesh, 4.0);
    EXPECT_GT(found.back() - found.front(), 1e-5);
}

// ---- McShane's identity

/// Lengths of the simple closed geodesics of a one-holed torus up to a length, from two that meet once and
/// the boundary: x^2 + y^2 + z^2 - xyz = 2 - 2 cosh(L/2) for traces of a, b, ab, and z' = xy - z for ab^-1
/// (Fricke; Bowditch 1996).
std::vector<double> simple_lengths(double a, double b, double boundary, double max_length) {
    const double x = 2 * std::cosh(a / 2), y = 2 * std::cosh(b / 2), largest = 2 * std::cosh(max_length / 2);
    const double constant = x * x + y * y - 2 + 2 * std::cosh(boundary / 2);
    const double root = std::sqrt(std::max(0.0, x * x * y * y - 4 * constant)), z = (x * y + root) / 2;
    std::vector<double> traces{x, y};
    struct Triple {
        double x, y, z;  // z is the newest and the largest
    };
    std::vector<Triple> stack{{x, y, z}, {x, y, constant / z}};
    while (!stack.empty()) {
        const Triple t = stack.back();
        stack.pop_back();
        if (t.z > largest) continue;
        traces.push_back(t.z);
        stack.push_back({t.x, t.z, t.x * t.z - t.y});
        stack.push_back({t.y, t.z, t.y * t.z - t.x});
    }
    std::vector<double> lengths = traces;
    for (double& l : lengths) l = 2 * std::acosh(l / 2);
    std::sort(lengths.begin(), lengths.end());
    return lengths;
}

/// A term of the identity that Mirzakhani (2007, theorem 4.2) gives for one boundary of length L: the sum
/// over simple closed geodesics is L. For L -> 0 it is McShane's: sum of 1 / (1 + e^l) = 1/2.
double mcshane_term(double boundary, double l) {
    return 2 * std::log((std::exp(boundary / 2) + std::exp(l)) / (std::exp(-boundary / 2) + std::exp(l)));
}

TEST(LengthSpectrum, SimpleGeodesicsOfAOneHoledTorusSatisfyMcShanesIdentity) {
    for (const double jitter : {0.0, 0.4}) {
        const CoarseSurface s = thinned(generated("punctured-torus", 500, jitter));
        const double longest = 9.0;
        const LengthSpectrum spectrum = spectrum_up_to(s, longest);
        double boundary = 0, sum = 0;
        std::vector<double> simple;
        for (std::size_t k = 0; k < spectrum.geodesics.size(); ++k) {
            const ClosedGeodesic& g = spectrum.geodesics[k];
            if (spectrum.boundary[k] >= 0) {
                EXPECT_EQ(boundary, 0.0);
                boundary = g.length;
                EXPECT_EQ(self_crossings(g, s), 0);
            } else if (self_crossings(g, s) == 0) {
                simple.push_back(g.length);
            }
        }
        ASSERT_GT(boundary, 0.0);
        ASSERT_GE(simple.size(), 10U);
        // The two shortest simple ones meet once; all others follow.
        expect_same_lengths(simple, simple_lengths(simple[0], simple[1], boundary, longest), 1e-7);
        for (const double l : simple) sum += mcshane_term(boundary, l);
        // Simple ones are as many as points of a lattice in a convex region (McShane, Rivin 1995): c l^2 up
        // to l, twice that to be safe. Terms are below 4 sinh(L/2) e^-l.
        const double density = static_cast<double>(simple.size()) / (longest * longest);
        const double tail =
            4 * std::sinh(boundary / 2) * 2 * density * 2 * (longest + 1) * std::exp(-longest);
        EXPECT_LT(sum, boundary);
        EXPECT_NEAR(sum, boundary, tail);
        EXPECT_LT(tail, 0.02 * boundary);
        // With all that follow from the two, up to length 60, nothing is left.
        double whole = 0;
        for (const double l : simple_lengths(simple[0], simple[1], boundary, 60.0))
            whole += mcshane_term(boundary, l);
        EXPECT_NEAR(whole, boundary, 1e-8);
    }
}

// ---- Boundaries

/// Number of lengths within 1e-8.
std::size_t count_of(const std::vector<double>& lengths, double length) {
    return static_cast<std::size_t>(
        std::count_if(lengths.begin(), lengths.end(), [&](double l) { return std::abs(l - length) < 1e-8; }));
}

TEST(LengthSpectrum, ASurfaceIsHalfOfItsDouble) {
    for (const char* name : {"pants", "punctured-torus", "genus-g-one-boundary"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 300, 0.3);
        const LengthSpectrum half = spectrum_up_to(thinned(mesh), 6.0);
        const std::vector<double> lengths = lengths_of(half),
                                  both = lengths_up_to(testing::glued_double(mesh), 6.0);
        // Interior geodesics lie in either copy, boundaries in both at once, others cross the mirror.
        std::size_t interior = 0, boundaries = 0;
        for (const SpectrumLength& l : half.lengths)
            (half.boundary[l.geodesic] < 0 ? interior : boundaries) += 1;
        EXPECT_GT(boundaries, 0U);
        EXPECT_GT(both.size(), 2 * interior + boundaries);
        for (const double length : lengths) {
            std::size_t expected = 0;
            for (const SpectrumLength& l : half.lengths)
                if (std::abs(l.length - length) < 1e-8) expected += half.boundary[l.geodesic] < 0 ? 2 : 1;
            EXPECT_GE(count_of(both, length), expected) << length;
        }
    }
}

TEST(LengthSpectrum, BoundariesAreNamedOnceAndHaveTheirLettersLength) {
    for (const char* name : {"pants", "punctured-torus", "genus-g-one-boundary"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 400, 0.3);
        const CoarseSurface s = thinned(mesh);
        const LengthSpectrum spectrum = spectrum_up_to(s, 6.5);
        const std::vector<Index> input = input_boundaries(s, mesh.connectivity);
        StructureOptions options;
        options.flow.tolerance = 1e-12;
        const SurfaceStructure structure = testing::structure_of(mesh, options);
        std::size_t named = 0;
        for (const GroupGenerator& g : structure.group.generators) {
            if (g.name[0] != 'c') continue;
            const Index component = std::stoi(g.name.substr(1)) - 1;
            std::vector<double> lengths;
            for (std::size_t k = 0; k < spectrum.geodesics.size(); ++k)
                if (spectrum.boundary[k] >= 0 && input[at(spectrum.boundary[k])] == component)
                    lengths.push_back(spectrum.geodesics[k].length);
            ASSERT_EQ(lengths.size(), 1U);
            EXPECT_NEAR(lengths[0], 2 * std::acosh(testing::trace_size(g.element) / 2), 1e-9);
            ++named;
        }
        EXPECT_EQ(named, static_cast<std::size_t>(s.boundaries));
    }
}

TEST(LengthSpectrum, PantsHaveThreeSimpleGeodesics) {
    // Their boundaries; the shortest other one is a figure eight around two of them, of trace
    // tr(a) tr(b) + tr(c), all traces taken positive.
    const CoarseSurface s = thinned(generated("pants", 300, 0.4));
    const LengthSpectrum spectrum = spectrum_up_to(s, 9.5);
    std::vector<double> trace;
    double eight = 1e300;
    for (std::size_t k = 0; k < spectrum.geodesics.size(); ++k) {
        const Index crossed = self_crossings(spectrum.geodesics[k], s);
        EXPECT_EQ(crossed == 0, spectrum.boundary[k] >= 0);
        if (crossed == 0) trace.push_back(2 * std::cosh(spectrum.geodesics[k].length / 2));
        if (crossed == 1) eight = std::min(eight, spectrum.geodesics[k].length);
    }
    ASSERT_EQ(trace.size(), 3U);
    EXPECT_NEAR(2 * std::cosh(eight / 2), trace[0] * trace[1] + trace[2], 1e-7);
}

// ---- What changes nothing

TEST(LengthSpectrum, NumbersAndScaleDoNotMatter) {
    for (const char* name : {"eight", "pants", "genus-g-one-boundary"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 600, 0.3);
        const std::vector<double> plain = lengths_up_to(mesh, 5.5);
        Random random(5);
        const std::vector<Index> number = random.permutation(mesh.connectivity.vertex_count);
        expect_same_lengths(lengths_up_to(testing::relabelled(mesh, number, random), 5.5), plain, 1e-9);
        for (const double scale : {1e-3, 1234.5}) {
            std::vector<Point> points = mesh.points;
            for (Point& p : points)
                for (double& x : p) x *= scale;
            const SurfaceMesh other = make_surface_mesh(std::move(points), triangles_of(mesh.connectivity));
            expect_same_lengths(lengths_up_to(other, 5.5), plain, 1e-9);
        }
    }
}

TEST(LengthSpectrum, TheCutOfFlatFacesDoesNotMatter) {
    for (const char* name : {"eight", "pants"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 400, 0.3);
        const std::vector<double> plain = lengths_up_to(mesh, 5.5);
        for (const std::uint64_t seed : {7, 8})
            expect_same_lengths(lengths_up_to(renumbered(testing::scrambled(mesh, 2000, seed), seed), 5.5),
                                plain, 1e-9);
    }
}

Point outside(const SurfaceMesh& mesh, double out) {
    Point high = mesh.points.front();
    for (const Point& p : mesh.points)
        for (std::size_t k = 0; k < 3; ++k) high[k] = std::max(high[k], p[k]);
    return {high[0] + out, high[1] + out / 2, high[2] + out};
}

TEST(LengthSpectrum, AMoebiusInversionChangesNothing) {
    FlowOptions as_it_is;
    as_it_is.delaunay = false;
    for (const char* name : {"eight", "pants", "punctured-torus"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 600, 0.2);
        const SurfaceMesh other = testing::inverted(mesh, outside(mesh, 1.0));
        expect_same_lengths(lengths_up_to(other, 5.5, as_it_is), lengths_up_to(mesh, 5.5, as_it_is), 1e-8);
    }
    // With Delaunay flips where both are Delaunay.
    const SurfaceMesh mesh = generated("eight", 400), other = testing::inverted(mesh, outside(mesh, 10.0));
    ASSERT_EQ(count_non_delaunay(intrinsic_triangulation<double>(mesh), {}), 0);
    ASSERT_EQ(count_non_delaunay(intrinsic_triangulation<double>(other), {}), 0);
    expect_same_lengths(lengths_up_to(other, 5.5), lengths_up_to(mesh, 5.5), 1e-8);
}

TEST(LengthSpectrum, SameBitsForAnyNumberOfThreads) {
    const SurfaceMesh mesh = generated("eight", 3000, 0.3);
    std::vector<std::vector<double>> lengths(3);
    for (int threads = 1; threads <= 3; ++threads)
        with_thread_limit(threads, [&] {
            FlowOptions options;
            options.parallel = threads > 1;
            lengths[at(threads - 1)] = lengths_up_to(mesh, 5.0, options);
        });
    EXPECT_FALSE(lengths[0].empty());
    EXPECT_EQ(lengths[0], lengths[1]);
    EXPECT_EQ(lengths[0], lengths[2]);
}

// ---- Short ones, many, counts and budgets

/// A row of two rings, stretched: their tubes become long and thin.
SurfaceMesh stretched(double factor) {
    SurfaceMesh mesh = generated("eight", 1500, 0.2);
    for (Point& p : mesh.points) p[0] *= factor;
    return make_surface_mesh(std::move(mesh.points), triangles_of(mesh.connectivity));
}

TEST(LengthSpectrum, ShortGeodesicsComeWithAllTheirPowers) {
    const CoarseSurface s = thinned(stretched(24));
    const ClosedGeodesics found = find_closed_geodesics(s, 4.0);
    EXPECT_EQ(found.missed, 0);
    const LengthSpectrum spectrum = spectrum_up_to(s, 4.0);
    const double systole = spectrum.lengths[0].length;
    EXPECT_LT(systole, 0.2);
    EXPECT_GT(systole, 0.02);
    Index power = 0;
    for (const SpectrumLength& l : spectrum.lengths) {
        if (l.geodesic != 0) continue;
        EXPECT_EQ(l.power, ++power);
        EXPECT_EQ(l.length, power * spectrum.geodesics[0].length);
    }
    EXPECT_EQ(power, static_cast<Index>(4.0 / systole));
    // The collar lemma: what crosses a geodesic of length l is longer than 2 arsinh(1 / sinh(l/2)).
    for (std::size_t k = 1; k < spectrum.geodesics.size(); ++k)
        if (crossings(spectrum.geodesics[0], spectrum.geodesics[k], s) > 0) {
            EXPECT_GT(spectrum.geodesics[k].length, 2 * std::asinh(1 / std::sinh(systole / 2)));
        }
    EXPECT_EQ(self_crossings(spectrum.geodesics[0], s), 0);
}

TEST(LengthSpectrum, HundredsAreFound) {
    const CoarseSurface s = thinned(generated("eight", 600, 0.3));
    const std::vector<double> many = lengths_of(spectrum_up_to(s, 8.0));
    EXPECT_GT(many.size(), 200U);
    const std::vector<double> few = lengths_of(spectrum_up_to(s, 5.0));
    expect_same_lengths({many.begin(), many.begin() + static_cast<std::ptrdiff_t>(few.size())}, few, 1e-10);
    EXPECT_GT(many[few.size()], 5.0);
}

TEST(LengthSpectrum, CountsFinishTheirMultiplet) {
    const CoarseSurface s = thinned(make_bolza());
    const std::vector<double> exact = bolza_lengths(8.0);
    for (const std::int64_t count : {1, 12, 13, 24, 25, 48, 49, 61}) {
        SpectrumOptions options;
        options.count = count;
        const std::vector<double> found = lengths_of(length_spectrum(s, options));
        std::size_t expected = static_cast<std::size_t>(count);
        while (exact[expected] < exact[expected - 1] + 1e-9) ++expected;
        EXPECT_EQ(found.size(), expected) << count;
    }
}

TEST(LengthSpectrum, CompletenessIsNeverClaimedBeyondTheList) {
    const CoarseSurface s = thinned(generated("eight", 600, 0.3));
    const std::vector<double> all = lengths_of(spectrum_up_to(s, 7.0));
    const auto expect_honest = [&](const LengthSpectrum& found) {
        const std::vector<double> lengths = lengths_of(found);
        const auto up_to = static_cast<std::size_t>(
            std::upper_bound(all.begin(), all.end(), found.complete_up_to * (1 + 1e-12)) - all.begin());
        ASSERT_LE(up_to, lengths.size());
        for (std::size_t k = 0; k < up_to; ++k) EXPECT_NEAR(lengths[k], all[k], 1e-10);
    };
    for (const std::int64_t count : {1, 2, 3, 5, 8, 13, 20}) {
        SpectrumOptions options;
        options.count = count;
        const LengthSpectrum found = length_spectrum(s, options);
        EXPECT_GE(found.lengths.size(), static_cast<std::size_t>(count));
        EXPECT_GE(found.complete_up_to, found.lengths.back().length * (1 - 1e-12));
        expect_honest(found);
    }
    const std::int64_t needed = spectrum_up_to(s, 7.0).crossed;
    for (const std::int64_t part : {2, 10, 100, 1000}) {
        for (const std::int64_t count : {0, 40}) {
            SpectrumOptions options;
            options.max_length = 7.0;
            options.count = count;
            options.budget = needed / part;
            const LengthSpectrum found = length_spectrum(s, options);
            EXPECT_LT(found.complete_up_to, 7.0);
            EXPECT_LE(found.crossed, options.budget);
            expect_honest(found);
        }
    }
    SpectrumOptions half;
    half.max_length = 7.0;
    half.budget = needed / 2;
    EXPECT_GT(length_spectrum(s, half).complete_up_to, 3.0) << "gave up too early";
}

TEST(LengthSpectrum, InnerOnesAreCountedBeyondTheLength) {
    const CoarseSurface s = thinned(generated("pants", 300, 0.4));
    SpectrumOptions options;
    options.max_length = 4.0;
    options.inner_count = 8;
    const LengthSpectrum found = length_spectrum(s, options);
    EXPECT_GE(std::count(found.boundary.begin(), found.boundary.end(), -1), 5);
    EXPECT_GT(found.complete_up_to, 4.0);
    expect_same_lengths(lengths_of(found), lengths_of(spectrum_up_to(s, found.complete_up_to)), 1e-10);
}

}  // namespace
}  // namespace ricci
