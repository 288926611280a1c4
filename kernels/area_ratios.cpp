#include "kernels/area_ratios.h"

#include <algorithm>
#include <cmath>

#include "kernels/vector_math.h"

namespace ricci {
namespace {

/// Sums run over so many strands side by side, element i in strand i mod kStrands, and are added up at the
/// end: the same order for every vector width.
constexpr std::size_t kStrands = 16;

struct Strands {
    alignas(64) double value[kStrands];
};

double total(const Strands& strands) {
    double sum = 0.0;
    for (const double value : strands.value) sum += value;
    return sum;
}

// Each of these takes a multiple of kStrands elements.
RICCI_VECTOR_CLONES void raise_to_largest(const double* x, std::size_t count, Strands& largest) {
    for (std::size_t i = 0; i < count; i += kStrands) {
#pragma omp simd
        for (std::size_t l = 0; l < kStrands; ++l)
            largest.value[l] = x[i + l] > largest.value[l] ? x[i + l] : largest.value[l];
    }
}

RICCI_VECTOR_CLONES void add_areas(const double* area, const double* log_ratio, std::size_t count, double top,
                                   Strands& before, Strands& after) {
    for (std::size_t i = 0; i < count; i += kStrands) {
#pragma omp simd
        for (std::size_t l = 0; l < kStrands; ++l) {
            before.value[l] += area[i + l];
            after.value[l] += area[i + l] * std::exp(log_ratio[i + l] - top);
        }
    }
}

RICCI_VECTOR_CLONES void add_squares(const double* x, std::size_t count, double middle, Strands& sum) {
    for (std::size_t i = 0; i < count; i += kStrands) {
#pragma omp simd
        for (std::size_t l = 0; l < kStrands; ++l) sum.value[l] += (x[i + l] - middle) * (x[i + l] - middle);
    }
}

/// The elements behind the last whole row of strands, filled up.
Strands rest_of(std::span<const double> x, double filling) {
    Strands rest;
    std::fill_n(rest.value, kStrands, filling);
    const std::size_t whole = x.size() / kStrands * kStrands;
    std::copy(x.begin() + static_cast<std::ptrdiff_t>(whole), x.end(), rest.value);
    return rest;
}

}  // namespace

double area_ratio_deviation(std::span<const double> area, std::span<const double> log_ratio) {
    const std::size_t whole = area.size() / kStrands * kStrands;
    Strands largest = rest_of(log_ratio, log_ratio[0]);
    raise_to_largest(log_ratio.data(), whole, largest);
    const double top = *std::max_element(largest.value, largest.value + kStrands);
    // Areas as exponentials relative to the largest ratio, so that factors of e^48 neither over- nor
    // underflow the sum.
    Strands before{}, after{};
    add_areas(area.data(), log_ratio.data(), whole, top, before, after);
    add_areas(rest_of(area, 0.0).value, rest_of(log_ratio, top).value, kStrands, top, before, after);
    const double middle = std::log(total(after) / total(before)) + top;
    Strands squares{};
    add_squares(log_ratio.data(), whole, middle, squares);
    add_squares(rest_of(log_ratio, middle).value, kStrands, middle, squares);
    return total(squares) / static_cast<double>(area.size());
}

}  // namespace ricci
