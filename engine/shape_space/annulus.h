// The conformal annulus: a flat cylinder with geodesic boundaries.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/structure/surface_structure.h"

namespace ricci {

struct Annulus {
    double modulus = 0.0;        // height / circumference
    double height = 0.0;         // of the cylinder of area 1
    double circumference = 0.0;  // of the same: length of the core
    /// Largest relative difference between the circumference and the translations along either boundary, the
    /// turns they should not have (radians) included: what rounding and the flow's residual leave.
    double spread = 0.0;
};

/// From the flat structure of a surface of genus 0 with two boundaries, both geodesic (interface.md; the flow
/// through the double makes them so). The cylinder has area 1, so its modulus is 1 / circumference^2. Throws
/// std::invalid_argument for any other structure.
Annulus make_annulus(const SurfaceStructure& structure);

/// Closed geodesics up to orientation, in units of the core: it and its powers. The k-th entry is k: the
/// length and the power alike.
struct AnnulusSpectrum {
    std::vector<double> lengths;
    std::vector<std::uint8_t> primitive;  // the first only
    double complete_up_to = 0.0;
};

/// Up to `max_length`, or, where `count` is positive, so many. Throws std::invalid_argument for a length that
/// is not positive and finite, or a negative count.
AnnulusSpectrum annulus_spectrum(double max_length, std::int64_t count = 0);

}  // namespace ricci
