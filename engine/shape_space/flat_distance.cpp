#include "engine/shape_space/flat_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "engine/shape_space/lattice.h"

namespace ricci {
namespace {

using Modulus = std::complex<double>;

Modulus reduced_modulus(const Modulus& tau) {
    if (!std::isfinite(tau.real()) || !std::isfinite(tau.imag()) || !(tau.imag() > 0.0))
        throw std::invalid_argument("torus_distance: a modulus must lie in the upper half plane");
    return reduce_lattice(1.0, tau).modulus;
}

/// Half the hyperbolic distance.
double half_distance(const Modulus& z, const Modulus& w) {
    return std::asinh(std::abs(z - w) / (2.0 * std::sqrt(z.imag()) * std::sqrt(w.imag())));
}

}  // namespace

// Which elements suffice. Let z, w lie in the standard domain, y_z >= y_w their heights, r = y_z / y_w, and
// take g: w -> (a w + b) / (c w + d) in SL(2,Z). With p = c w + d and q = a w + b - x_z p,
//     2 cosh d(z, g w) = (y_z / y_w) |p|^2 + |q|^2 / (y_z y_w),    Im(conj(p) q) = y_w,
// so |q| >= y_w / |p| and 2 cosh d(z, g w) >= r m + 1 / (r m), m = |c w + d|^2 >= 1. The translation that
// brings w nearest to the vertical through z has 2 cosh d <= r + 1/r + 1 / (4 y_z y_w), and as y_w >=
// sqrt(3)/2 that is at most r + 1/r + 1 / (3 r). The difference of the bounds,
//     (m - 1)(r - 1 / (r m)) - 1 / (3 r) >= ((m - 1)^2 / m - 1/3) / r,
// is positive for m >= 3 - hence for |c| >= 2, where m >= c^2 y_w^2 >= 3, and for |c| = 1, |d| >= 2, where
// m >= (3/2)^2 + 3/4. What is left is c = 0 and c = 1, d = -1, 0, 1: w, -1/(w - 1), -1/w, -1/(w + 1), each
// followed by the translation that brings it nearest to the vertical through z.
double torus_distance(std::complex<double> tau1, std::complex<double> tau2) {
    Modulus z = reduced_modulus(tau1), w = reduced_modulus(tau2);
    if (z.imag() < w.imag()) std::swap(z, w);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Modulus& image : std::array{w, -1.0 / (w - 1.0), -1.0 / w, -1.0 / (w + 1.0)})
        nearest = std::min(nearest, half_distance(z, image - std::round(image.real() - z.real())));
    return nearest;
}

double annulus_distance(double m1, double m2) {
    for (const double m : {m1, m2})
        if (!(m > 0.0) || !std::isfinite(m))
            throw std::invalid_argument("annulus_distance: a modulus must be positive and finite");
    return 0.5 * std::abs(std::log(m1) - std::log(m2));
}

}  // namespace ricci
