// How a solve ended. Numerical outcomes are values, never exceptions.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace ricci {

/// Stored in HDF5 by these names and numbers: append only.
enum class Status : std::uint8_t {
    converged,
    max_iterations,
    inadmissible_target,
    inadmissible_metric,
    factorization_failed,
    stalled,
    not_finite,
    timeout,
    out_of_memory,
    cancelled,
    invalid_input,
    internal_error
};

inline constexpr std::array<std::string_view, 12> kStatusNames = {"converged",
                                                                  "max_iterations",
                                                                  "inadmissible_target",
                                                                  "inadmissible_metric",
                                                                  "factorization_failed",
                                                                  "stalled",
                                                                  "not_finite",
                                                                  "timeout",
                                                                  "out_of_memory",
                                                                  "cancelled",
                                                                  "invalid_input",
                                                                  "internal_error"};

constexpr std::string_view name_of(Status status) {
    return kStatusNames[static_cast<std::size_t>(status)];
}

}  // namespace ricci
