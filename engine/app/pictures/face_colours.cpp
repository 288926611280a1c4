#include <algorithm>
#include <cmath>

#include "engine/app/pictures/layout_pictures.h"

namespace ricci::app {
namespace {

double quantile(const std::vector<double>& values, double q) {
    std::vector<double> finite;
    std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
                 [](double v) { return std::isfinite(v); });
    if (finite.empty()) return 0.0;
    const auto k = static_cast<std::ptrdiff_t>(std::lround(q * static_cast<double>(finite.size() - 1)));
    std::nth_element(finite.begin(), finite.begin() + k, finite.end());
    return finite[static_cast<std::size_t>(k)];
}

}  // namespace

FaceColours diverging_colours(std::vector<double> value, double middle, const std::string& title) {
    const double spread =
        std::max({std::abs(quantile(value, 0.01) - middle), std::abs(quantile(value, 0.99) - middle), 1e-12});
    return {std::move(value), {Axis(middle - spread, middle + spread), ColourMap::diverging}, title};
}

FaceColours sequential_colours(std::vector<double> value, const std::string& title) {
    const double low = quantile(value, 0.01), high = std::max(quantile(value, 0.99), low + 1e-12);
    return {std::move(value), {Axis(low, high), ColourMap::sequential}, title};
}

}  // namespace ricci::app
