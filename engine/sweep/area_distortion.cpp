#include "engine/sweep/area_distortion.h"

#include <algorithm>
#include <cmath>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Mean square of `log_ratio[f]` (log of the local change of area) against the change of the total. Areas as
/// exponentials relative to the largest ratio, so that factors of e^48 neither over- nor underflow the sum.
double mean_square_deviation(std::span<const double> area, std::span<const double> log_ratio) {
    const double top = *std::max_element(log_ratio.begin(), log_ratio.end());
    double before = 0.0, after = 0.0;
    for (std::size_t f = 0; f < area.size(); ++f) {
        before += area[f];
        after += area[f] * std::exp(log_ratio[f] - top);
    }
    const double total = std::log(after / before) + top;
    double sum = 0.0;
    for (const double r : log_ratio) sum += (r - total) * (r - total);
    return sum / static_cast<double>(area.size());
}

}  // namespace

double area_distortion_of_scaling(std::span<const double> area, std::span<const Index> tail,
                                  std::span<const double> u) {
    std::vector<double> log_ratio(area.size());
    for (std::size_t f = 0; f < area.size(); ++f)
        log_ratio[f] = (2.0 / 3.0) * (u[at(tail[3 * f])] + u[at(tail[3 * f + 1])] + u[at(tail[3 * f + 2])]);
    return mean_square_deviation(area, log_ratio);
}

double area_distortion_of_areas(std::span<const double> area, std::span<const double> new_area) {
    std::vector<double> log_ratio(area.size());
    for (std::size_t f = 0; f < area.size(); ++f) log_ratio[f] = std::log(new_area[f]) - std::log(area[f]);
    return mean_square_deviation(area, log_ratio);
}

}  // namespace ricci
