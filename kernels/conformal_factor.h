// Conformal factors as the kernels read them, and in what arithmetic a triangle is evaluated.
#pragma once

#include <concepts>
#include <span>
#include <type_traits>

#include "kernels/connectivity.h"

namespace ricci {

/// A conformal factor per vertex. Where needle-like triangles have angles of 1e-8, curvature moves 1e8 times
/// as much as u: a double cannot hold such a u. It is then the unevaluated sum high + low, some 32 digits.
struct ConformalFactor {
    std::span<const double> high;  // V, or empty: u = 0
    std::span<const double> low;   // V, or empty: 0; not read where Real is double

    ConformalFactor() = default;
    template <class Range>
    requires std::convertible_to<const Range&, std::span<const double>> ConformalFactor(const Range& factor)
        : high(factor) {}  // NOLINT(google-explicit-constructor): a view
    ConformalFactor(std::span<const double> first, std::span<const double> rest) : high(first), low(rest) {}

    [[nodiscard]] bool empty() const { return high.empty(); }
    template <class Real>
    [[nodiscard]] Real at(Index v) const {
        const auto i = static_cast<std::size_t>(v);
        if constexpr (std::is_same_v<Real, double>) {
            return high[i];
        } else {
            return low.empty() ? Real(high[i]) : Real(high[i]) + Real(low[i]);
        }
    }
};

/// Digits cancel in lengths alone: once the differences of a triangle's sides are known to full relative
/// accuracy, the processor's own arithmetic suffices for its angles. So lengths may be of any type, triangles
/// are of these.
template <class Real>
using TriangleReal = std::conditional_t<std::is_same_v<Real, double>, double, long double>;

}  // namespace ricci
