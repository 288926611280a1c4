// Teichmueller distances of flat surfaces: tori and annuli.
#pragma once

#include <complex>

namespace ricci {

/// Distance of two tori with moduli tau1, tau2 (any with Im > 0), no marking: the smallest (1/2) log K over
/// all quasi-conformal maps that keep the orientation (a mirror image may be far). It is half the distance in
/// the upper half plane of curvature -1, minimised over PSL(2,Z) (Teichmueller 1939). Throws
/// std::invalid_argument for a modulus that is not finite or not in the upper half plane.
double torus_distance(std::complex<double> tau1, std::complex<double> tau2);

/// (1/2) |log(m1 / m2)|, of two annuli by height / circumference. Throws std::invalid_argument for a modulus
/// that is not positive and finite.
double annulus_distance(double m1, double m2);

}  // namespace ricci
