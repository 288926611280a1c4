#include "io/mesh/checks/collinear.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ricci {
namespace {

using Long = long double;
// Products of two doubles, and their rounding errors, must neither overflow nor underflow.
static_assert(std::numeric_limits<Long>::max_exponent > 4 * std::numeric_limits<double>::max_exponent &&
                  std::numeric_limits<Long>::digits >= 64,
              "the exact test needs an extended long double");

/// A sum of up to 12 numbers kept exactly as nonoverlapping components (Shewchuk, "Adaptive precision
/// floating-point arithmetic", figure 8: grow-expansion).
class ExactSum {
  public:
    void add(Long value) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            const Long sum = value + term_[i];
            const Long part = sum - value;
            const Long error = (value - (sum - part)) + (term_[i] - part);
            if (error != 0) term_[kept++] = error;
            value = sum;
        }
        if (value != 0) term_[kept++] = value;
        size_ = kept;
    }
    void add_product(double x, double y) {
        const Long product = static_cast<Long>(x) * y;
        add(product);
        add(std::fma(static_cast<Long>(x), static_cast<Long>(y), -product));
    }
    [[nodiscard]] bool zero() const { return size_ == 0; }

  private:
    std::array<Long, 16> term_{};
    std::size_t size_ = 0;
};

/// Twice the signed area of the projection to coordinates i, j: zero or not, exactly.
bool projection_is_flat(const Point& a, const Point& b, const Point& c, std::size_t i, std::size_t j) {
    const Long left = (static_cast<Long>(b[i]) - a[i]) * (static_cast<Long>(c[j]) - a[j]);
    const Long right = (static_cast<Long>(b[j]) - a[j]) * (static_cast<Long>(c[i]) - a[i]);
    // Four differences, two products, one difference: each rounds by at most half an ulp.
    const Long bound = 8 * std::numeric_limits<Long>::epsilon() * (std::abs(left) + std::abs(right));
    if (std::abs(left - right) > bound) return false;
    ExactSum sum;
    sum.add_product(a[i], b[j]);
    sum.add_product(-a[j], b[i]);
    sum.add_product(b[i], c[j]);
    sum.add_product(-b[j], c[i]);
    sum.add_product(c[i], a[j]);
    sum.add_product(-c[j], a[i]);
    return sum.zero();
}

}  // namespace

bool collinear(const Point& a, const Point& b, const Point& c) {
    return projection_is_flat(a, b, c, 0, 1) && projection_is_flat(a, b, c, 1, 2) &&
           projection_is_flat(a, b, c, 2, 0);
}

}  // namespace ricci
