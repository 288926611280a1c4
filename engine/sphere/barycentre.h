// The Moebius normalisation: masses on the sphere brought to balance.
#pragma once

#include <complex>
#include <span>

namespace ricci {

/// A similarity of the plane, z -> (z - centre)/scale. Followed by the stereographic projection it is, up to
/// rotation, every Moebius map from the plane to the sphere.
struct PlaneSimilarity {
    std::complex<long double> centre = 0.0L;
    long double scale = 1.0L;
    long double imbalance = 1.0L;  // length of the centre of mass that is left, of the unit ball
};

/// w -> (2w, |w|^2 - 1)/(|w|^2 + 1): 0 to the south pole, the unit circle to the equator.
///
/// The similarity after which the masses `mass` at the images of `z`, and `mass_at_infinity` at the north
/// pole, have their centre of mass at the origin: the minimum of sum m_i log((s^2 + |z_i - c|^2)/s) - m_inf
/// log s, a convex function of (c, s) in hyperbolic space (conformal barycentre: Douady, Earle 1986; Newton's
/// step as in Baden, Crane, Kazhdan 2018). Unique, if no point carries half of the mass; else there is none,
/// which the imbalance tells. Newton's method from `start`. It ends early where the scale falls below what
/// the positions resolve, 1e-15 |centre|: then lay them out anew with the origin near the centre.
PlaneSimilarity balance(std::span<const std::complex<long double>> z, std::span<const long double> mass,
                        long double mass_at_infinity, const PlaneSimilarity& start);

}  // namespace ricci
