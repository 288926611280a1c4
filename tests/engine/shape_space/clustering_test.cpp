#include "engine/shape_space/clustering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "kernels/parallel.h"

namespace ricci {
namespace {

ShapeVectors random_shapes(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    ShapeVectors shapes{2, 0, ShapeMetric::spectrum, 3, {}};
    for (std::size_t k = 0; k < 3 * count; ++k) shapes.values.push_back(normal(random));
    return shapes;
}

/// Members of every cluster of a tree.
std::vector<std::set<std::size_t>> members_of(const Dendrogram& tree) {
    std::vector<std::set<std::size_t>> members;
    for (std::size_t i = 0; i < tree.leaves; ++i) members.push_back({i});
    for (const Merge& m : tree.merges) {
        members.push_back(members[m.first]);
        members.back().insert(members[m.second].begin(), members[m.second].end());
    }
    return members;
}

double linkage_by_definition(const DistanceMatrix& d, const std::set<std::size_t>& a,
                             const std::set<std::size_t>& b, Linkage linkage) {
    double sum = 0.0, least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const std::size_t i : a)
        for (const std::size_t j : b) {
            sum += d(i, j);
            least = std::min(least, d(i, j));
            most = std::max(most, d(i, j));
        }
    if (linkage == Linkage::single) return least;
    if (linkage == Linkage::complete) return most;
    return sum / static_cast<double>(a.size() * b.size());
}

/// Merges the nearest pair again and again, distances by definition.
std::map<std::set<std::size_t>, double> naive_clusters(const DistanceMatrix& d, Linkage linkage) {
    std::vector<std::set<std::size_t>> clusters;
    for (std::size_t i = 0; i < d.size; ++i) clusters.push_back({i});
    std::map<std::set<std::size_t>, double> made;
    while (clusters.size() > 1) {
        std::size_t a = 0, b = 1;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < clusters.size(); ++i)
            for (std::size_t j = i + 1; j < clusters.size(); ++j) {
                const double distance = linkage_by_definition(d, clusters[i], clusters[j], linkage);
                if (distance < least) std::tie(least, a, b) = std::tuple(distance, i, j);
            }
        clusters[a].insert(clusters[b].begin(), clusters[b].end());
        clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(b));
        made.emplace(clusters[a], least);
    }
    return made;
}

TEST(DistanceMatrix, IsSymmetricAndTheSameForAnyThreads) {
    const ShapeVectors shapes = random_shapes(101, 2);
    const DistanceMatrix one = distance_matrix(shapes, false);
    DistanceMatrix three;
    with_thread_limit(3, [&] { three = distance_matrix(shapes, true); });
    EXPECT_EQ(one.values, three.values);
    ASSERT_EQ(one.size, 101U);
    for (std::size_t i = 0; i < one.size; ++i) {
        EXPECT_EQ(one(i, i), 0.0);
        for (std::size_t j = 0; j < one.size; ++j) {
            EXPECT_EQ(one(i, j), one(j, i));
            if (i != j) {
                EXPECT_EQ(one(i, j), shape_distance(shapes, shapes.row(i), shapes.row(j)));
            }
        }
    }
}

TEST(Clustering, EqualsMergingTheNearestPairForEveryLinkage) {
    for (const Linkage linkage : {Linkage::average, Linkage::single, Linkage::complete}) {
        for (unsigned seed = 1; seed <= 5; ++seed) {
            const DistanceMatrix d = distance_matrix(random_shapes(40, seed), false);
            const auto expected = naive_clusters(d, linkage);
            const Dendrogram tree = cluster_shapes(d, linkage);
            const auto members = members_of(tree);
            ASSERT_EQ(tree.merges.size(), 39U);
            double below = 0.0;
            for (std::size_t k = 0; k < tree.merges.size(); ++k) {
                const Merge& m = tree.merges[k];
                const auto found = expected.find(members[40 + k]);
                ASSERT_NE(found, expected.end()) << name_of(linkage) << " merge " << k;
                // Means of up to 400 numbers of order one, by another order of summing.
                EXPECT_NEAR(m.height, found->second, 1e-13);
                EXPECT_EQ(m.members, members[40 + k].size());
                EXPECT_LT(*members[m.first].begin(), *members[m.second].begin());
                EXPECT_GE(m.height, below);
                below = m.height;
            }
        }
    }
}

TEST(Clustering, LeavesDoNotCross) {
    const Dendrogram tree = cluster_shapes(distance_matrix(random_shapes(50, 9), false), Linkage::average);
    const std::vector<std::size_t> order = leaf_order(tree);
    std::vector<std::size_t> place(50, 50);
    for (std::size_t k = 0; k < order.size(); ++k) place.at(order[k]) = k;
    EXPECT_EQ(*std::max_element(place.begin(), place.end()), 49U);
    for (const auto& cluster : members_of(tree)) {
        std::size_t low = 50, high = 0;
        for (const std::size_t i : cluster) {
            low = std::min(low, place[i]);
            high = std::max(high, place[i]);
        }
        EXPECT_EQ(high - low + 1, cluster.size());
    }
}

/// Three groups on a line, entries interleaved.
TEST(Clustering, FlatClustersAreTheGroupsAndNumberedByTheirFirst) {
    const ShapeVectors line{
        2, 0, ShapeMetric::spectrum, 1, {0.0, 10.0, 0.1, 31.0, 10.2, 0.3, 30.0, 10.3, 31.5}};
    const DistanceMatrix d = distance_matrix(line, false);
    for (const Linkage linkage : {Linkage::average, Linkage::single, Linkage::complete}) {
        const Dendrogram tree = cluster_shapes(d, linkage);
        EXPECT_EQ(flat_clusters(tree, 3), (std::vector<std::size_t>{0, 1, 0, 2, 1, 0, 2, 1, 2}));
        EXPECT_EQ(flat_clusters(tree, 2), (std::vector<std::size_t>{0, 0, 0, 1, 0, 0, 1, 0, 1}));
        EXPECT_EQ(flat_clusters(tree, 1), std::vector<std::size_t>(9, 0));
        std::vector<std::size_t> alone(9);
        std::iota(alone.begin(), alone.end(), std::size_t{0});
        EXPECT_EQ(flat_clusters(tree, 9), alone);
        EXPECT_EQ(flat_clusters(tree, 99), alone);
        EXPECT_THROW(flat_clusters(tree, 0), std::invalid_argument);
    }
}

TEST(Clustering, EqualDistancesEndAndAreDeterministic) {
    DistanceMatrix d{6, std::vector<double>(36, 1.0)};
    for (std::size_t i = 0; i < 6; ++i) d.values[7 * i] = 0.0;
    for (const Linkage linkage : {Linkage::average, Linkage::single, Linkage::complete}) {
        const Dendrogram tree = cluster_shapes(d, linkage);
        ASSERT_EQ(tree.merges.size(), 5U);
        for (const Merge& m : tree.merges) EXPECT_EQ(m.height, 1.0);
        EXPECT_EQ(tree.merges, cluster_shapes(d, linkage).merges);
        EXPECT_EQ(members_of(tree).back().size(), 6U);
    }
    const DistanceMatrix same{4, std::vector<double>(16, 0.0)};
    EXPECT_EQ(cluster_shapes(same, Linkage::average).merges.back().height, 0.0);
}

TEST(Clustering, TakesNoneOneAndNoNonsense) {
    EXPECT_TRUE(leaf_order(cluster_shapes({0, {}}, Linkage::average)).empty());
    const Dendrogram one = cluster_shapes({1, {0.0}}, Linkage::average);
    EXPECT_EQ(leaf_order(one), std::vector<std::size_t>{0});
    EXPECT_EQ(flat_clusters(one, 3), std::vector<std::size_t>{0});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(cluster_shapes({2, {0.0, nan, nan, 0.0}}, Linkage::average), std::invalid_argument);
    EXPECT_THROW(cluster_shapes({2, {0.0, -1.0, -1.0, 0.0}}, Linkage::average), std::invalid_argument);
    EXPECT_THROW(cluster_shapes({2, {0.0, 1.0}}, Linkage::average), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
