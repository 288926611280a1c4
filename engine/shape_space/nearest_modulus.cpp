#include "engine/shape_space/nearest_modulus.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/shape_space/lattice.h"

namespace ricci {
namespace {

using Modulus = std::complex<double>;

void require_modulus(const Modulus& tau) {
    if (!std::isfinite(tau.real()) || !std::isfinite(tau.imag()) || !(tau.imag() > 0.0))
        throw std::invalid_argument("a modulus must lie in the upper half plane");
}

Modulus image(const ModularElement& m, const Modulus& tau) {
    return (static_cast<double>(m[0]) * tau + static_cast<double>(m[1])) /
           (static_cast<double>(m[2]) * tau + static_cast<double>(m[3]));
}

ModularElement product(const ModularElement& x, const ModularElement& y) {
    return {x[0] * y[0] + x[1] * y[2], x[0] * y[1] + x[1] * y[3], x[2] * y[0] + x[3] * y[2],
            x[2] * y[1] + x[3] * y[3]};
}

ModularElement inverse(const ModularElement& m) {
    return {m[3], -m[1], -m[2], m[0]};
}

/// The element that takes tau into the standard fundamental domain.
ModularElement reduction(const Modulus& tau) {
    const Lattice lattice = reduce_lattice(1.0, tau);
    const LatticeCoefficients &a = lattice.first_coefficients, &b = lattice.second_coefficients;
    return {b[1], b[0], a[1], a[0]};
}

/// The element that takes w nearest to z, both reduced.
ModularElement between(const Modulus& z, const Modulus& w) {
    if (z.imag() < w.imag()) return inverse(between(w, z));
    ModularElement best{1, 0, 0, 1};
    double nearest = std::numeric_limits<double>::infinity();
    for (const ModularElement& s : {ModularElement{1, 0, 0, 1}, ModularElement{0, -1, 1, -1},
                                    ModularElement{0, -1, 1, 0}, ModularElement{0, -1, 1, 1}}) {
        const auto shift = static_cast<std::int64_t>(std::round(z.real() - image(s, w).real()));
        const ModularElement element = product({1, shift, 0, 1}, s);
        const double distance = marked_torus_distance(z, image(element, w));
        if (distance >= nearest) continue;
        nearest = distance;
        best = element;
    }
    return best;
}

}  // namespace

EquivalentModulus nearest_modulus(std::complex<double> tau, std::complex<double> reference) {
    require_modulus(tau);
    require_modulus(reference);
    const ModularElement reduce = reduction(tau), reduce_reference = reduction(reference);
    const Modulus w = image(reduce, tau), z = image(reduce_reference, reference);
    const ModularElement back = product(inverse(reduce_reference), between(z, w));
    return {image(back, w), product(back, reduce)};
}

double marked_torus_distance(std::complex<double> tau1, std::complex<double> tau2) {
    require_modulus(tau1);
    require_modulus(tau2);
    return std::asinh(std::abs(tau1 - tau2) / (2.0 * std::sqrt(tau1.imag()) * std::sqrt(tau2.imag())));
}

}  // namespace ricci
