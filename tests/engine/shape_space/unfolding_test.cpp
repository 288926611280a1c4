// Every lift of every vertex within a distance, once.
#include "engine/shape_space/unfolding.h"

#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci {
namespace {

using testing::displacement_cosh;
using testing::generated;
using testing::IsometrySet;

constexpr auto kNoBudget = std::numeric_limits<std::int64_t>::max();

/// By breadth first search along edges. A straight segment of length `distance` passes within the radius of
/// vertices that edges join, so lifts within `distance` plus the largest radius are enough to walk on.
IsometrySet lifts_by_walking(const CoarseSurface& s, Index from, double distance) {
    const double reach = distance + *std::max_element(s.radius.begin(), s.radius.end()) + 1e-6;
    IsometrySet all, near;
    all.insert({}, from);
    for (std::size_t k = 0; k < all.elements().size(); ++k) {
        const Isometry<double> x = all.elements()[k];
        if (k > 0 && displacement_cosh(x) <= std::cosh(distance)) near.insert(x, all.labels()[k]);
        for_neighbours(s, all.labels()[k], [&](CoarseStep step, Index w) {
            const Isometry<double> y = compose(-1, x, s.along(step));
            if (displacement_cosh(y) <= std::cosh(reach)) all.insert(y, w);
        });
    }
    return near;
}

std::vector<testing::NamedMesh> surfaces() {
    return {{"eight", generated("eight", 400, 0.4)},
            {"genus 3", generated("genus-g", 600, 0.4, 3)},
            {"pants", generated("pants", 300, 0.4)},
            {"genus 2, one boundary", generated("genus-g-one-boundary", 500, 0.3)},
            {"bolza", testing::scrambled(make_bolza(), 200, 3)},
            {"klein quartic", make_klein_quartic()}};
}

TEST(Unfolding, SeesWhatWalkingReaches) {
    for (const testing::NamedMesh& item : surfaces())
        for (const double spacing : {0.15, 0.6, 0.9, 2.0}) {  // short edges show where the view ends
            SCOPED_TRACE(item.name + ", spacing " + std::to_string(spacing));
            const CoarseSurface s = testing::thinned(item.mesh, spacing);
            for (Index v = 0; v < std::min<Index>(s.connectivity.vertex_count, 6); ++v) {
                // Between two distances that no lift has, by the odds.
                const double distance = spacing < 0.5 ? 2.3456 : 3.4567;
                const IsometrySet walked = lifts_by_walking(s, v, distance);
                IsometrySet seen;
                Index calls = 0;
                Unfolding unfolding(s);
                ASSERT_TRUE(unfolding.visit(v, distance, kNoBudget, [&](Index w, const Isometry<double>& x) {
                    seen.insert(x, w);
                    ++calls;
                    ASSERT_NEAR(squared(x.a) - squared(x.b), 1.0, 1e-10);
                }));
                ASSERT_EQ(seen.elements().size(), walked.elements().size());
                for (std::size_t k = 0; k < walked.elements().size(); ++k)
                    ASSERT_GE(seen.find(walked.elements()[k], walked.labels()[k]), 0)
                        << "at distance " << std::acosh(displacement_cosh(walked.elements()[k]));
                // Lifts on a ray are met twice: many on the most symmetric surfaces only.
                const auto most =
                    static_cast<Index>(seen.elements().size()) * (item.mesh.intrinsic() ? 20 : 11) / 10 + 2;
                EXPECT_LE(calls, most);
                EXPECT_GE(walked.elements().size(), 8U);
                EXPECT_GT(unfolding.crossed(), 0);
            }
        }
}

TEST(Unfolding, LiftsGrowLikeTheAreaOfADisk) {
    // On a closed surface the lifts of all vertices, averaged over starts, are as many as V disks of that
    // radius hold, up to the boundary's error, which random positions average out.
    for (const testing::NamedMesh& item : surfaces()) {
        const CoarseSurface s = testing::thinned(item.mesh);
        if (s.boundaries > 0 || item.mesh.intrinsic()) continue;  // symmetric ones come in shells
        SCOPED_TRACE(item.name);
        const auto count = s.connectivity.vertex_count;
        for (const double distance : {4.0, 6.0}) {
            double lifts = 0;
            for (Index v = 0; v < count; ++v)
                Unfolding(s).visit(v, distance, kNoBudget, [&](Index, const Isometry<double>&) { ++lifts; });
            const double disk = std::cosh(distance) - 1, domain = 2.0 * (s.genus - 1);
            EXPECT_NEAR(lifts / count, disk / domain * count, 0.15 * disk / domain * count);
        }
    }
}

TEST(Unfolding, FarIsNoFartherThanItSays) {
    // The hyperbolic tangent of such a distance is 1 but for 1e-13. Lifts near pairs of pants' core thin out:
    // their number grows like e^(s d), s < 1 (Patterson 1976).
    const CoarseSurface s = testing::thinned(generated("pants", 300, 0.4));
    double last = 0;
    for (const double distance : {9.0, 11.0, 13.0, 15.0}) {
        Unfolding unfolding(s);
        double lifts = 0, farthest = 0;
        ASSERT_TRUE(unfolding.visit(0, distance, 1000000, [&](Index, const Isometry<double>& x) {
            ++lifts;
            farthest = std::max(farthest, displacement_cosh(x));
        }));
        EXPECT_LE(farthest, std::cosh(distance) * (1 + 1e-9));
        EXPECT_GT(farthest, std::cosh(distance - 1));
        EXPECT_GT(lifts, last);
        if (last > 0) {
            EXPECT_LT(lifts, last * std::exp(2.0));
        }
        last = lifts;
    }
}

TEST(Unfolding, BudgetIsKept) {
    const CoarseSurface s = testing::thinned(generated("eight", 400, 0.4));
    Unfolding whole(s), limited(s);
    const auto ignore = [](Index, const Isometry<double>&) {};
    ASSERT_TRUE(whole.visit(0, 5.0, kNoBudget, ignore));
    const std::int64_t needed = whole.crossed();
    EXPECT_TRUE(limited.visit(0, 5.0, needed, ignore));
    EXPECT_EQ(limited.crossed(), needed);
    EXPECT_FALSE(limited.visit(0, 5.0, needed - 1, ignore)) << "one short";
    EXPECT_TRUE(limited.visit(0, 5.0, needed, ignore)) << "each call has its own";
}

}  // namespace
}  // namespace ricci
