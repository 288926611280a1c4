// Histograms: counting, and pictures of one or two of them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/picture/axis.h"
#include "io/picture/svg.h"

namespace ricci {

/// Numbers of values in bins of equal width on the axis's scale.
struct Histogram {
    Axis axis;
    std::vector<std::int64_t> counts;                     // B
    std::int64_t below = 0, above = 0, not_a_number = 0;  // values outside all bins

    [[nodiscard]] std::int64_t total() const;  // of all values
};

/// Counts values; the last bin holds the axis's upper end. Throws std::invalid_argument for no bins.
Histogram count_values(std::span<const double> values, const Axis& axis, std::size_t bins);

/// Words of a histogram's picture. Each series is listed with its number of values and how many lie outside.
struct HistogramLabels {
    std::string title, axis, first, second;
};

/// A picture of 480 x 320 pixels: the first series as bars, the second as an outline, over one axis of counts
/// (logarithmic where asked for, to show tails). `reference` marks a value, such as 1 for ratios. Throws
/// std::invalid_argument unless both series have the same bins.
SvgPicture draw_histogram(const Histogram& first, const std::optional<Histogram>& second,
                          const HistogramLabels& labels, ScaleKind counts = ScaleKind::linear,
                          std::optional<double> reference = std::nullopt);

}  // namespace ricci
