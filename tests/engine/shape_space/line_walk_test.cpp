#include "engine/shape_space/line_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/quality/piece_image.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::generated;
using testing::structure_of;
using Vector = std::array<double, 3>;

/// The translation by `length` along the x axis, seen from a frame that was moved by `frame`.
Isometry<double> translation(int kappa, double length, const Isometry<double>& frame) {
    const Isometry<double> along =
        kappa == 0 ? Isometry<double>{{1, 0}, {length / 2, 0}}
                   : Isometry<double>{{std::cosh(length / 2), 0}, {std::sinh(length / 2), 0}};
    return compose(kappa, compose(kappa, frame, along), inverse(frame));
}

Isometry<double> some_frame(int kappa) {
    const Isometry<double> shift = kappa == 0 ? Isometry<double>{{1, 0}, {0.3, -0.7}}
                                              : Isometry<double>{{std::cosh(0.4), 0}, {0, std::sinh(0.4)}};
    return compose(kappa, shift, {{std::cos(0.8), std::sin(0.8)}, {}});
}

TEST(Line, OfATranslationIsItsAxis) {
    for (const int kappa : {0, -1}) {
        const Isometry<double> frame = some_frame(kappa);
        const Isometry<double> element = translation(kappa, 1.7, frame);
        EXPECT_NEAR(translation_length(kappa, element), 1.7, 1e-14);
        const std::optional<LineNormal> axis = translation_axis(kappa, element);
        ASSERT_TRUE(axis);
        const LineNormal expected = moved_line(kappa, frame, {0, 1, 0});  // the x axis, its left above
        for (std::size_t i = 0; i < 2 + (kappa < 0 ? 1U : 0U); ++i)
            EXPECT_NEAR((*axis)[i], expected[i], 1e-14);
        const Vector on = image_of_origin(kappa, frame);
        EXPECT_NEAR(line_side(kappa, expected, on), 0, 1e-14);
        const Vector left =
            apply(kappa, frame, {0, kappa < 0 ? std::sinh(0.2) : 0.2, kappa < 0 ? std::cosh(0.2) : 1});
        EXPECT_NEAR(line_side(kappa, expected, left), kappa < 0 ? std::sinh(0.2) : 0.2, 1e-14);
        // Against the sign of the matrix, which means nothing.
        const Isometry<double> minus{{-element.a.re, -element.a.im}, {-element.b.re, -element.b.im}};
        EXPECT_NEAR((*translation_axis(kappa, minus))[0], (*axis)[0], 1e-14);
        // The line across is positive ahead.
        const LineNormal across = line_across(kappa, expected, on);
        EXPECT_NEAR(line_side(kappa, across, on), 0, 1e-14);
        EXPECT_GT(line_side(kappa, across, apply(kappa, element, on)), 1.0);
    }
    EXPECT_FALSE(translation_axis(-1, {{0.6, 0.8}, {}}));
    EXPECT_FALSE(translation_axis(0, {{0.6, 0.8}, {0.3, 0}}));
}

/// Weights of a piece's corners are a linear function of (x, y, 1) in the flat metric: any four corners show
/// it.
TEST(LineWalk, WeightsAreLinearInThePlaceInTheFlatMetric) {
    const SurfaceMesh mesh = testing::scrambled(generated("genus-g", 600, 0.4, 2), 2000, 5);
    const SurfaceStructure structure = structure_of(mesh);
    const CommonRefinement& r = *structure.refinement;
    int tested = 0;
    double worst = 0;
    for (Index p = 0; p < r.piece_count(); ++p) {
        const Index a = r.first[at(p)];
        if (r.first[at(p) + 1] - a < 4) continue;
        const auto& f = r.flat;
        const auto doubled = [&](Index i, Index j, Index k) {
            return (f[at(j)][0] - f[at(i)][0]) * (f[at(k)][1] - f[at(i)][1]) -
                   (f[at(j)][1] - f[at(i)][1]) * (f[at(k)][0] - f[at(i)][0]);
        };
        const double whole = doubled(a, a + 1, a + 2);
        double perimeter = 0;
        for (Index c = a; c < r.first[at(p) + 1]; ++c)
            perimeter += std::hypot(f[at(r.next(c))][0] - f[at(c)][0], f[at(r.next(c))][1] - f[at(c)][1]);
        if (whole < 1e-3 * perimeter * perimeter) continue;  // too thin to predict from
        const std::array<double, 3> share{doubled(a + 3, a + 1, a + 2) / whole,
                                          doubled(a, a + 3, a + 2) / whole, doubled(a, a + 1, a + 3) / whole};
        for (std::size_t k = 0; k < 3; ++k) {
            double predicted = 0;
            for (std::size_t i = 0; i < 3; ++i) predicted += share[i] * r.weight[at(a) + i][k];
            worst = std::max(worst, std::abs(predicted - r.weight[at(a) + 3][k]));
        }
        ++tested;
    }
    EXPECT_GT(tested, 100);
    EXPECT_LE(worst, 1e-12);
}

TEST(LineWalk, SeesAPointOfASideFromBothPieces) {
    const SurfaceMesh mesh = generated("genus-g", 600, 0.4, 2);
    const SurfaceStructure structure = structure_of(mesh);
    const CommonRefinement& r = *structure.refinement;
    const LineWalk walk(r, *structure.metric);
    double worst = 0;
    for (Index c = 0; c < r.corner_count(); ++c) {
        const SidePoint here{c, 0.3}, there = walk.across(here);
        Vector x = walk.position(there);
        const Index g = r.final_halfedge[at(c)];
        if (g >= 0) x = apply(-1, structure.metric->crossing(r.final_triangulation.connectivity, g), x);
        worst = std::max(worst, point_distance(-1, walk.position(here), x));
        const Point p = walk.in_space(here), q = walk.in_space(there);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(p[i], q[i], 1e-12);
    }
    EXPECT_LE(worst, 1e-12);
}

TEST(LineWalk, LeavesByAnotherSideWhateverTheSignsSay) {
    const SurfaceMesh mesh = generated("genus-g", 600, 0.4, 2);
    const SurfaceStructure structure = structure_of(mesh);
    const CommonRefinement& r = *structure.refinement;
    LineWalk walk(r, *structure.metric);
    for (Index c = 0; c < r.corner_count(); ++c) {
        // The whole piece on the right of the line, but for the start of the side that was entered; or on the
        // left, but for its end.
        EXPECT_EQ(walk.from({c, 0.5}, {0, 0, 1}).exit.corner, r.previous(c));
        EXPECT_EQ(walk.from({c, 0.5}, {0, 0, -1}).exit.corner, r.next(c));
    }
}

TEST(LineWalk, GoesOnFromAnyPieceWithoutGettingStuck) {
    const SurfaceMesh mesh = generated("bolza", 400);
    const SurfaceStructure structure = structure_of(mesh);
    const CommonRefinement& r = *structure.refinement;
    LineWalk walk(r, *structure.metric);
    testing::Random random(3);
    int tried = 0;
    for (int trial = 0; trial < 200; ++trial) {
        // Through a corner of the face, or along its first side, exactly.
        const Index piece = random.below(r.piece_count());
        const double angle = trial % 5 == 0 ? 0.0 : random.uniform(0.0, 2 * std::numbers::pi);
        const LineNormal line{-std::sin(angle), std::cos(angle), 0.0};
        std::optional<Passage> passage = walk.through(piece, line);
        if (!passage) continue;
        ++tried;
        double length = 0;
        Index steps = 0;
        while (length < 6) {
            ASSERT_LT(++steps, 5000);
            *passage = walk.next(*passage);
            length += passage->length;
            EXPECT_NEAR(line_side(-1, passage->normal, walk.position(passage->exit)), 0.0, 1e-8);
        }
    }
    EXPECT_GT(tried, 50);
}

}  // namespace
}  // namespace ricci
