// The length spectrum of a mesh of any topology: units, powers, words, names of boundaries, refusals.
#include "engine/shape_space/surface_spectrum.h"

#include "kernels/parallel.h"
#include "tests/engine/shape_space/curve_checks.h"

namespace ricci {
namespace {

using testing::generated;

SurfaceSpectrum spectrum_of(const SurfaceMesh& mesh, double max_length, bool draw = false) {
    SurfaceSpectrumOptions options;
    options.max_length = max_length;
    options.draw = draw;
    SurfaceSpectrum s = make_surface_spectrum(mesh, options);
    EXPECT_EQ(s.status, Status::converged) << s.message;
    return s;
}

/// Lists fit together, powers are multiples, words have their lengths.
void expect_consistent(const SurfaceSpectrum& s, double unit = 1.0) {
    ASSERT_FALSE(s.lengths.empty());
    ASSERT_EQ(s.lengths.size(), s.power.size());
    ASSERT_EQ(s.lengths.size(), s.geodesic.size());
    EXPECT_TRUE(std::is_sorted(s.lengths.begin(), s.lengths.end()));
    std::map<std::size_t, std::vector<Index>> powers;
    for (std::size_t k = 0; k < s.lengths.size(); ++k) {
        EXPECT_LE(s.lengths[k], s.complete_up_to * (1 + 1e-8));
        EXPECT_NEAR(s.lengths[k], s.power[k] * s.geodesics.at(s.geodesic[k]).length, 1e-9 * s.lengths[k]);
        powers[s.geodesic[k]].push_back(s.power[k]);
    }
    EXPECT_EQ(powers.size(), s.geodesics.size());
    for (const auto& [geodesic, list] : powers) {
        for (std::size_t k = 0; k < list.size(); ++k) EXPECT_EQ(list[k], static_cast<Index>(k) + 1);
        EXPECT_GT((static_cast<double>(list.size()) + 1) * s.geodesics[geodesic].length,
                  s.complete_up_to * (1 - 1e-8))
            << "a power is wanting";
    }
    for (const SurfaceGeodesic& g : s.geodesics) {
        const Word word = testing::word_of(g.word, s.structure.group);
        EXPECT_NEAR(word_length(s.structure, word), g.length * unit, 1e-6 * g.length * unit) << g.word;
    }
    EXPECT_LE(s.word_error, 1e-6);
    EXPECT_LE(s.relator_error, 1e-8);
}

TEST(SurfaceSpectrum, TorusOfRevolutionConvergesWithSecondOrder) {
    // Modulus i sqrt((R/r)^2 - 1): lengths |m + n tau|.
    const double tau = std::sqrt(2.5 * 2.5 - 1);
    const std::vector<double> exact{1, 2, tau, 2.5, 2.5, 3, std::hypot(2, tau), std::hypot(2, tau)};
    std::vector<double> error;
    for (const Index faces : {1000, 4000, 16000}) {
        const SurfaceMesh mesh = generated("torus", faces);
        const SurfaceSpectrum s = spectrum_of(mesh, 3.2);
        EXPECT_EQ(s.geometry, Geometry::euclidean);
        EXPECT_EQ(s.genus, 1);
        EXPECT_EQ(s.unit, "in units of the shortest");
        ASSERT_EQ(s.lengths.size(), exact.size());
        EXPECT_EQ(s.lengths[0], 1.0);
        double worst = 0;
        for (std::size_t k = 0; k < exact.size(); ++k)
            worst = std::max(worst, std::abs(s.lengths[k] / exact[k] - 1));
        error.push_back(worst);
        // On area 1 the shortest is tau^(-1/2).
        const double unit =
            word_length(s.structure, testing::word_of(s.geodesics[0].word, s.structure.group));
        EXPECT_NEAR(unit, 1 / std::sqrt(tau), 0.01);
        expect_consistent(s, unit);
    }
    EXPECT_LT(error[2], 1e-3);
    for (std::size_t k = 1; k < error.size(); ++k) {
        const double order = std::log2(error[k - 1] / error[k]);
        EXPECT_NEAR(order, 2.0, 0.3);
    }
}

TEST(SurfaceSpectrum, KittenIsTheThesissWithinHalfAPercent) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g1/kitten.obj");
    const std::vector<double> printed{1.0000, 2.0000, 2.1716, 2.3889,
                                      2.3926, 2.9493, 2.9552, 2.9999};  // Table 2
    const SurfaceMesh mesh = testing::load_component(path);
    SurfaceSpectrumOptions options;
    options.count = 8;
    options.words = false;
    const SurfaceSpectrum s = make_surface_spectrum(mesh, options);
    ASSERT_GE(s.lengths.size(), printed.size());
    for (std::size_t k = 0; k < printed.size(); ++k)
        EXPECT_NEAR(s.lengths[k], printed[k], 0.005 * printed[k]);
}

TEST(SurfaceSpectrum, AnnulusHasItsCoreAndPowers) {
    const SurfaceMesh mesh = generated("annulus", 400);
    const SurfaceSpectrum s = spectrum_of(mesh, 4.5, true);
    EXPECT_EQ(s.lengths, (std::vector<double>{1, 2, 3, 4}));
    EXPECT_EQ(s.power, (std::vector<Index>{1, 2, 3, 4}));
    ASSERT_EQ(s.geodesics.size(), 1U);
    EXPECT_EQ(s.unit, "in units of the core");
    const Word word = testing::word_of(s.geodesics[0].word, s.structure.group);
    testing::expect_on_surface(mesh, s.geodesics[0].curve, word_length(s.structure, word));
}

TEST(SurfaceSpectrum, TorusGeodesicsAreDrawn) {
    const SurfaceMesh mesh = generated("torus", 1500, 0.3);
    const SurfaceSpectrum s = spectrum_of(mesh, 4.0, true);
    const double unit = word_length(s.structure, testing::word_of(s.geodesics[0].word, s.structure.group));
    EXPECT_GE(s.geodesics.size(), 7U);
    expect_consistent(s, unit);
    for (const SurfaceGeodesic& g : s.geodesics) testing::expect_on_surface(mesh, g.curve, g.length * unit);
}

TEST(SurfaceSpectrum, HyperbolicOnesHaveWordsOfTheirLength) {
    for (const auto& [name, max_length] : std::vector<std::pair<std::string, double>>{
             {"eight", 5.5}, {"pants", 9.5}, {"punctured-torus", 6.0}, {"genus-g-one-boundary", 6.5}}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 500, 0.3);
        const SurfaceSpectrum s = spectrum_of(mesh, max_length);
        EXPECT_EQ(s.complete_up_to, max_length);
        EXPECT_EQ(s.geometry, Geometry::hyperbolic);
        EXPECT_EQ(s.message, "");
        expect_consistent(s);
        std::vector<Index> named;
        for (const SurfaceGeodesic& g : s.geodesics) {
            EXPECT_TRUE(g.curve.points.empty());
            if (g.boundary < 0) continue;
            named.push_back(g.boundary);
            // A boundary is conjugate to its own letter: of the same length.
            const Word letter = testing::word_of("c" + std::to_string(g.boundary + 1), s.structure.group);
            EXPECT_NEAR(word_length(s.structure, letter), g.length, 1e-9);
        }
        std::sort(named.begin(), named.end());
        ASSERT_EQ(named.size(), static_cast<std::size_t>(s.boundaries));
        for (std::size_t k = 0; k < named.size(); ++k) EXPECT_EQ(named[k], static_cast<Index>(k));
    }
}

TEST(SurfaceSpectrum, EightAndThreeHolesHaveWordsOfTheirLength) {
    RICCI_DATA_FILE_OR_SKIP(eight, "meshes/closed_g2/eight.off");
    RICCI_DATA_FILE_OR_SKIP(holes, "meshes/closed_g3/3holes.off");
    for (const std::string& path : {eight, holes}) {
        const SurfaceMesh mesh = testing::load_component(path);
        expect_consistent(spectrum_of(mesh, 5.0));
    }
}

TEST(SurfaceSpectrum, LengthsAloneAreTheSame) {
    const SurfaceMesh mesh = generated("eight", 500, 0.3);
    SurfaceSpectrumOptions options;
    options.max_length = 5.5;
    options.words = false;
    const SurfaceSpectrum plain = make_surface_spectrum(mesh, options), whole = spectrum_of(mesh, 5.5);
    testing::expect_same_lengths(plain.lengths, whole.lengths, 1e-9);
    EXPECT_EQ(plain.geodesics[0].word, "");
}

TEST(SurfaceSpectrum, CountsAndDrawnOnesAreKept) {
    const SurfaceMesh mesh = generated("eight", 500, 0.3);
    SurfaceSpectrumOptions options;
    options.count = 7;
    options.draw = true;
    options.drawn = 3;
    const SurfaceSpectrum s = make_surface_spectrum(mesh, options);
    EXPECT_GE(s.lengths.size(), 7U);
    EXPECT_GE(s.complete_up_to, s.lengths.back());
    expect_consistent(s);
    std::size_t drawn = 0;
    for (std::size_t k = 0; k < s.geodesics.size(); ++k) {
        EXPECT_EQ(!s.geodesics[k].curve.points.empty(), k < 3);
        drawn += s.geodesics[k].curve.points.empty() ? 0 : 1;
    }
    EXPECT_EQ(drawn, 3U);
}

TEST(SurfaceSpectrum, SpheresAndDisksAreRefused) {
    for (const char* name : {"sphere", "disk"}) {
        try {
            make_surface_spectrum(generated(name, 100), {});
            FAIL() << "no exception for a " << name;
        } catch (const std::invalid_argument& e) {
            EXPECT_NE(std::string(e.what()).find("no length spectrum"), std::string::npos);
            EXPECT_NE(std::string(e.what()).find("teichmuller"), std::string::npos)
                << "says what to do instead";
        }
    }
}

TEST(SurfaceSpectrum, AFailedFlowIsAStatus) {
    SurfaceSpectrumOptions options;
    options.flow.max_iterations = 1;
    for (const char* name : {"eight", "pants", "torus"}) {
        const SurfaceMesh mesh = generated(name, 500, 0.3);
        const SurfaceSpectrum s = make_surface_spectrum(mesh, options);
        EXPECT_EQ(s.status, Status::max_iterations) << name;
        EXPECT_FALSE(s.message.empty());
        EXPECT_TRUE(s.lengths.empty());
    }
}

TEST(SurfaceSpectrum, SameBitsForAnyNumberOfThreads) {
    for (const char* name : {"eight", "pants", "torus"}) {
        const SurfaceMesh mesh = generated(name, 1500, 0.3);
        std::vector<SurfaceSpectrum> all;
        for (int threads = 1; threads <= 3; ++threads)
            with_thread_limit(threads, [&] {
                SurfaceSpectrumOptions options;
                options.flow.parallel = threads > 1;
                options.draw = true;
                all.push_back(make_surface_spectrum(mesh, options));
            });
        for (const SurfaceSpectrum& s : all) {
            EXPECT_FALSE(s.lengths.empty());
            EXPECT_EQ(s.lengths, all[0].lengths);
            ASSERT_EQ(s.geodesics.size(), all[0].geodesics.size());
            for (std::size_t k = 0; k < s.geodesics.size(); ++k) {
                EXPECT_EQ(s.geodesics[k].word, all[0].geodesics[k].word);
                EXPECT_EQ(s.geodesics[k].curve.points, all[0].geodesics[k].curve.points);
            }
        }
    }
}

}  // namespace
}  // namespace ricci
