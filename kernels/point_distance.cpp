#include "kernels/point_distance.h"

#include <cmath>

namespace ricci {

double point_distance(const Point& a, const Point& b) {
    // Squares of doubles neither overflow nor underflow in long double.
    const long double x = static_cast<long double>(b[0]) - a[0];
    const long double y = static_cast<long double>(b[1]) - a[1];
    const long double z = static_cast<long double>(b[2]) - a[2];
    return static_cast<double>(std::sqrt(x * x + y * y + z * z));
}

}  // namespace ricci
