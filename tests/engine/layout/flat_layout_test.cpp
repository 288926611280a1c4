// Flat surfaces against moduli that are known: tori and annuli.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/engine/layout/layout_checks.h"
#include "tests/support/flat_torus.h"

namespace ricci {
namespace {

using testing::at;
using testing::position_of;
using testing::structure_of;
using Number = std::complex<double>;

Number translation(const Isometry<double>& element) {
    // Not a rotation: a = +-1.
    EXPECT_NEAR(std::abs(element.a.re), 1.0, 1e-9);
    EXPECT_NEAR(element.a.im, 0.0, 1e-9);
    const std::array<double, 3> p = image_of_origin(0, element);
    return {p[0], p[1]};
}

/// The lattice of the group, reduced.
Number modulus(const SurfaceStructure& s) {
    Number a = translation(s.group.generators[0].element), b = translation(s.group.generators[1].element);
    // Area 1, a and b positively oriented (a1 . b1 = +1).
    EXPECT_NEAR((std::conj(a) * b).imag(), 1.0, 1e-9);
    testing::reduce(a, b);
    return (b / a).imag() > 0 ? b / a : -b / a;
}

TEST(FlatLayout, ATorusOfRevolutionHasItsModulusToSecondOrder) {
    std::vector<double> error;
    for (const Index faces : {1000, 4000, 16000}) {
        const SurfaceStructure s = structure_of(testing::generated("torus", faces));
        const Number tau = modulus(s);
        error.push_back(std::abs(tau - Number(0, std::sqrt(5.25))));
        const testing::Lattice lattice = testing::lattice_of(s.flow.triangulation, s.flow.edge_length);
        // Both develop the same lengths; curvatures of 1e-10 at most do not add up.
        EXPECT_LE(std::abs(lattice.modulus().imag() - tau.imag()), 1e-9);
        EXPECT_LE(std::abs(std::abs(lattice.modulus().real()) - std::abs(tau.real())), 1e-9);
    }
    // Faces shrink to a half each time: the error to a quarter, less what higher orders take on the coarsest.
    EXPECT_GT(error[0], 3.5 * error[1]);
    EXPECT_LT(error[0], 4.5 * error[1]);
    EXPECT_GT(error[1], 3.8 * error[2]);
    EXPECT_LT(error[1], 4.2 * error[2]);
    EXPECT_LT(error[2], 2e-3);
}

TEST(FlatLayout, AnIrregularTorusAgreesWithItsDevelopment) {
    for (const SurfaceMesh& mesh :
         {testing::bumpy_torus(12, 9, 0.2, 3), testing::generated("torus", 1000, 0.45),
          testing::intrinsic_mesh(testing::one_vertex_torus(1.0, 1.3, 2.2))}) {
        const SurfaceStructure s = structure_of(mesh);
        const Number tau = modulus(s);
        const Number other = testing::lattice_of(s.flow.triangulation, s.flow.edge_length).modulus();
        EXPECT_NEAR(tau.imag(), other.imag(), 1e-9);
        // The real part is known up to sign where it is -1/2 or 1/2.
        EXPECT_NEAR(std::abs(tau.real()), std::abs(other.real()), 1e-9);
    }
}

/// Height over circumference, from the layout: boundaries are two straight lines along the translation.
double annulus_modulus(const SurfaceStructure& s) {
    const Number around = translation(s.group.letters[0]);
    const CommonRefinement& r = *s.refinement;
    // Direction of the translation in the layout.
    const Number turn(s.layout.base_frame.a.re, s.layout.base_frame.a.im);
    const Number direction = around / std::abs(around) * turn * turn;
    double low = 1e300, high = -1e300;
    const auto height = [&](Index corner) {
        const std::array<double, 3>& p = position_of(s.layout, corner);
        return (std::conj(direction) * Number(p[0], p[1])).imag();
    };
    for (Index c = 0; c < r.corner_count(); ++c) {
        low = std::min(low, height(c));
        high = std::max(high, height(c));
    }
    double length = 0;
    for (Index c = 0; c < r.corner_count(); ++c) {
        if (r.twin[at(c)] >= 0) continue;
        // Angles at the boundary miss pi by 1e-10 each at most.
        const double h = height(c);
        EXPECT_NEAR(std::min(h - low, high - h), 0.0, 1e-9);
        length += testing::distance(0, position_of(s.layout, c), position_of(s.layout, r.next(c)));
    }
    EXPECT_NEAR(length, 2 * std::abs(around), 1e-9);
    // The area is 1.
    EXPECT_NEAR((high - low) * std::abs(around), 1.0, 1e-9);
    return (high - low) / std::abs(around);
}

TEST(FlatLayout, ACylinderHasItsModulusAtEveryResolution) {
    // circumference 2 pi at height h is unrolled exactly, up to chords: the generator takes the chords to
    // add up to 2 pi.
    for (const Index faces : {100, 1000})
        for (const double height : {0.3, 1.0, 4.0}) {
            GenerateOptions options;
            options.faces = faces;
            options.height = height;
            const SurfaceMesh mesh = generate("annulus", options);
            const SurfaceStructure s = structure_of(mesh);
            EXPECT_NEAR(annulus_modulus(s), height / (2 * std::numbers::pi), 1e-9);
        }
}

TEST(FlatLayout, APlaneAnnulusHasItsModulusToSecondOrder) {
    std::vector<double> error;
    for (const Index faces : {1000, 4000, 16000}) {
        const SurfaceMesh mesh = testing::generated("annulus-planar", faces);
        error.push_back(
            std::abs(annulus_modulus(structure_of(mesh)) - std::log(2.5) / (2 * std::numbers::pi)));
    }
    EXPECT_GT(error[0], 3.5 * error[1]);
    EXPECT_LT(error[0], 4.5 * error[1]);
    EXPECT_GT(error[1], 3.8 * error[2]);
    EXPECT_LT(error[1], 4.2 * error[2]);
    EXPECT_LT(error[2], 1e-4);
}

TEST(FlatLayout, PiecesFillTheArea) {
    for (const char* name : {"torus", "annulus"}) {
        const SurfaceMesh mesh = testing::generated(name, 1000, 0.4);
        const SurfaceStructure s = structure_of(mesh);
        double sum = 0;
        for (Index p = 0; p < s.refinement->piece_count(); ++p) {
            const double area = testing::image_area(*s.refinement, s.layout, p);
            EXPECT_GT(area, 0.0);
            sum += area;
        }
        EXPECT_NEAR(sum, 1.0, 1e-10);
    }
}

}  // namespace
}  // namespace ricci
