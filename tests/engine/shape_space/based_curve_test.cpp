#include "engine/shape_space/based_curve.h"

#include <gtest/gtest.h>

#include "tests/engine/shape_space/marked_surface.h"

namespace ricci {
namespace {

using testing::at;
using testing::bent_row;
using testing::marked;
using testing::MarkedSurface;

double miss(const Isometry<Exact>& x) {
    return static_cast<double>(distance_to_identity(x));
}

/// Moving to the axis changes the base point, not the class; `carried` says how.
TEST(BasedCurve, MovesToItsAxis) {
    const MarkedSurface m = marked(bent_row(3, RowPart::right));
    for (const LengthCoordinate& c : m.coordinates.lengths) {
        Isometry<Exact> carried;
        const BasedCurve moved = moved_to_axis(*m.exact, c.curve, &carried);
        EXPECT_NEAR(translation_length(moved.element), c.length, 1e-12) << c.name;
        EXPECT_LT(miss(product(conjugated(moved.element, carried), inverse(c.curve.element))), 1e-30)
            << c.name;
        EXPECT_LE(std::abs(axis_normal(moved.element)[2]),
                  std::sinh(m.coarse->radius[at(moved.vertex)]) * (1 + 1e-9))
            << c.name;
    }
}

/// At every pass the element, carried there, runs along the pass; they are those of follow_geodesic.
TEST(BasedCurve, FollowsItsGeodesic) {
    const MarkedSurface m = marked(bent_row(2, RowPart::whole));
    for (const LengthCoordinate& c : m.coordinates.lengths) {
        const BasedCurve on_axis = moved_to_axis(*m.exact, c.curve);
        const BasedGeodesic g = follow_curve(*m.exact, on_axis);
        ASSERT_EQ(g.frames.size(), g.geodesic.passes.size());
        for (std::size_t k = 0; k < g.frames.size(); ++k) {
            EXPECT_TRUE(same_normal(axis_normal(g.at_pass(k)), g.geodesic.passes[k].normal));
            EXPECT_GE(g.geodesic.passes[k].offset, 0);
            EXPECT_LE(g.geodesic.passes[k].offset, c.length);
        }
        if (c.length > 6) continue;
        const ClosedGeodesic plain =
            follow_geodesic(*m.coarse, on_axis.vertex, axis_normal(on_axis.element), c.length);
        EXPECT_EQ(plain.passes.size(), g.geodesic.passes.size()) << c.name;
    }
}

/// From any base, and backwards, it is the same closed geodesic.
TEST(BasedCurve, GeodesicDoesNotDependOnTheBase) {
    const MarkedSurface m = marked(bent_row(2, RowPart::whole));
    const BasedCurve a = m.curve("a1"), b = m.curve("b1");
    const ClosedGeodesic here = geodesic_of(*m.coarse, a);
    for (const Isometry<Exact>& by :
         {b.element, product(b.element, b.element, a.element, inverse(b.element))}) {
        const ClosedGeodesic there = geodesic_of(*m.coarse, {a.vertex, conjugated(a.element, by)});
        EXPECT_NEAR(there.length, here.length, 1e-12);
        EXPECT_EQ(there.passes.size(), here.passes.size());
        EXPECT_EQ(crossings(there, here, *m.coarse), 0);
    }
    EXPECT_EQ(geodesic_of(*m.coarse, {a.vertex, inverse(a.element)}).passes.size(), here.passes.size());
    EXPECT_THROW(follow_curve(*m.exact, {0, Isometry<Exact>{}}), std::runtime_error) << "a point";
}

}  // namespace
}  // namespace ricci
