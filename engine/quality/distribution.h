// A set of numbers summed up.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace ricci {

/// Where quantiles are taken.
inline constexpr std::array<double, 7> kQuantileLevels = {0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99};

/// All zero where there are no numbers.
struct Distribution {
    std::int64_t count = 0;
    double mean = 0.0, min = 0.0, max = 0.0;
    std::array<double, 7> quantile{};  // at kQuantileLevels: the least value with at least that share of the
                                       // weight at or below it
};

/// `weight`: one per value, not negative, or empty for equal weights. Values that are NaN are left out.
Distribution distribution_of(std::span<const double> values, std::span<const double> weight = {});

/// Share of the weight of the values that lie in [low, high]; 0 where there are none. NaN is left out.
double share_within(std::span<const double> values, double low, double high,
                    std::span<const double> weight = {});

}  // namespace ricci
