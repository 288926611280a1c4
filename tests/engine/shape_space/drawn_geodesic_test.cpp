// Closed geodesics on the surface: they close, are as long as they should be, lie on it, and their words say
// so.
#include "engine/shape_space/drawn_geodesic.h"

#include "tests/engine/shape_space/curve_checks.h"

namespace ricci {
namespace {

using testing::generated;

/// All geodesics up to a length: curves, and three ways to their length that do not know of the spectrum:
/// along the curve, by the canonical word, by the loops of the homotopy basis.
void expect_drawn(const SurfaceMesh& mesh, double max_length, std::size_t at_least) {
    const SurfaceStructure s = make_sharp_structure(mesh, {}, 19);
    ASSERT_EQ(s.flow.outcome.status, Status::converged);
    const CoarseSurface coarse = coarse_surface_of(mesh, s.flow, true, &*s.refinement, &*s.metric);
    const ClosedGeodesics all = find_closed_geodesics(coarse, max_length);
    EXPECT_EQ(all.missed, 0);
    EXPECT_GE(all.primitive.size(), at_least);
    for (const ClosedGeodesic& g : all.primitive) {
        const SurfaceCurve curve = draw_geodesic(s, mesh.connectivity, coarse, g);
        SCOPED_TRACE("length " + std::to_string(g.length));
        testing::expect_on_surface(mesh, curve, g.length);
        // Products in double: a word of n letters, each some e^2 in size, that cancels loses digits.
        const Word word = canonical_word(s, curve.path);
        EXPECT_EQ(word, cyclically_reduced(word));
        EXPECT_NEAR(word_length(s, word), g.length, 1e-6 * g.length);
        EXPECT_NEAR(loop_length(s, curve.path), g.length, 1e-7 * g.length);
        // The path is a closed one.
        ASSERT_FALSE(curve.path.empty());
        EXPECT_EQ(step_tail(mesh.connectivity, curve.path.front()),
                  step_head(mesh.connectivity, curve.path.back()));
        EdgePath twice = curve.path;
        twice.insert(twice.end(), curve.path.begin(), curve.path.end());
        EXPECT_NEAR(loop_length(s, twice), 2 * g.length, 1e-6 * g.length);
        if (::testing::Test::HasFailure()) return;
    }
}

TEST(DrawnGeodesic, EveryOneOfTheEight) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight.off");
    expect_drawn(testing::load_component(path), 5.0, 12);
}

TEST(DrawnGeodesic, EveryOneOfThreeHoles) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g3/3holes.off");
    expect_drawn(testing::load_component(path), 5.0, 13);
}

TEST(DrawnGeodesic, EveryOneOfGeneratedSurfaces) {
    expect_drawn(generated("eight", 500, 0.4), 6.0, 40);
    expect_drawn(generated("genus-g", 900, 0.3, 4), 4.0, 8);
    expect_drawn(generated("pants", 300, 0.4), 10.0, 6);
    expect_drawn(generated("punctured-torus", 300, 0.4), 6.0, 10);
    expect_drawn(generated("genus-g-one-boundary", 500, 0.3), 5.0, 10);
}

TEST(DrawnGeodesic, EveryBoundaryOfRealPants) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/pants/aqua-center.off");
    expect_drawn(testing::load_component(path), 9.0, 3);
}

TEST(DrawnGeodesic, WordsOfOtherClassesHaveOtherLengths) {
    const SurfaceMesh mesh = generated("eight", 500, 0.4);
    const SurfaceStructure s = make_sharp_structure(mesh, {}, 19);
    const double a = word_length(s, Word{1}), b = word_length(s, Word{2});
    EXPECT_GT(a, 0.5);
    EXPECT_NEAR(word_length(s, Word{-1}), a, 1e-12);
    EXPECT_NEAR(word_length(s, Word{1, 1, 1}), 3 * a, 1e-9);
    EXPECT_NEAR(word_length(s, Word{2, 1, -2}), a, 1e-9);
    EXPECT_EQ(word_length(s, Word{}), 0.0);
    // tr(ab) + tr(ab^-1) = tr(a) tr(b), for one choice of signs.
    const double x = 2 * std::cosh(word_length(s, Word{1, 2}) / 2),
                 y = 2 * std::cosh(word_length(s, Word{1, -2}) / 2);
    EXPECT_NEAR(x + y, 4 * std::cosh(a / 2) * std::cosh(b / 2), 1e-8 * (x + y));
}

}  // namespace
}  // namespace ricci
