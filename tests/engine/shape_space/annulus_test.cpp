#include "engine/shape_space/annulus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "engine/remesh/resample.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::structure_of;

SurfaceMesh generated_annulus(const char* name, Index faces, double height, double jitter = 0.0) {
    GenerateOptions options;
    options.faces = faces;
    options.height = height;
    options.jitter = jitter;
    options.seed = 5;
    return generate(name, options);
}

Annulus annulus_of(const SurfaceMesh& mesh, bool delaunay = true) {
    StructureOptions options;
    options.flow.tolerance = 1e-12;
    options.flow.delaunay = delaunay;
    return make_annulus(structure_of(mesh, options));
}

TEST(Annulus, FlatCylinderIsExact) {
    for (const double height : {0.4, 1.0, 30.0}) {
        const double exact = height / (2 * std::numbers::pi);
        for (const Index faces : {200, 2000}) {
            const Annulus annulus = annulus_of(generated_annulus("annulus", faces, height));
            EXPECT_NEAR(annulus.modulus, exact, 1e-10 * exact);
            EXPECT_NEAR(annulus.height * annulus.circumference, 1.0, 1e-14);
            EXPECT_NEAR(annulus.height / annulus.circumference, annulus.modulus, 1e-14 * exact);
            EXPECT_LE(annulus.spread, 1e-9);
        }
    }
}

TEST(Annulus, PlaneAnnulusConvergesInSecondOrder) {
    const double exact = std::log(2.5) / (2 * std::numbers::pi);
    std::vector<double> error;
    for (const Index faces : {500, 2000, 8000})
        error.push_back(
            std::abs(annulus_of(generated_annulus("annulus-planar", faces, 1.0)).modulus - exact));
    EXPECT_LT(error[2], 1e-3 * exact);
    EXPECT_NEAR(0.5 * std::log2(error[0] / error[2]), 2.0, 0.2);
}

TEST(Annulus, ModulusIsConformallyInvariant) {
    const SurfaceMesh mesh = generated_annulus("annulus-planar", 1200, 1.0, 0.35);
    const Annulus annulus = annulus_of(mesh), plain = annulus_of(mesh, false);
    EXPECT_LE(annulus.spread, 1e-9);
    testing::Random random(2);
    EXPECT_NEAR(
        annulus_of(testing::relabelled(mesh, random.permutation(mesh.connectivity.vertex_count), random))
            .modulus,
        annulus.modulus, 1e-9);
    for (const Point& centre : {Point{0.3, 0.1, 0.7}, Point{4.0, -1.0, 0.2}})
        EXPECT_NEAR(annulus_of(testing::inverted(mesh, centre), false).modulus, plain.modulus, 1e-9);
    std::vector<Triangle> triangles = triangles_of(mesh.connectivity);
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
    EXPECT_NEAR(annulus_of(make_surface_mesh(mesh.points, triangles)).modulus, annulus.modulus, 1e-9);
}

TEST(Annulus, SampleFilesAgreeWithTheirSubdivision) {
    for (const char* name : {"annulus.obj", "cylinder.off", "train-station.off"}) {
        RICCI_DATA_FILE_OR_SKIP(path, std::string("meshes/annulus/") + name);
        const SurfaceMesh mesh = testing::load_component(path);
        const Annulus coarse = annulus_of(mesh), fine = annulus_of(subdivide_midpoint(mesh));
        EXPECT_LE(coarse.spread, 1e-9) << name;
        // Second order: the difference is the error of the coarse one, less a quarter.
        EXPECT_NEAR(coarse.modulus, fine.modulus, 0.01 * fine.modulus) << name;
    }
}

TEST(Annulus, SpectrumIsTheCoreAndItsPowers) {
    const AnnulusSpectrum spectrum = annulus_spectrum(3.0);
    EXPECT_EQ(spectrum.lengths, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(spectrum.primitive, (std::vector<std::uint8_t>{1, 0, 0}));
    EXPECT_EQ(spectrum.complete_up_to, 3.0);
    EXPECT_EQ(annulus_spectrum(2.9).lengths.size(), 2U);
    EXPECT_EQ(annulus_spectrum(0.5).lengths.size(), 0U);
    EXPECT_EQ(annulus_spectrum(0.0, 5).lengths.size(), 5U);
    EXPECT_EQ(annulus_spectrum(0.0, 5).complete_up_to, 5.0);
    EXPECT_THROW(annulus_spectrum(0.0), std::invalid_argument);
    EXPECT_THROW(annulus_spectrum(-1.0), std::invalid_argument);
    EXPECT_THROW(annulus_spectrum(1.0, -2), std::invalid_argument);
    EXPECT_THROW(annulus_spectrum(std::numeric_limits<double>::infinity()), std::invalid_argument);
}

TEST(Annulus, RefusesOtherSurfaces) {
    EXPECT_THROW(make_annulus(structure_of(testing::generated("torus", 300))), std::invalid_argument);
    EXPECT_THROW(make_annulus(structure_of(testing::generated("disk", 300))), std::invalid_argument);
    EXPECT_THROW(make_annulus(SurfaceStructure{}), std::invalid_argument);
    StructureOptions free;
    free.flow.boundary = Boundary::free;
    EXPECT_THROW(make_annulus(structure_of(testing::generated("annulus", 300), free)), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
