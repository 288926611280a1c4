// What an index keeps of a shape: made of lengths and coordinates by the stated rules, and of geometry alone.
#include "engine/shape_space/shape_descriptor.h"

#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci {
namespace {

using testing::generated;

ShapeDescriptor described(const SurfaceMesh& mesh, double max_length = 4.0) {
    ShapeOptions options;
    options.max_length = max_length;
    ShapeDescriptor d = describe_shape(mesh, options);
    EXPECT_EQ(d.status, Status::converged) << d.message;
    return d;
}

TEST(ShapeDescriptor, HyperbolicLengthsAreTheCompleteSpectrum) {
    for (const char* name : {"eight", "pants", "punctured-torus", "genus-g-one-boundary"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 500, 0.3);
        const ShapeDescriptor d = described(mesh, 5.0);
        const LengthSpectrum s = testing::spectrum_up_to(testing::thinned(mesh), 5.0);
        EXPECT_EQ(d.complete_up_to, 5.0);
        testing::expect_same_lengths(d.lengths, testing::lengths_of(s), 1e-10);
        ASSERT_EQ(d.primitive.size(), s.lengths.size());
        for (std::size_t k = 0; k < s.lengths.size(); ++k)
            EXPECT_EQ(d.primitive[k] != 0, s.lengths[k].power == 1);
    }
}

void expect_fingerprint(const SurfaceMesh& mesh) {
    const ShapeDescriptor d = described(mesh, 3.0);
    const LengthSpectrum s = testing::spectrum_up_to(testing::thinned(mesh), 8.0);
    std::vector<double> boundaries, others;
    for (std::size_t k = 0; k < s.geodesics.size(); ++k)
        (s.boundary[k] < 0 ? others : boundaries).push_back(std::log(s.geodesics[k].length));
    const int dimension = 6 * d.genus - 6 + 3 * d.boundaries;
    const auto size = static_cast<std::size_t>(std::min(12, 4 * (3 * d.genus - 3 + d.boundaries)));
    ASSERT_GE(others.size(), size);
    std::vector<double> expected = boundaries;
    expected.insert(expected.end(), others.begin(), others.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(d.fingerprint.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(d.fingerprint[k], expected[k], 1e-9);
    EXPECT_GE(static_cast<int>(d.fingerprint.size()), std::min(3, dimension));
}

TEST(ShapeDescriptor, FingerprintsAreLogarithmsOfBoundariesAndTheShortestOthers) {
    for (const char* name : {"eight", "pants", "punctured-torus", "genus-g-one-boundary"}) {
        SCOPED_TRACE(name);
        expect_fingerprint(generated(name, 500, 0.3));
    }
}

TEST(ShapeDescriptor, FingerprintsNameBoundariesOnce) {
    // Its boundary is shorter than some of the others.
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/handles_with_boundary/chipped-torus_g1b1.obj");
    expect_fingerprint(testing::load_component(path));
}

TEST(ShapeDescriptor, CoordinatesAreOneMoreThanTheDimension) {
    for (const auto& [name, count] : std::vector<std::pair<std::string, std::size_t>>{
             {"eight", 7}, {"pants", 3}, {"punctured-torus", 3}, {"genus-g-one-boundary", 10}}) {
        SCOPED_TRACE(name);
        const ShapeDescriptor d = described(generated(name, 500, 0.3));
        EXPECT_EQ(d.coordinates.size(), count) << d.message;
        EXPECT_EQ(d.names.size(), d.coordinates.size());
        for (const double x : d.coordinates) EXPECT_GT(x, 0.0);
    }
}

TEST(ShapeDescriptor, FlatOnesHaveTheirModulus) {
    const double tau = std::sqrt(2.5 * 2.5 - 1);
    const ShapeDescriptor torus = described(generated("torus", 4000));
    ASSERT_EQ(torus.coordinates.size(), 2U);
    EXPECT_NEAR(torus.coordinates[0], 0.0, 1e-9);
    EXPECT_NEAR(torus.coordinates[1], tau, 0.01);
    EXPECT_EQ(torus.names, (std::vector<std::string>{"modulus_re", "modulus_im"}));
    EXPECT_EQ(torus.fingerprint, torus.coordinates);
    EXPECT_EQ(torus.lengths.front(), 1.0);
    // modulus height / (2 pi) at every resolution
    const ShapeDescriptor annulus = described(generated("annulus", 300));
    ASSERT_EQ(annulus.coordinates.size(), 1U);
    EXPECT_NEAR(annulus.coordinates[0], 1 / (2 * std::numbers::pi), 1e-9);
    EXPECT_NEAR(annulus.fingerprint.at(0), std::log(annulus.coordinates[0]), 1e-12);
    EXPECT_EQ(annulus.lengths, (std::vector<double>{1, 2, 3, 4}));
}

TEST(ShapeDescriptor, SpheresAndDisksHaveOneToo) {
    for (const char* name : {"ellipsoid", "disk"}) {
        const ShapeDescriptor d = described(generated(name, 800));
        EXPECT_TRUE(d.lengths.empty());
        EXPECT_FALSE(d.fingerprint.empty());
        EXPECT_EQ(d.fingerprint, d.coordinates);
        EXPECT_EQ(d.names.size(), d.coordinates.size());
    }
}

TEST(ShapeDescriptor, GeometryAloneDecides) {
    for (const char* name : {"eight", "pants", "punctured-torus", "torus", "annulus"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = generated(name, 500, 0.3);
        testing::Random random(11);
        SurfaceMesh other =
            testing::relabelled(mesh, random.permutation(mesh.connectivity.vertex_count), random);
        for (Point& p : other.points) p = {-77 * p[1], 77 * p[0], 77 * p[2] + 5};  // a similarity
        other = make_surface_mesh(std::move(other.points), triangles_of(other.connectivity));
        const ShapeDescriptor a = described(mesh), b = described(other);
        testing::expect_same_lengths(a.lengths, b.lengths, 1e-8);
        testing::expect_same_lengths(a.fingerprint, b.fingerprint, 1e-8);
        EXPECT_EQ(a.names, b.names);
        if (a.marking_gap > 0.01) {
            testing::expect_same_lengths(a.coordinates, b.coordinates, 1e-7);
        }
    }
}

TEST(ShapeDescriptor, CountsAndBudgetsAreHonest) {
    const SurfaceMesh mesh = generated("eight", 500, 0.3);
    ShapeOptions options;
    options.coordinates = false;
    options.count = 5;
    const ShapeDescriptor d = describe_shape(mesh, options);
    EXPECT_GE(d.lengths.size(), 5U);
    EXPECT_TRUE(d.coordinates.empty());
    const std::vector<double> all = testing::lengths_up_to(mesh, d.complete_up_to * (1 + 1e-9));
    testing::expect_same_lengths(d.lengths, all, 1e-9);
    options.count = 0;
    options.max_length = 8.0;
    options.budget = 2000;
    const ShapeDescriptor poor = describe_shape(mesh, options);
    EXPECT_LT(poor.complete_up_to, 8.0);
    EXPECT_EQ(poor.status, Status::max_iterations) << "too few for the fingerprint";
    EXPECT_NE(poor.message.find("budget"), std::string::npos);
    for (const double l : poor.lengths) EXPECT_LE(l, poor.complete_up_to);
}

TEST(ShapeDescriptor, AFailedFlowIsAStatus) {
    for (const char* name : {"eight", "torus", "annulus", "pants"}) {
        ShapeOptions options;
        options.flow.max_iterations = 1;
        options.flow.tolerance = 1e-13;
        const ShapeDescriptor d = describe_shape(generated(name, 500, 0.3), options);
        EXPECT_NE(d.status, Status::converged) << name;
        EXPECT_FALSE(d.message.empty()) << name;
        EXPECT_TRUE(d.lengths.empty());
        EXPECT_TRUE(d.fingerprint.empty());
    }
}

}  // namespace
}  // namespace ricci
