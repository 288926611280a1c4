// How unevenly a metric changes the areas of faces.
#pragma once

#include <span>

namespace ricci {

/// Mean square of `log_ratio[f]` (logarithm of the change of a face's area) against the logarithm of the
/// change of the total area. `area`, `log_ratio`: F, not empty. The bits depend on nothing but the input.
double area_ratio_deviation(std::span<const double> area, std::span<const double> log_ratio);

}  // namespace ricci
