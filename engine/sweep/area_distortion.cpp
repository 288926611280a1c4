#include "engine/sweep/area_distortion.h"

#include <cmath>

#include "kernels/area_ratios.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

double area_distortion_of_scaling(std::span<const double> area, std::span<const Index> tail,
                                  std::span<const double> u) {
    std::vector<double> log_ratio(area.size());
    for (std::size_t f = 0; f < area.size(); ++f)
        log_ratio[f] = (2.0 / 3.0) * (u[at(tail[3 * f])] + u[at(tail[3 * f + 1])] + u[at(tail[3 * f + 2])]);
    return area_ratio_deviation(area, log_ratio);
}

double area_distortion_of_areas(std::span<const double> area, std::span<const double> new_area) {
    std::vector<double> log_ratio(area.size());
    for (std::size_t f = 0; f < area.size(); ++f) log_ratio[f] = std::log(new_area[f]) - std::log(area[f]);
    return area_ratio_deviation(area, log_ratio);
}

}  // namespace ricci
