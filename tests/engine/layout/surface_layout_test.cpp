// Layouts of fundamental domains, tessellations, spheres and disks.
#include "engine/layout/surface_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "engine/layout/extended.h"
#include "tests/engine/layout/structure_samples.h"

namespace ricci {
namespace {

using namespace ricci::testing;
using std::numbers::pi;

/// The isometry from one layout's frame of a piece to the other's.
Isometry<double> between(const SurfaceLayout& from, const SurfaceLayout& to, Index piece) {
    return compose(-1, to.frame[at(piece)], inverse(from.frame[at(piece)]));
}

/// Thesis, section 8.4, Table 10: layouts from different seed faces differ by one Moebius transformation, and
/// different edges of a side give the same deck transformation. There to 1e-6, here to 1e-9.
void expect_table_10(const SurfaceMesh& mesh) {
    StructureOptions options;
    options.goal = 1e-14;
    const SurfaceStructure s = structure_of(mesh, options);
    const Index faces = mesh.connectivity.face_count();
    std::vector<SurfaceLayout> layouts;
    for (const Index seed : {Index{0}, faces / 3, 2 * faces / 3}) {
        LayoutOptions seeded;
        seeded.seed_face = seed;
        seeded.goal = 1e-14;
        layouts.push_back(make_surface_layout(-1, *s.refinement, mesh.connectivity, *s.basis, s.cut, seeded));
        EXPECT_EQ(s.refinement->input_face[at(layouts.back().root_piece)], seed);
    }
    for (std::size_t k = 1; k < layouts.size(); ++k) {
        const Isometry<double> motion = between(layouts[0], layouts[k], 0);
        double worst = 0;
        for (std::size_t v = 0; v < layouts[0].position.size(); ++v)
            worst = std::max(worst, hyperbolic_distance(apply(-1, motion, layouts[0].position[v]),
                                                        layouts[k].position[v]));
        EXPECT_LE(worst, 1e-9);
    }
    // Deck transformations by hand, from three edges of every side.
    const SurfaceLayout& layout = layouts[0];
    const FinalMetric<double> metric = make_final_metric(-1, *s.refinement);
    const CommonRefinement& r = *s.refinement;
    std::size_t compared = 0;
    for (const SidePairing& pairing : layout.pairings) {
        EXPECT_LE(pairing.spread, 1e-9);
        const std::vector<Index>& chain = s.cut.sides[at(pairing.side)].halfedges;
        for (const std::size_t which : {std::size_t{0}, chain.size() / 2, chain.size() - 1}) {
            const auto corner = std::find(r.input_halfedge.begin(), r.input_halfedge.end(), chain[which]);
            const auto c = static_cast<Index>(corner - r.input_halfedge.begin());
            const Index t = r.twin[at(c)], g = r.final_halfedge[at(c)];
            Isometry<double> there = layout.frame[at(r.piece[at(c)])];
            if (g >= 0) there = compose(-1, there, metric.crossing(r.final_triangulation.connectivity, g));
            const Isometry<double> deck = compose(-1, there, inverse(layout.frame[at(r.piece[at(t)])]));
            // As Table 10 has it: the angle and the centre z0 of e^(i theta) (z - z0) / (1 - conj(z0) z).
            const auto parameters = [](const Isometry<double>& x) {
                const std::complex<double> a(x.a.re, x.a.im), b(x.b.re, x.b.im), z0 = -b / a;
                return std::array<double, 3>{std::arg(a * a), z0.real(), z0.imag()};
            };
            const auto p = parameters(deck), q = parameters(pairing.element);
            EXPECT_NEAR(std::remainder(p[0] - q[0], 2 * pi), 0.0, 1e-9);
            EXPECT_NEAR(p[1], q[1], 1e-9);
            EXPECT_NEAR(p[2], q[2], 1e-9);
            ++compared;
        }
    }
    EXPECT_EQ(compared, 3 * layout.pairings.size());
    EXPECT_GE(layout.pairings.size(), 4U);
}

TEST(Table10, GeneratedEight) {
    expect_table_10(generated("eight", 4000));
}

TEST(Table10, SampleMesh) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight.off");
    expect_table_10(load_mesh(path).components.at(0));
}

TEST(SurfaceLayout, PartnersOfPairingsAreInverse) {
    const SurfaceMesh mesh = generated("genus-g", 2500, 0.3, 3);
    const SurfaceStructure s = structure_of(mesh);
    std::vector<const SidePairing*> of(s.cut.sides.size(), nullptr);
    for (const SidePairing& p : s.layout.pairings) of[at(p.side)] = &p;
    for (const SidePairing& p : s.layout.pairings) {
        const Index partner = s.cut.sides[at(p.side)].partner;
        ASSERT_GE(partner, 0);
        EXPECT_LT(distance_to_identity(compose(-1, p.element, of[at(partner)]->element)), 1e-7);
    }
}

TEST(SurfaceLayout, PolishingBringsVertexHolonomyDown) {
    const SurfaceMesh mesh = generated("eight", 1500);
    const SurfaceStructure s = structure_of(mesh);
    const Connectivity& c = s.refinement->final_triangulation.connectivity;
    const auto worst = [&](const auto& metric) {
        using Real = std::decay_t<decltype(metric.half_chord[0])>;
        Real largest(0);
        std::vector<std::uint8_t> seen(c.tail.size(), 0);
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            if (seen[at(h)]) continue;
            Isometry<Real> around;
            for (Index k = h; !seen[at(k)]; k = c.twin[at(prev_halfedge(k))]) {
                seen[at(k)] = 1;
                // The face across the halfedge before k: counterclockwise about the tail of k.
                const Index out = prev_halfedge(k), back = c.twin[at(out)];
                const Isometry<Real> move{{Real(0), metric.half_cosine[at(out)]},
                                          {Real(0), -metric.half_chord[at(out)]}};
                const auto frame = [&](Index g) {
                    return g % 3 == 0 ? Isometry<Real>{} : metric.turned[at(face_of(g))][at(g % 3 - 1)];
                };
                around =
                    compose(-1, around, compose(-1, compose(-1, frame(out), move), inverse(frame(back))));
            }
            const Real miss = distance_to_identity(around);
            if (miss > largest) largest = miss;
        }
        return static_cast<double>(largest);
    };
    // The flow stops at 1e-10; half angles halve that, valences add up rounding.
    EXPECT_LT(worst(make_final_metric(-1, *s.refinement)), 1e-9);
}

TEST(Tessellation, CopiesAreDistinctAndMeetTheDomain) {
    const SurfaceMesh mesh = generated("eight", 1500);
    const SurfaceStructure s = structure_of(mesh);
    const auto copies = tessellate(s.layout, 400, 20.0);
    ASSERT_EQ(copies.size(), 400U);
    EXPECT_LT(distance_to_identity(copies[0]), 1e-15);
    // No two alike: the surface's injectivity radius bounds distances of images from below.
    for (std::size_t i = 0; i < copies.size(); ++i)
        for (std::size_t j = i + 1; j < copies.size(); ++j) {
            const Isometry<double> difference = compose(-1, inverse(copies[i]), copies[j]);
            ASSERT_GT(std::hypot(difference.b.re, difference.b.im), 0.05) << i << " " << j;
        }
    // Breadth first: the neighbours across all sides come next.
    for (const SidePairing& p : s.layout.pairings)
        EXPECT_TRUE(std::any_of(copies.begin() + 1,
                                copies.begin() + 1 + static_cast<std::ptrdiff_t>(s.layout.pairings.size()),
                                [&](const Isometry<double>& g) {
                                    return distance_to_identity(compose(-1, inverse(g), p.element)) < 1e-6;
                                }));
}

TEST(Tessellation, CopiesOfATorusFillALattice) {
    const SurfaceMesh mesh = generated("torus", 1500);
    const SurfaceStructure s = structure_of(mesh);
    const auto copies = tessellate(s.layout, 200, 1e300);
    ASSERT_EQ(copies.size(), 200U);
    const auto shift = [&](const Isometry<double>& g) {
        const auto m = plane_matrix(g);
        return std::complex<double>(m[2], m[5]);
    };
    const auto a = shift(s.group.generators[0].element), b = shift(s.group.generators[1].element);
    // In the layout's coordinates, turned by the base frame.
    const std::complex<double> turn =
        std::pow(std::complex<double>(s.layout.base_frame.a.re, s.layout.base_frame.a.im), 2);
    for (const Isometry<double>& g : copies) {
        const std::complex<double> v = shift(g) / turn;
        const double determinant = (std::conj(a) * b).imag();
        const double x = (std::conj(v) * b).imag() / determinant, y = (std::conj(a) * v).imag() / determinant;
        EXPECT_NEAR(x, std::round(x), 1e-7);
        EXPECT_NEAR(y, std::round(y), 1e-7);
    }
}

TEST(Annulus, HeightOverCircumferenceIsTheModulus) {
    // A cylinder of circumference 2 pi: exact at every resolution.
    GenerateOptions options;
    options.faces = 1000;
    options.height = 1.7;
    const SurfaceMesh mesh = generate("annulus", options);
    const SurfaceStructure s = structure_of(mesh);
    const auto m = plane_matrix(s.group.letters.at(0));
    const double circumference = std::hypot(m[2], m[5]);
    // Area one.
    EXPECT_NEAR(1 / (circumference * circumference), 1.7 / (2 * pi), 1e-9);
}

double solid_angle(const std::array<double, 3>& a, const std::array<double, 3>& b,
                   const std::array<double, 3>& c) {
    const double triple = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                          a[2] * (b[0] * c[1] - b[1] * c[0]);
    const auto dot = [](const auto& x, const auto& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
    return 2 * std::atan2(triple, 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

double total_area(const SurfaceStructure& s) {
    const CommonRefinement& r = *s.refinement;
    double total = 0;
    for (Index p = 0; p < r.piece_count(); ++p) {
        const auto position = [&](Index c) { return s.layout.position[at(s.layout.corner_vertex[at(c)])]; };
        const Index a = r.first[at(p)];
        for (Index c = a + 1; c + 1 < r.first[at(p) + 1]; ++c)
            total += solid_angle(position(a), position(c), position(c + 1));
    }
    return total;
}

void expect_sphere(const SurfaceMesh& mesh) {
    const SurfaceStructure s = structure_of(mesh);
    EXPECT_EQ(s.kappa, 1);
    EXPECT_EQ(s.layout.flipped, 0);
    EXPECT_NEAR(total_area(s), 4 * pi, 1e-9);
    for (const auto& p : s.layout.position) EXPECT_NEAR(p[0] * p[0] + p[1] * p[1] + p[2] * p[2], 1.0, 1e-11);
}

TEST(Sphere, GeneratedSurfacesCoverItOnce) {
    for (const char* name : {"sphere", "ellipsoid"}) expect_sphere(generated(name, 1500));
}

TEST(Sphere, SampleMeshesCoverItOnce) {
    for (const char* name :
         {"spot.obj", "bunny.obj", "armadillo.obj", "maxplanck.nf25k.off", "fandisk.obj"}) {
        SCOPED_TRACE(name);
        const std::string path = data_file(std::string("meshes/closed_g0/") + name);
        if (path.empty()) GTEST_SKIP() << name << " not found";
        expect_sphere(load_mesh(path).components.at(0));
    }
}

/// sin of the conformal latitude of an ellipsoid of revolution with semi-axes 1, 1, c at the point of height
/// z.
double conformal_latitude_sine(double z, double c) {
    // Geodetic latitude: tan phi = tan(reduced) / c with sin(reduced) = z / c.
    const double reduced = std::asin(std::clamp(z / c, -1.0, 1.0));
    const double phi = std::atan2(std::sin(reduced), c * std::cos(reduced));
    const double square = 1 - c * c, s = std::sin(phi);
    // Isometric latitude: atanh(sin phi) - e atanh(e sin phi), e^2 = 1 - c^2; for e^2 < 0 e = i f: + f atan(f
    // sin phi).
    const double e = std::sqrt(std::abs(square));
    const double correction = square > 0 ? -e * std::atanh(e * s) : e * std::atan(e * s);
    if (std::abs(s) > 1 - 1e-15) return s;
    return std::tanh(std::atanh(s) + correction);
}

/// Largest difference between the map and the closed form: latitudes about the axis that the map itself has.
double ellipsoid_error(double c, Index faces) {
    GenerateOptions options;
    options.faces = faces;
    options.semi_axes = {1.0, 1.0, c};
    const SurfaceMesh mesh = generate("ellipsoid", options);
    const SurfaceStructure s = structure_of(mesh);
    std::vector<std::array<double, 3>> image(mesh.points.size());
    for (std::size_t k = 0; k < s.layout.position.size(); ++k)
        if (at(s.layout.refinement_vertex[k]) < image.size())
            image[at(s.layout.refinement_vertex[k])] = s.layout.position[k];
    // The rotation is free: the axis is the direction along which images go with the closed form's height.
    std::array<double, 3> axis{};
    for (std::size_t v = 0; v < image.size(); ++v)
        for (std::size_t k = 0; k < 3; ++k)
            axis[k] += image[v][k] * conformal_latitude_sine(mesh.points[v][2], c);
    const double norm = std::hypot(axis[0], axis[1], axis[2]);
    double worst = 0;
    for (std::size_t v = 0; v < image.size(); ++v) {
        const double height = (image[v][0] * axis[0] + image[v][1] * axis[1] + image[v][2] * axis[2]) / norm;
        worst = std::max(worst, std::abs(height - conformal_latitude_sine(mesh.points[v][2], c)));
    }
    return worst;
}

TEST(Sphere, EllipsoidsOfRevolutionConvergeToTheirClosedForm) {
    for (const double c : {0.6, 1.6}) {
        const double coarse = ellipsoid_error(c, 1280), fine = ellipsoid_error(c, 5120),
                     finer = ellipsoid_error(c, 20480);
        EXPECT_LT(finer, 2e-3);
        // Second order: a factor of four for half the edges; the centre of mass of the vertices wavers a
        // little.
        EXPECT_GT(coarse / fine, 3.0) << c;
        EXPECT_GT(fine / finer, 3.0) << c;
    }
}

TEST(Disk, BoundaryIsTheUnitCircle) {
    for (const SurfaceMesh& mesh : {wavy_square(14, 0.2), generated("disk", 1200)}) {
        const SurfaceStructure s = structure_of(mesh);
        EXPECT_EQ(s.layout.flipped, 0);
        EXPECT_NEAR(total_area(s), 2 * pi, 1e-9);
        const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity);
        for (std::size_t k = 0; k < s.layout.position.size(); ++k) {
            const Index v = s.layout.refinement_vertex[k];
            const auto z = conformal_point(1, s.layout.position[k]);
            if (v < s.refinement->input_vertices && boundary[at(v)]) {
                EXPECT_NEAR(std::hypot(z[0], z[1]), 1.0, 1e-10);
            } else {
                EXPECT_LT(std::hypot(z[0], z[1]), 1 + 1e-10);
            }
        }
    }
}

TEST(Models, AgreeOnEveryPoint) {
    const SurfaceMesh mesh = generated("eight", 1000);
    const SurfaceStructure s = structure_of(mesh);
    for (const auto& p : s.layout.position) {
        const auto z = conformal_point(-1, p), k = projective_point(p), w = half_plane_point(p);
        const double square = z[0] * z[0] + z[1] * z[1];
        EXPECT_NEAR(k[0], 2 * z[0] / (1 + square), 1e-12);
        EXPECT_NEAR(k[1], 2 * z[1] / (1 + square), 1e-12);
        const std::complex<double> i(0, 1), zz(z[0], z[1]), ww = i * (1.0 + zz) / (1.0 - zz);
        EXPECT_NEAR(std::abs(ww - std::complex<double>(w[0], w[1])), 0.0, 1e-9 * std::abs(ww));
    }
}

}  // namespace
}  // namespace ricci
