#include "engine/quality/distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ricci {
namespace {

TEST(Distribution, OfAHundredNumbers) {
    std::vector<double> values;
    for (int i = 100; i >= 1; --i) values.push_back(i);
    values.push_back(std::nan(""));
    const Distribution d = distribution_of(values);
    EXPECT_EQ(d.count, 100);
    EXPECT_EQ(d.min, 1.0);
    EXPECT_EQ(d.max, 100.0);
    EXPECT_EQ(d.mean, 50.5);
    // k of 100 values are k % of the weight.
    EXPECT_EQ(d.quantile[0], 1.0);
    EXPECT_EQ(d.quantile[2], 25.0);
    EXPECT_EQ(d.quantile[3], 50.0);
    EXPECT_EQ(d.quantile[6], 99.0);
    EXPECT_EQ(share_within(values, 11.0, 20.0), 0.1);
}

TEST(Distribution, WeightsAreRepetitions) {
    const std::vector<double> values{3.0, 1.0, 2.0}, weight{1.0, 2.0, 5.0};
    const std::vector<double> repeated{3, 1, 1, 2, 2, 2, 2, 2};
    const Distribution d = distribution_of(values, weight), e = distribution_of(repeated);
    EXPECT_EQ(d.quantile, e.quantile);
    EXPECT_DOUBLE_EQ(d.mean, e.mean);
    EXPECT_EQ(share_within(values, 1.5, 2.5, weight), share_within(repeated, 1.5, 2.5));
}

TEST(Distribution, OfNothing) {
    const std::vector<double> none{std::nan("")};
    EXPECT_EQ(distribution_of(none).count, 0);
    EXPECT_EQ(distribution_of({}).mean, 0.0);
    EXPECT_EQ(share_within(none, 0.0, 1.0), 0.0);
}

}  // namespace
}  // namespace ricci
