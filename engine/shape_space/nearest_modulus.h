// Moduli of marked tori: distances in the upper half plane, and the change of marking that keeps a path
// together.
#pragma once

#include <array>
#include <complex>
#include <cstdint>

namespace ricci {

/// The element tau -> (m[0] tau + m[1]) / (m[2] tau + m[3]) of SL(2,Z): the marking (a, b), tau = b / a,
/// becomes (m[2] b + m[3] a, m[0] b + m[1] a).
using ModularElement = std::array<std::int64_t, 4>;

struct EquivalentModulus {
    std::complex<double> modulus;
    ModularElement element{1, 0, 0, 1};  // from the modulus that was given to this one
};

/// Of all moduli equivalent to `tau` under PSL(2,Z), the one nearest to `reference` in the upper half plane
/// (by flat_distance.cpp's argument that four elements suffice between reduced moduli). Throws
/// std::invalid_argument for moduli that are not finite or not in the upper half plane.
EquivalentModulus nearest_modulus(std::complex<double> tau, std::complex<double> reference);

/// Teichmueller distance of two marked tori: half the distance in the upper half plane of curvature -1.
/// Throws as above.
double marked_torus_distance(std::complex<double> tau1, std::complex<double> tau2);

}  // namespace ricci
