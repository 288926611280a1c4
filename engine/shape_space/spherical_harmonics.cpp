#include "engine/shape_space/spherical_harmonics.h"

#include <cmath>
#include <numbers>

namespace ricci {

// Y_lm = N_lm P_lm(z) / sin^m * (x + i y)^m: the normalised quotient q_l = N_lm P_lm / sin^m is a polynomial
// in z with q_m constant and, by the three-term recurrence of the Legendre functions,
//     q_l = a_l (z q_(l-1) - q_(l-2) / a_(l-1)),   a_l = sqrt((4 l^2 - 1) / (l^2 - m^2)).
void spherical_harmonics(int degree, const Point& p, std::span<double> value) {
    const double x = p[0], y = p[1], z = p[2];
    double cosine = 1.0, sine = 0.0;                          // Re, Im (x + i y)^m
    double sectoral = 0.5 * std::sqrt(std::numbers::inv_pi);  // q_m
    for (int m = 0; m <= degree; ++m) {
        if (m > 0) {
            const double turned = cosine * x - sine * y;
            sine = cosine * y + sine * x;
            cosine = turned;
            sectoral *= std::sqrt((2.0 * m + 1.0) / (2.0 * m));
        }
        const double scale = m == 0 ? 1.0 : std::numbers::sqrt2;
        double before = 0.0, q = sectoral, factor_before = 1.0;
        for (int l = m; l <= degree; ++l) {
            if (l > m) {
                const double factor = std::sqrt((4.0 * l * l - 1.0) / (1.0 * l * l - 1.0 * m * m));
                const double next = factor * (z * q - before / factor_before);
                before = q;
                q = next;
                factor_before = factor;
            }
            value[harmonic_index(l, m)] = scale * q * cosine;
            if (m > 0) value[harmonic_index(l, -m)] = scale * q * sine;
        }
    }
}

}  // namespace ricci
