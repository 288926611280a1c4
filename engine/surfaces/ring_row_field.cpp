#include "engine/surfaces/ring_row_field.h"

#include <algorithm>
#include <cmath>

namespace ricci {

RingRowField::Sample RingRowField::sample(const Point& p) const {
    double sum = 0.0;
    Point slope = {0.0, 0.0, 0.0};  // sum of d^-6 (d grad d)
    for (Index i = 0; i < genus_; ++i) {
        const double x = p[0] - (2 * i - (genus_ - 1));
        const double axis_distance = std::hypot(x, p[1]);
        const double excess = axis_distance - 1.0;
        const double inverse = 1.0 / (excess * excess + p[2] * p[2]);
        const double fourth = inverse * inverse, sixth = fourth * inverse;
        sum += fourth;
        slope[0] += sixth * excess * x / axis_distance;
        slope[1] += sixth * excess * p[1] / axis_distance;
        slope[2] += sixth * p[2];
    }
    const double value = 1.0 / std::sqrt(std::sqrt(sum));
    const double factor = value / sum;  // sum^(-5/4)
    return {value, {factor * slope[0], factor * slope[1], factor * slope[2]}};
}

double RingRowField::value(const Point& p) const {
    return sample(p).value;
}

Point RingRowField::step_to_surface(const Point& p) const {
    constexpr double kLongestStep = 0.3;
    // Where no coordinate is negative; a coordinate that is zero stays so.
    const Sample here = sample({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
    double squared = 0.0;
    for (const double g : here.gradient) squared += g * g;
    double factor = (kTubeRadius - here.value) / squared;
    const double step = std::abs(factor) * std::sqrt(squared);
    if (step > kLongestStep) factor *= kLongestStep / step;
    Point moved = p;
    for (std::size_t k = 0; k < 3; ++k) {
        if (p[k] != 0.0) moved[k] += (p[k] > 0.0 ? factor : -factor) * here.gradient[k];
    }
    return moved;
}

}  // namespace ricci
