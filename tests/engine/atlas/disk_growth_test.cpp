#include "engine/atlas/disk_growth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "engine/atlas/face_patches.h"
#include "engine/atlas/simple_polygon.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// Whether polygons form a closed disk that does not meet itself: the rim is one cycle through different
/// vertices, and V - E + F = 1.
bool is_disk(const PolygonSurface& s, const std::vector<Index>& polygons) {
    const std::set<Index> in(polygons.begin(), polygons.end());
    std::set<Index> vertices;
    std::map<Index, Index> rim;  // from a vertex to the next
    std::size_t inner = 0;
    for (const Index p : polygons)
        for (Index c = s.first[at(p)]; c < s.first[at(p) + 1]; ++c) {
            vertices.insert(s.vertex[at(c)]);
            if (in.count(s.across(c)) > 0) {
                ++inner;
            } else if (!rim.emplace(s.vertex[at(c)], s.vertex[at(s.next(c))]).second) {
                return false;
            }
        }
    if (rim.empty() || vertices.size() + polygons.size() != rim.size() + inner / 2 + 1) return false;
    std::size_t length = 0;
    Index v = rim.begin()->first;
    do {
        if (rim.count(v) == 0) return false;
        v = rim[v];
        ++length;
    } while (v != rim.begin()->first && length <= rim.size());
    return length == rim.size();
}

TEST(DiskGrowth, EveryBeginningIsADisk) {
    const PolygonSurface s = polygons_of(testing::bumpy_torus(7, 5).connectivity);
    DiskGrowth growth(s, std::vector<std::uint8_t>(at(s.vertex_count), 0));
    for (const Index seed : {0, 33, 69}) {
        const std::vector<Index> grown = growth.grow(std::span(&seed, 1), {}, kAll);
        // A torus cut open leaves at least the faces along two loops out, and most can be had.
        EXPECT_GT(grown.size(), 30U);
        EXPECT_LT(grown.size(), 70U);
        for (std::size_t n = 1; n <= grown.size(); ++n)
            ASSERT_TRUE(is_disk(s, {grown.begin(), grown.begin() + static_cast<std::ptrdiff_t>(n)})) << n;
    }
}

TEST(DiskGrowth, DoesNotCloseARing) {
    // Four quadrilaterals in a ring, inner vertices 0 ... 3, outer ones 4 ... 7: the last would share two
    // opposite sides with the rest and no vertex besides.
    PolygonSurface s;
    s.vertex_count = 8;
    for (Index q = 0; q < 4; ++q) {
        s.first.push_back(4 * q);
        const Index next = (q + 1) % 4, previous = (q + 3) % 4;
        for (const Index v : {q, q + 4, next + 4, next}) s.vertex.push_back(v);
        for (const Index t : {4 * previous + 2, Index{-1}, 4 * next, Index{-1}}) s.twin.push_back(t);
        for (int k = 0; k < 4; ++k) s.polygon.push_back(q);
    }
    s.first.push_back(16);
    DiskGrowth growth(s, std::vector<std::uint8_t>(8, 0));
    const Index seed = 1;
    EXPECT_EQ(growth.grow(std::span(&seed, 1), {}, kAll).size(), 3U);
}

TEST(DiskGrowth, StopsBeforeASphereCloses) {
    const PolygonSurface s = polygons_of(testing::icosahedron().connectivity);
    DiskGrowth growth(s, std::vector<std::uint8_t>(12, 0));
    const Index seed = 4;
    EXPECT_EQ(growth.grow(std::span(&seed, 1), {}, kAll).size(), 19U);
    EXPECT_EQ(growth.grow(std::span(&seed, 1), {}, 7).size(), 7U);
}

TEST(DiskGrowth, ConesStayOnTheRim) {
    const PolygonSurface s = polygons_of(testing::icosahedron().connectivity);
    std::vector<std::uint8_t> cone(12, 0);
    cone[5] = 1;
    DiskGrowth growth(s, cone);
    for (Index seed = 0; seed < 20; ++seed) {
        const std::vector<Index> grown = growth.grow(std::span(&seed, 1), {}, kAll);
        EXPECT_TRUE(is_disk(s, grown));
        Index around = 0;
        for (const Index p : grown)
            for (Index c = 3 * p; c < 3 * p + 3; ++c) around += s.vertex[at(c)] == 5 ? 1 : 0;
        EXPECT_LE(around, 4);  // of 5
    }
    const std::vector<Index> star = star_of(s, lowest_corners(s)[5]);
    EXPECT_EQ(star.size(), 5U);
    EXPECT_TRUE(growth.grow(star, {}, kAll).empty());
}

TEST(DiskGrowth, StaysWhereItIsAllowed) {
    const SurfaceMesh mesh = testing::wavy_square(6);
    const PolygonSurface s = polygons_of(mesh.connectivity);
    std::vector<std::uint8_t> allowed(72, 0);
    for (std::size_t f = 0; f < 24; ++f) allowed[f] = 1;  // two rows of cells: a disk
    DiskGrowth growth(s, std::vector<std::uint8_t>(49, 0));
    const Index seed = 9;
    std::vector<Index> grown = growth.grow(std::span(&seed, 1), allowed, kAll);
    EXPECT_EQ(grown.front(), seed);
    std::sort(grown.begin(), grown.end());
    ASSERT_EQ(grown.size(), 24U);
    EXPECT_EQ(grown.back(), 23);
    // A ring around them: the row beyond.
    add_rings(s, 1, allowed);
    EXPECT_EQ(std::count(allowed.begin(), allowed.end(), 1), 36);
}

TEST(FacePatches, SeedsAreFarApartAndOwnTheirSurroundings) {
    const PolygonSurface s = polygons_of(testing::bumpy_torus(12, 12).connectivity);
    const std::vector<Index> seeds = farthest_seeds(s, 6);
    ASSERT_EQ(seeds.size(), 6U);
    const std::vector<Index> owner = nearest_seeds(s, seeds);
    std::vector<std::vector<Index>> distance;
    for (const Index seed : seeds) distance.push_back(dual_distances(s, {seed}));
    for (std::size_t p = 0; p < owner.size(); ++p) {
        Index best = 0;
        for (Index k = 1; k < 6; ++k)
            if (distance[at(k)][p] < distance[at(best)][p]) best = k;
        EXPECT_EQ(owner[p], best);
    }
    // No face is farther from the seeds than the last two seeds are from each other.
    Index apart = std::numeric_limits<Index>::max(), farthest = 0;
    for (std::size_t k = 0; k < 5; ++k) apart = std::min(apart, distance[k][at(seeds[5])]);
    for (std::size_t p = 0; p < owner.size(); ++p) farthest = std::max(farthest, distance[at(owner[p])][p]);
    EXPECT_LE(farthest, apart);
}

std::vector<RimSegment> closed(const std::vector<std::array<double, 2>>& x) {
    std::vector<RimSegment> rim;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const std::size_t j = (i + 1) % x.size();
        rim.push_back({x[i], x[j], static_cast<Index>(i), static_cast<Index>(j)});
    }
    return rim;
}

TEST(SimplePolygon, KnowsCrossings) {
    EXPECT_TRUE(is_simple(closed({{0, 0}, {2, 0}, {2, 2}, {1, 0.5}, {0, 2}})));
    EXPECT_FALSE(is_simple(closed({{0, 0}, {1, 1}, {1, 0}, {0, 1}})));
    // A spiral of more than a full turn, closed through its centre.
    const auto spiral = [](double turns) {
        std::vector<std::array<double, 2>> x{{0, 0}};
        for (int i = 0; i <= 40; ++i) {
            const double angle = 2 * std::numbers::pi * turns * i / 40, radius = 1.0 + 0.02 * i;
            x.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        }
        return x;
    };
    EXPECT_TRUE(is_simple(closed(spiral(0.95))));
    EXPECT_FALSE(is_simple(closed(spiral(1.1))));
    EXPECT_FALSE(is_simple(closed({{0, 0}, {1, 0}, {std::nan(""), 1}})));
}

}  // namespace
}  // namespace ricci
