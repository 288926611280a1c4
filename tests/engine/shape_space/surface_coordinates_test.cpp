#include "engine/shape_space/surface_coordinates.h"

#include <gtest/gtest.h>

#include "engine/shape_space/drawn_geodesic.h"
#include "engine/surfaces/generate.h"
#include "tests/engine/shape_space/marked_surface.h"

namespace ricci {
namespace {

using testing::bent_row;

SurfaceCoordinates drawn(const SurfaceMesh& mesh) {
    SurfaceCoordinateOptions options;
    options.draw = true;
    return make_surface_coordinates(mesh, options);
}

class Coordinates : public ::testing::TestWithParam<testing::RowType> {};

/// Every coordinate is the measured length of a curve on the surface, and of its edge path by the group; with
/// these paths as marking, and as loops, come the same lengths and words.
TEST_P(Coordinates, AreLengthsOfDrawnCurves) {
    const SurfaceMesh mesh = bent_row(GetParam().rings, GetParam().part);
    const SurfaceCoordinates s = drawn(mesh);
    ASSERT_EQ(s.status, Status::converged) << s.message;
    EXPECT_EQ(s.message, "");
    EXPECT_EQ(s.marking, "geometric");
    EXPECT_EQ(s.genus, GetParam().genus);
    EXPECT_EQ(s.boundaries, GetParam().boundaries);
    ASSERT_EQ(s.curves.size(), s.coordinates.size());
    EXPECT_EQ(s.seams.has_value(), s.genus == 0 && s.boundaries == 3);
    SurfaceCoordinateOptions given;
    for (std::size_t k = 0; k < s.curves.size(); ++k) {
        const CoordinateCurve& c = s.curves[k];
        EXPECT_EQ(c.name, s.names[k]);
        EXPECT_NEAR(c.curve.length, s.coordinates[k], 1e-7) << c.name;
        EXPECT_LT(c.curve.closing_error, 1e-6) << c.name;
        EXPECT_FALSE(c.word.empty());
        given.marking_curves.push_back({c.name, c.curve.path});
    }
    given.loops = given.marking_curves;
    const SurfaceCoordinates again = make_surface_coordinates(mesh, given);
    EXPECT_EQ(again.marking, "curves");
    ASSERT_EQ(again.coordinates.size(), s.coordinates.size());
    for (std::size_t k = 0; k < s.curves.size(); ++k) {
        EXPECT_NEAR(again.coordinates[k] / s.coordinates[k], 1, 1e-7) << s.names[k];
        EXPECT_EQ(again.names[k], s.names[k]);
        EXPECT_EQ(again.curves[k].word, s.curves[k].word);
        EXPECT_EQ(again.loops[k].word, s.curves[k].word);
        EXPECT_EQ(again.loops[k].length, again.coordinates[k]);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Types, Coordinates,
    ::testing::Values(testing::RowType{2, 0, 2, RowPart::whole}, testing::RowType{0, 3, 2, RowPart::upper},
                      testing::RowType{1, 1, 2, RowPart::right}, testing::RowType{0, 4, 3, RowPart::upper}),
    [](const auto& row) {
        return "g" + std::to_string(row.param.genus) + "b" + std::to_string(row.param.boundaries);
    });

/// Loops along the canonical generators: their words are their names, their lengths those of the generators.
TEST(SurfaceCoordinates, WordsOfTheGenerators) {
    const SurfaceMesh mesh = bent_row(2, RowPart::whole);
    const SurfaceStructure structure = make_sharp_structure(mesh, {}, 800);
    SurfaceCoordinateOptions options;
    for (const GroupGenerator& g : structure.group.generators)
        options.loops.push_back({g.name, structure.basis->walk(g.word)});
    const SurfaceCoordinates s = make_surface_coordinates(mesh, options);
    ASSERT_EQ(s.loops.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(s.loops[k].word, s.loops[k].name);
        EXPECT_NEAR(s.loops[k].length, translation_length(structure.group.generators[k].element), 1e-7);
    }
}

TEST(SurfaceCoordinates, DoNotDependOnWhetherWordsAreAskedFor) {
    for (const RowPart part : {RowPart::whole, RowPart::upper}) {
        const SurfaceMesh mesh = bent_row(2, part);
        SurfaceCoordinateOptions plain;
        plain.words = false;
        const SurfaceCoordinates a = make_surface_coordinates(mesh, plain),
                                 b = make_surface_coordinates(mesh, {});
        EXPECT_LT(testing::difference(a.coordinates, b.coordinates), 1e-8);
        EXPECT_TRUE(a.curves[0].word.empty());
    }
}

TEST(SurfaceCoordinates, RefuseCurvesWhereThereAreNone) {
    const SurfaceMesh torus = testing::bumpy_torus(8, 6), square = testing::wavy_square(4);
    SurfaceCoordinateOptions marking, loops;
    marking.marking_curves.push_back({"a", {0, 1, 2}});
    loops.loops.push_back({"a", {0, 1, 2}});
    EXPECT_THROW(make_surface_coordinates(torus, marking), std::invalid_argument);
    EXPECT_THROW(make_surface_coordinates(square, marking), std::invalid_argument);
    EXPECT_THROW(make_surface_coordinates(square, loops), std::invalid_argument);
    const SurfaceCoordinates t = make_surface_coordinates(torus, loops);
    ASSERT_EQ(t.loops.size(), 1U);
    EXPECT_EQ(t.loops[0].length, 0.0) << "around a face";
    EXPECT_EQ(t.loops[0].word, "1");
    EXPECT_EQ(t.names, (std::vector<std::string>{"modulus_re", "modulus_im"}));
}

}  // namespace
}  // namespace ricci
