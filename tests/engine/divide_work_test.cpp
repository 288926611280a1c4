#include "engine/sweep/divide_work.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>

#include "tests/support/random.h"

namespace ricci {
namespace {

/// Units of very different size, some of which cannot be cut.
std::vector<WorkUnit> random_units(std::uint64_t seed, std::size_t count) {
    ricci::testing::Random random(seed);
    std::vector<WorkUnit> units;
    for (std::size_t u = 0; u < count; ++u) {
        const double size = 1.0 / random.uniform(0.001, 1.0);
        units.push_back({size, 0.01 * size + 0.1, u % 5 == 0 ? 1U : 1 + static_cast<std::size_t>(size)});
    }
    return units;
}

std::vector<WorkUnit> whole_units(const std::vector<double>& costs) {
    std::vector<WorkUnit> units;
    for (const double cost : costs) units.push_back({cost, 0.0, 1});
    return units;
}

double largest(const std::vector<double>& load) {
    return *std::max_element(load.begin(), load.end());
}

TEST(DivideWork, PartsCoverEveryUnitOnce) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<WorkUnit> units = random_units(seed, 1 + 7 * seed);
        for (const std::size_t shards : {1U, 2U, 3U, 8U, 50U}) {
            const WorkDivision division = divide_work(units, shards);
            ASSERT_EQ(division.parts.size(), shards);
            std::map<std::size_t, std::map<std::uint32_t, std::uint32_t>> found;
            for (const auto& parts : division.parts) {
                EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
                    return a.unit <= b.unit;
                })) << "a shard has one part of a unit";
                for (const WorkPart& part : parts) found[part.unit].emplace(part.first, part.last);
            }
            ASSERT_EQ(found.size(), units.size());
            for (const auto& [unit, parts] : found) {
                EXPECT_LE(parts.size(), units[unit].parts_at_most);
                std::uint32_t end = 0;
                for (const auto& [first, last] : parts) {
                    EXPECT_EQ(first, end);
                    EXPECT_LT(first, last);
                    end = last;
                }
                EXPECT_EQ(end, kWholeUnit);
            }
        }
    }
}

TEST(DivideWork, LoadsAreThoseOfTheParts) {
    const std::vector<WorkUnit> units = random_units(3, 60);
    const WorkDivision division = divide_work(units, 7);
    double total = 0.0;
    for (std::size_t s = 0; s < 7; ++s) {
        double load = 0.0;
        for (const WorkPart& part : division.parts[s])
            load += units[part.unit].fixed +
                    units[part.unit].divisible * static_cast<double>(part.last - part.first) / kWholeUnit;
        EXPECT_NEAR(load, division.load[s], 1e-3 * load);
        total += load;
    }
    EXPECT_NEAR(division.overhead(), total / division.whole - 1.0, 1e-3);
    EXPECT_NEAR(division.imbalance(), largest(division.load) * 7.0 / total, 1e-3);
}

TEST(DivideWork, WhatCanBeCutIsDividedEvenly) {
    std::vector<WorkUnit> units = random_units(5, 200);
    for (WorkUnit& unit : units) unit.parts_at_most = 1000;
    for (const std::size_t shards : {2U, 5U, 16U, 64U}) {
        const WorkDivision division = divide_work(units, shards);
        EXPECT_LT(division.imbalance(), 1.05) << shards;
        EXPECT_LT(division.overhead(), 0.10) << shards;
    }
}

TEST(DivideWork, OneBigUnitIsSharedByAll) {
    const WorkDivision division = divide_work({{1000.0, 1.0, 500}}, 8);
    for (const auto& parts : division.parts) {
        ASSERT_EQ(parts.size(), 1U);
        EXPECT_NEAR(static_cast<double>(parts[0].last - parts[0].first), kWholeUnit / 8.0, 2.0);
    }
}

// Graham's worst case for two-thirds of the way: whole units, the longest first.
TEST(DivideWork, LongestFirstWhereNothingCanBeCut) {
    const WorkDivision division = divide_work(whole_units({4, 5, 3, 4, 3, 5, 3}), 3);
    EXPECT_EQ(largest(division.load), 11.0);
    const WorkDivision many = divide_work(whole_units({1, 1, 1, 1, 1, 1, 6}), 2);
    EXPECT_EQ(many.load, (std::vector<double>{6.0, 6.0})) << "in the given order it would be 9 and 3";
}

TEST(DivideWork, MoreShardsThanWork) {
    const WorkDivision division = divide_work(whole_units({2, 1}), 5);
    EXPECT_EQ(std::count_if(division.parts.begin(), division.parts.end(),
                            [](const auto& parts) { return parts.empty(); }),
              3);
    EXPECT_EQ(divide_work({}, 2).imbalance(), 1.0);
    EXPECT_THROW(divide_work({}, 0), std::invalid_argument);
}

// Parts of a unit take each element once, in numbers that fit their size, and from everywhere.
TEST(DivideWork, ElementsAreSpreadOverTheParts) {
    const std::vector<WorkPart> parts{{0, 0, 300000}, {0, 300000, 300001}, {0, 300001, kWholeUnit}};
    for (const std::size_t count : {1U, 17U, 1000U, 200000U}) {
        std::vector<std::size_t> taken(parts.size(), 0), early(parts.size(), 0);
        for (std::size_t k = 0; k < count; ++k) {
            std::size_t owners = 0;
            for (std::size_t p = 0; p < parts.size(); ++p) {
                if (!belongs(k, parts[p])) continue;
                ++owners;
                ++taken[p];
                early[p] += k < count / 10 ? 1 : 0;
            }
            ASSERT_EQ(owners, 1U) << k;
        }
        for (std::size_t p = 0; p < parts.size(); ++p) {
            const double share = static_cast<double>(parts[p].last - parts[p].first) / kWholeUnit;
            EXPECT_NEAR(static_cast<double>(taken[p]), share * static_cast<double>(count), 4.0);
            EXPECT_NEAR(static_cast<double>(early[p]), share * static_cast<double>(count) / 10.0, 4.0);
        }
    }
}

}  // namespace
}  // namespace ricci
