#include "engine/shape_space/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <random>

#include "engine/shape_space/flat_distance.h"

namespace ricci {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

ShapeVectors random_shapes(std::size_t count, std::size_t dimension, unsigned seed, double grid = 0.0) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    ShapeVectors shapes{2, 0, ShapeMetric::spectrum, dimension, {}};
    for (std::size_t k = 0; k < count * dimension; ++k) {
        const double x = normal(random);
        shapes.values.push_back(grid > 0.0 ? grid * std::round(x / grid) : x);
    }
    return shapes;
}

/// By definition: all distances, sorted, ties in order.
std::vector<Neighbour> brute_force(const ShapeVectors& shapes, std::span<const double> query,
                                   std::size_t count) {
    std::vector<Neighbour> all;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        double sum = 0.0;
        for (std::size_t k = 0; k < shapes.dimension; ++k)
            sum += (query[k] - shapes.row(i)[k]) * (query[k] - shapes.row(i)[k]);
        all.push_back({i, std::sqrt(sum)});
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.distance < b.distance; });
    all.resize(std::min(count, all.size()));
    return all;
}

TEST(Neighbours, EqualBruteForceBitForBit) {
    for (const std::size_t dimension : {1U, 3U, 12U}) {
        const ShapeVectors shapes = random_shapes(500, dimension, 3),
                           queries = random_shapes(40, dimension, 4);
        const NeighbourSearch search(shapes);
        for (std::size_t q = 0; q < queries.size(); ++q)
            for (const std::size_t count : {1U, 7U, 499U, 500U, 900U})
                EXPECT_EQ(search.nearest(queries.row(q), count), brute_force(shapes, queries.row(q), count));
    }
}

/// On a coarse grid most distances come many times; the lowest entries must win at the cut as well.
TEST(Neighbours, TiesFollowTheOrderOfTheEntries) {
    const ShapeVectors shapes = random_shapes(400, 2, 5, 0.5);
    const NeighbourSearch search(shapes);
    for (std::size_t q = 0; q < 60; ++q)
        for (const std::size_t count : {1U, 5U, 30U})
            EXPECT_EQ(search.nearest(shapes.row(q), count), brute_force(shapes, shapes.row(q), count));
}

TEST(Neighbours, ShapesWithoutAVectorAreNobodysNeighbours) {
    ShapeVectors shapes{2, 0, ShapeMetric::coordinates, 2, {0.0, 0.0, kNaN, kNaN, 1.0, 0.0, 3.0, 4.0}};
    const NeighbourSearch search(shapes);
    const std::vector<double> origin{0.0, 0.0};
    EXPECT_EQ(search.nearest(origin, 9), (std::vector<Neighbour>{{0, 0.0}, {2, 1.0}, {3, 5.0}}));
    EXPECT_TRUE(std::isnan(shape_distance(shapes, shapes.row(0), shapes.row(1))));
    shapes.values.assign(4, kNaN);
    EXPECT_TRUE(NeighbourSearch(shapes).nearest(origin, 3).empty());
}

/// i and i + 0.98: far apart in the plane, and by a translation 0.02 apart as tori. Coordinates stay
/// Euclidean.
TEST(Neighbours, ToriAreComparedByTheirTeichmuellerDistance) {
    ShapeVectors tori{1, 0, ShapeMetric::spectrum, 2, {0.0, 1.05, 0.3, 1.3, -0.49, 1.5, 0.0, 2.0}};
    const NeighbourSearch search(tori);
    const std::vector<double> query{0.49, 1.5};
    const std::vector<Neighbour> found = search.nearest(query, 2);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].shape, 2U);
    EXPECT_EQ(found[0].distance, torus_distance({0.49, 1.5}, {-0.49, 1.5}));
    EXPECT_EQ(found[1].shape, 1U);
    // i and 2i: half of log 2, the distance of a stretch by 2.
    EXPECT_NEAR(shape_distance(tori, std::vector<double>{0.0, 1.0}, std::vector<double>{0.0, 2.0}),
                0.5 * std::log(2.0), 1e-14);
    tori.metric = ShapeMetric::coordinates;
    EXPECT_EQ(NeighbourSearch(tori).nearest(query, 1)[0].shape, 1U);
}

TEST(Neighbours, AnnuliAreComparedByHalfTheLogarithmOfTheirModuli) {
    const ShapeVectors annuli{0, 2, ShapeMetric::spectrum, 1, {std::log(1.0), std::log(4.0), std::log(0.1)}};
    const std::vector<Neighbour> found =
        NeighbourSearch(annuli).nearest(std::vector<double>{std::log(2.5)}, 3);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].shape, 1U);
    // Logarithm, exponential and quotient round a few times.
    EXPECT_NEAR(found[0].distance, 0.5 * std::log(1.6), 1e-15);
    EXPECT_NEAR(found[2].distance, 0.5 * std::log(25.0), 1e-14);
}

TEST(Neighbours, RefuseVectorsOfAnotherSize) {
    const NeighbourSearch search(random_shapes(5, 3, 1));
    EXPECT_THROW(search.nearest(std::vector<double>{1.0, 2.0}, 1), std::invalid_argument);
    EXPECT_THROW(search.nearest(std::vector<double>{1.0, 2.0, kNaN}, 1), std::invalid_argument);
    EXPECT_THROW(NeighbourSearch({2, 0, ShapeMetric::spectrum, 3, {1.0, 2.0}}), std::invalid_argument);
    const NeighbourSearch none(ShapeVectors{2, 0, ShapeMetric::coordinates, 0, {}});
    EXPECT_TRUE(none.nearest(std::vector<double>{}, 3).empty());
}

}  // namespace
}  // namespace ricci
