// The lattice of a flat torus: reduced basis, modulus, and all its closed geodesics.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "engine/layout/surface_group.h"
#include "engine/topology/words.h"

namespace ricci {

/// m a1 + n b1: a class of closed curves by its coefficients in the two generators.
using LatticeCoefficients = std::array<std::int64_t, 2>;

/// A reduced basis (Gauss, Lagrange): `first` a shortest vector, `second` a shortest one that is not a
/// multiple of it, the pair positively oriented. Unique but for the common sign, which is the one that makes
/// the first coefficient of `first` that is not 0 positive, and for ties, which `modulus` decides.
struct Lattice {
    std::complex<double> first, second;                           // units of the generators' plane
    LatticeCoefficients first_coefficients, second_coefficients;  // in the generators
    /// second / first in the standard fundamental domain, |Re| <= 1/2, |tau| >= 1, Im > 0; the orientation is
    /// that of the plane, which is that of the faces: a mirror image has -conj(tau). Of two equivalent points
    /// of the domain's boundary it is the one with Re >= 0. Whatever lies within kLatticeTie of the boundary
    /// is put on it first, so that rounding decides nothing: on Re = 1/2, or on |tau| = 1.
    std::complex<double> modulus;
    double length_ratio = 1.0;  // |modulus| >= 1: of adjacent edges of the parallelogram (thesis, 6.3.2)
    double angle = 0.0;         // arg(modulus), radians, in [pi/3, 2 pi/3]: between them
};

/// Distance from the domain's boundary, and relative difference of lengths, that count as none.
inline constexpr double kLatticeTie = 1e-9;

/// Reduces the lattice that two translations span. Coefficients are exact; the vectors are summed in long
/// double, so they are as exact as generators of that length can tell. Throws std::invalid_argument for
/// vectors that are not finite, or parallel to the rounding of their coordinates.
Lattice reduce_lattice(std::complex<double> a, std::complex<double> b);

/// The lattice of a torus without cones (thesis, 6.3.3.3); coefficients are those in a1, b1. It is reduced
/// from the loops of the homotopy basis, which are the shortest on the mesh: long words for a1 and b1 cost
/// no digits. Throws std::invalid_argument for any other group.
Lattice torus_lattice(const SurfaceGroup& group);

/// The translation z -> z + t, as a Euclidean displacement, of an isometry of the plane.
std::complex<double> translation_of(const Isometry<double>& element);

/// A class of closed geodesics of the torus, up to orientation (the geodesics of a class are parallel copies
/// of one another).
struct LatticeLength {
    double length = 0.0;               // in units of the shortest
    LatticeCoefficients coefficients;  // in the generators; the first that is not 0 is positive
    std::int64_t power = 1;            // greatest common divisor of the coefficients; 1: primitive
    std::int64_t multiplicity = 1;     // classes of this length, relative difference kLatticeTie

    [[nodiscard]] bool primitive() const { return power == 1; }
};

struct LatticeSpectrum {
    std::vector<LatticeLength> lengths;  // ascending; every class has an entry, powers included
    double complete_up_to = 0.0;         // there are no others up to this length
};

/// All classes up to `max_length` in units of the shortest, lengths longer by kLatticeTie (relative)
/// included; where `count` is positive, instead as many as complete the multiplet of the count-th. Throws
/// std::invalid_argument for a length that is not positive and finite, a negative count, and where more than
/// 20 million classes would be listed.
LatticeSpectrum lattice_spectrum(const Lattice& lattice, double max_length, std::int64_t count = 0);

/// a1^m b1^n.
Word lattice_word(const LatticeCoefficients& coefficients);

}  // namespace ricci
