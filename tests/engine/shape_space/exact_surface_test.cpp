#include "engine/shape_space/exact_surface.h"

#include <gtest/gtest.h>

#include "tests/engine/shape_space/marked_surface.h"

namespace ricci {
namespace {

using testing::at;
using testing::bent_row;
using testing::coarse_of;
using testing::Random;

double miss(const Isometry<Exact>& x) {
    return static_cast<double>(distance_to_identity(x));
}

/// The link of a vertex v, walked around once from the head of `first`.
CoarsePath link_of(const CoarseSurface& s, Index first) {
    CoarsePath path;
    for (Index h = first;;) {
        path.push_back(next_halfedge(h));
        h = s.turned(h);
        if (h == first || h == kNoTwin) return path;
    }
}

/// A random walk of so many edges.
CoarsePath random_path(const CoarseSurface& s, Index from, std::size_t steps, Random& random) {
    CoarsePath path;
    Index here = from;
    while (path.size() < steps) {
        std::vector<Index> around;
        const Index first = s.outgoing[at(here)];
        for (Index h = first; h != kNoTwin;) {
            around.push_back(h);
            const Index in = prev_halfedge(h);
            if (s.connectivity.twin[at(in)] == kNoTwin) around.push_back(~in);
            h = s.turned(h);
            if (h == first) break;
        }
        const Index h = around[random.below(around.size())];
        path.push_back(h);
        here = h >= 0 ? s.connectivity.head(h) : s.connectivity.tail[at(~h)];
    }
    return path;
}

class ExactSurfaces : public ::testing::TestWithParam<testing::RowType> {};

TEST_P(ExactSurfaces, RelationsHoldToFortyDigits) {
    const CoarseSurface s = coarse_of(bent_row(GetParam().rings, GetParam().part));
    const ExactSurface exact(s);
    const Connectivity& c = s.connectivity;
    for (Index f = 0; f < c.face_count(); ++f)
        EXPECT_LT(miss(exact.along({3 * f, 3 * f + 1, 3 * f + 2})), 1e-40) << "face " << f;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        EXPECT_LT(miss(exact.along({h, t != kNoTwin ? t : ~h})), 1e-40);
    }
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(c);
    for (Index v = 0; v < c.vertex_count; ++v) {
        if (on_boundary[at(v)] != 0) continue;
        EXPECT_LT(miss(exact.along(link_of(s, s.outgoing[at(v)]))), 1e-40) << "vertex " << v;
    }
}

/// What was solved for are the last digits only.
TEST_P(ExactSurfaces, StepsAreThoseOfTheCoarseSurface) {
    const CoarseSurface s = coarse_of(bent_row(GetParam().rings, GetParam().part));
    const ExactSurface exact(s);
    ASSERT_LT(s.angle_error, 1e-9);
    double largest = 0;
    for (Index h = 0; h < s.connectivity.halfedge_count(); ++h) {
        const Isometry<double> x = rounded(exact.along(h)), &y = s.step[at(h)];
        largest = std::max(largest, distance_to_identity(compose(-1, inverse(y), x)));
    }
    EXPECT_LT(largest, 1e-9);
    EXPECT_GT(largest, 0.0);
}

/// Whatever way leads to a lift: the isometry found from its double is that of the way taken.
TEST_P(ExactSurfaces, FindsTheExactIsometryOfALift) {
    const CoarseSurface s = coarse_of(bent_row(GetParam().rings, GetParam().part));
    const ExactSurface exact(s);
    Random random(3);
    for (int k = 0; k < 40; ++k) {
        const Index from = random.below(s.connectivity.vertex_count);
        const CoarsePath path = random_path(s, from, 1 + random.below(std::size_t{8}), random);
        const Isometry<Exact> element = exact.along(path);
        const Isometry<Exact> found = exact.exact(from, rounded(element));
        EXPECT_LT(miss(compose(-1, inverse(element), found)), 1e-35) << "path of " << path.size();
    }
}

INSTANTIATE_TEST_SUITE_P(Rows, ExactSurfaces,
                         ::testing::Values(testing::RowType{2, 0, 2, RowPart::whole},
                                           testing::RowType{0, 4, 3, RowPart::upper},
                                           testing::RowType{2, 1, 4, RowPart::right}),
                         [](const auto& row) {
                             return "g" + std::to_string(row.param.genus) + "b" +
                                    std::to_string(row.param.boundaries);
                         });

TEST(ExactSurface, RefusesWhatIsNoLiftOfAVertex) {
    const CoarseSurface s = coarse_of(bent_row(2, RowPart::whole));
    const ExactSurface exact(s);
    Isometry<double> beside{{1.0, 0.0}, {0.05, 0.02}};
    normalise(-1, beside);
    EXPECT_THROW(exact.exact(0, beside), std::runtime_error);
}

TEST(ExactSurface, SaysWhereAnAngleSumIsFarFromItsTarget) {
    CoarseSurface s = coarse_of(bent_row(2, RowPart::whole));
    for (double& x : s.half_chord) x *= 4;
    EXPECT_THROW(ExactSurface{s}, std::runtime_error);
}

}  // namespace
}  // namespace ricci
