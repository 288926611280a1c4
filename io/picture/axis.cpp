#include "io/picture/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

namespace ricci {
namespace {

// digits * 10^exponent, rounded once.
double decimal(double digits, int exponent) {
    return exponent < 0 ? digits / std::pow(10.0, -exponent) : digits * std::pow(10.0, exponent);
}

std::vector<double> linear_ticks(double low, double high, int wanted) {
    if (low == high) return {low};
    const double coarse = (high - low) / std::max(1, wanted);
    int exponent = static_cast<int>(std::floor(std::log10(coarse)));
    double digits = 10.0;
    for (const double candidate : {5.0, 2.0, 1.0})
        if (decimal(candidate, exponent) >= coarse * (1.0 - 1e-9)) digits = candidate;
    const double step = decimal(digits, exponent);
    // A tick at an end belongs to the range although rounding may say otherwise.
    const double first = std::ceil(low / step - 1e-9), last = std::floor(high / step + 1e-9);
    std::vector<double> ticks;
    // Next to a huge offset steps may vanish in rounding: then there are none.
    for (double i = first; i <= last && ticks.size() < 1000; i += 1.0)
        ticks.push_back(decimal(i * digits, exponent));
    return ticks;
}

std::vector<double> logarithmic_ticks(double low, double high, int wanted) {
    const double decades = std::log10(high / low);
    if (decades < 1.0) return linear_ticks(low, high, wanted);
    const int stride = std::max(1, static_cast<int>(std::ceil(decades / std::max(1, wanted) - 1e-9)));
    const int first = static_cast<int>(std::floor(std::log10(low))),
              last = static_cast<int>(std::ceil(std::log10(high)));
    std::vector<double> ticks;
    for (int exponent = first; exponent <= last; ++exponent) {
        if (exponent % stride != 0) continue;
        for (const double digits : {1.0, 2.0, 5.0}) {
            const double value = decimal(digits, exponent);
            const bool inside = value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9);
            if (inside && (digits == 1.0 || decades < 3.0)) ticks.push_back(value);
        }
    }
    return ticks;
}

}  // namespace

Axis::Axis(double low, double high, ScaleKind kind) : low_(low), high_(high), kind_(kind) {
    if (!std::isfinite(low) || !std::isfinite(high) || low > high)
        throw std::invalid_argument("the range of an axis is not one");
    if (kind == ScaleKind::logarithmic && low <= 0.0)
        throw std::invalid_argument("a logarithmic axis starts above zero");
}

double Axis::fraction_of(double value) const {
    if (std::isnan(value)) return value;
    if (low_ == high_) return 0.5;
    if (kind_ == ScaleKind::linear) return (value - low_) / (high_ - low_);
    if (value <= 0.0) return -std::numeric_limits<double>::infinity();
    return std::log(value / low_) / std::log(high_ / low_);
}

double Axis::value_at(double fraction) const {
    if (kind_ == ScaleKind::linear) return low_ + fraction * (high_ - low_);
    return low_ * std::pow(high_ / low_, fraction);
}

std::vector<double> Axis::ticks(int wanted) const {
    return kind_ == ScaleKind::linear ? linear_ticks(low_, high_, wanted)
                                      : logarithmic_ticks(low_, high_, wanted);
}

std::string tick_label(double value) {
    std::string text = fmt::format("{:.6g}", value == 0.0 ? 0.0 : value);  // no -0
    // "1e-07" and "1e+20" carry a zero or a sign too many.
    const std::size_t exponent = text.find('e');
    if (exponent == std::string::npos) return text;
    std::size_t digits = exponent + 1;
    if (text[digits] == '+')
        text.erase(digits, 1);
    else if (text[digits] == '-')
        ++digits;
    while (digits + 1 < text.size() && text[digits] == '0') text.erase(digits, 1);
    return text;
}

}  // namespace ricci
