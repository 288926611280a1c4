#include "engine/shape_space/annulus.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/shape_space/lattice.h"

namespace ricci {
namespace {

/// Angle by which an isometry of the plane turns, radians.
double turn_of(const Isometry<double>& element) {
    return 2.0 * std::abs(std::atan(element.a.im / element.a.re));
}

}  // namespace

Annulus make_annulus(const SurfaceStructure& structure) {
    const bool flat_annulus = structure.kappa == 0 && structure.basis && structure.basis->loops() == 0 &&
                              structure.basis->boundaries() == 2 && structure.basis->cones().empty() &&
                              structure.flow.boundary == Boundary::geodesic;
    if (!flat_annulus)
        throw std::invalid_argument(
            "make_annulus: not the flat structure of an annulus with geodesic boundaries");
    const double first = std::abs(translation_of(structure.group.letters.at(0))),
                 second = std::abs(translation_of(structure.group.letters.at(1)));
    Annulus annulus;
    annulus.circumference = 0.5 * (first + second);
    annulus.height = 1.0 / annulus.circumference;
    annulus.modulus = annulus.height / annulus.circumference;
    annulus.spread = std::abs(first - second) / annulus.circumference;
    for (const Isometry<double>& letter : structure.group.letters)
        annulus.spread = std::max(annulus.spread, turn_of(letter));
    return annulus;
}

AnnulusSpectrum annulus_spectrum(double max_length, std::int64_t count) {
    if (count < 0 || (count == 0 && !(max_length > 0.0 && max_length < 1e8)))
        throw std::invalid_argument(
            "annulus_spectrum: needs a positive length below 1e8 or a positive count");
    AnnulusSpectrum spectrum;
    const std::int64_t powers =
        count > 0 ? count : static_cast<std::int64_t>(std::floor(max_length * (1.0 + kLatticeTie)));
    for (std::int64_t k = 1; k <= powers; ++k) {
        spectrum.lengths.push_back(static_cast<double>(k));
        spectrum.primitive.push_back(k == 1);
    }
    spectrum.complete_up_to = count > 0 ? static_cast<double>(count) : max_length;
    return spectrum;
}

}  // namespace ricci
