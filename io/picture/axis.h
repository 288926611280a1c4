// Ranges of values in pictures: linear and logarithmic scales with round ticks.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ricci {

enum class ScaleKind : std::uint8_t { linear, logarithmic };

/// A range of values on a scale.
class Axis {
  public:
    /// Throws std::invalid_argument unless low <= high, both finite and, on a logarithmic scale, positive.
    Axis(double low, double high, ScaleKind kind = ScaleKind::linear);

    [[nodiscard]] double low() const { return low_; }
    [[nodiscard]] double high() const { return high_; }
    [[nodiscard]] ScaleKind kind() const { return kind_; }

    /// 0 at low, 1 at high, beyond these outside the range; 1/2 on a range of one value; NaN of NaN; minus
    /// infinity for what a logarithmic scale does not reach.
    [[nodiscard]] double fraction_of(double value) const;
    /// The value at a fraction.
    [[nodiscard]] double value_at(double fraction) const;

    /// About `wanted` round values in the range, ascending: multiples of 1, 2 or 5 times a power of ten; on a
    /// logarithmic scale powers of ten, with 2 and 5 times these over less than three decades.
    [[nodiscard]] std::vector<double> ticks(int wanted) const;

    bool operator==(const Axis&) const = default;

  private:
    double low_, high_;
    ScaleKind kind_;
};

/// A tick's number with up to six digits: "0.5", "20000", "1e-7"; the same in every locale.
std::string tick_label(double value);

}  // namespace ricci
