// Points of a space of many dimensions seen from where they spread the most.
#pragma once

#include <span>
#include <vector>

namespace ricci {

/// Principal components of N points of dimension D.
struct PrincipalComponents {
    std::vector<double> mean;               // D
    std::vector<double> variance;           // D, descending
    std::vector<std::vector<double>> axes;  // D x D, orthonormal, by variance; each one's entry that is
                                            // largest in absolute value (the first of equals) is positive
    /// Coordinates of a point along the first `count` axes, from the mean.
    [[nodiscard]] std::vector<double> project(std::span<const double> point, std::size_t count) const;
    /// The part of the whole variance that lies along an axis; 0 where there is none.
    [[nodiscard]] double share(std::size_t axis) const;
};

/// Throws std::invalid_argument for no points, or points of different dimensions.
PrincipalComponents principal_components(std::span<const std::vector<double>> points);

}  // namespace ricci
