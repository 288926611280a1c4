// Deformation paths: markings that are carried along, tori that are followed, failures.
#include "engine/shape_space/shape_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/shape_space/drawn_geodesic.h"
#include "engine/shape_space/flat_distance.h"
#include "engine/shape_space/length_spectrum.h"
#include "engine/surfaces/generate.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::torus_grid;

SurfaceMesh sample(const std::string& name, Index faces) {
    GenerateOptions options;
    options.faces = faces;
    return generate(name, options);
}

/// The same triangles, every point moved.
SurfaceMesh moved(const SurfaceMesh& mesh, const std::function<Point(const Point&)>& move) {
    std::vector<Point> points;
    for (const Point& p : mesh.points) points.push_back(move(p));
    return make_surface_mesh(std::move(points), triangles_of(mesh.connectivity));
}

/// Swells the part with x > 0 and shrinks the other for t > 0, the reverse for t < 0; a shear in y keeps
/// shapes without further symmetry. The rings of "eight" lie along x.
SurfaceMesh swollen(const SurfaceMesh& eight, double t) {
    return moved(eight, [t](const Point& p) -> Point {
        const double s = 1.0 + t * std::tanh(p[0]);
        return {p[0], s * p[1] + 0.05 * p[2], s * p[2] * (1.0 + 0.1 * p[1])};
    });
}

std::vector<PathFrame> follow(const std::vector<SurfaceMesh>& meshes) {
    ShapePath path{ShapeOptions{}};
    std::vector<PathFrame> frames;
    frames.reserve(meshes.size());
    for (const SurfaceMesh& mesh : meshes) frames.push_back(path.add(mesh));
    return frames;
}

double distance(const std::vector<double>& x, const std::vector<double>& y) {
    double sum = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += (x[k] - y[k]) * (x[k] - y[k]);
    return std::sqrt(sum);
}

double value(const PathFrame& frame, const std::string& name) {
    const auto it = std::find(frame.names.begin(), frame.names.end(), name);
    return it == frame.names.end() ? NAN
                                   : frame.coordinates[static_cast<std::size_t>(it - frame.names.begin())];
}

std::vector<PathFrame> follow_swelling(const SurfaceMesh& eight, int steps) {
    std::vector<SurfaceMesh> meshes;
    for (int k = 0; k <= steps; ++k) meshes.push_back(swollen(eight, -0.15 + 0.3 * k / steps));
    return follow(meshes);
}

double largest_step(const std::vector<PathFrame>& frames) {
    double largest = 0.0;
    for (const PathFrame& f : frames) largest = std::max(largest, f.step);
    return largest;
}

TEST(ShapePath, CoordinatesPassTheTieOfTwoHandlesWithoutAJump) {
    const SurfaceMesh eight = sample("eight", 1200);
    const std::vector<PathFrame> coarse = follow_swelling(eight, 6), fine = follow_swelling(eight, 12);
    for (const std::vector<PathFrame>* frames : {&coarse, &fine})
        for (std::size_t k = 0; k < frames->size(); ++k) {
            const PathFrame& f = (*frames)[k];
            ASSERT_EQ(f.status, Status::converged) << f.message;
            EXPECT_EQ(f.marking, k == 0 ? MarkingSource::own : MarkingSource::carried);
            EXPECT_LT(f.marking_spread, 1e-8);
            EXPECT_GT(f.marking_spread, 0.0) << "rounding";
            EXPECT_EQ(f.coordinates.size(), 7U);
        }
    // Half the step, half the jump; and the same curve.
    EXPECT_NEAR(largest_step(fine) / largest_step(coarse), 0.5, 0.06);
    for (std::size_t k = 0; k < coarse.size(); ++k)
        EXPECT_LT(distance(coarse[k].coordinates, fine[2 * k].coordinates), 1e-9);
    // The rule alone jumps: handle 1 is always the one with the shorter curve.
    EXPECT_LT(value(coarse.front(), "a1"), value(coarse.front(), "a2"));
    EXPECT_GT(value(coarse.back(), "a1"), value(coarse.back(), "a2"));
    EXPECT_LT(coarse[3].marking_gap, 1e-3) << "a near-tie in the middle";
    EXPECT_GT(coarse.front().marking_gap, 1e-3);
}

TEST(ShapePath, TheEndIsTheDirectComputationUpToTheMarking) {
    const SurfaceMesh eight = sample("eight", 1200);
    const std::vector<PathFrame> frames = follow_swelling(eight, 4);
    ShapePath direct{ShapeOptions{}};
    const SurfaceMesh last_mesh = swollen(eight, 0.15);
    const PathFrame own = direct.add(last_mesh), &last = frames.back();
    ASSERT_EQ(own.marking, MarkingSource::own);
    // The handles have changed places.
    EXPECT_NEAR(value(last, "a1"), value(own, "a2"), 1e-9);
    EXPECT_NEAR(value(last, "a2"), value(own, "a1"), 1e-9);
    EXPECT_EQ(last.fingerprint, own.fingerprint);
    // Every carried coordinate is the length of a closed geodesic.
    const FlowResult flow = solve_sharply(last_mesh, {});
    SpectrumOptions options;
    options.max_length = 1e-6 + *std::max_element(last.coordinates.begin(), last.coordinates.end());
    ASSERT_LT(options.max_length, 11.0);
    const LengthSpectrum spectrum = length_spectrum(coarse_surface_of(last_mesh, flow, true), options);
    ASSERT_GE(spectrum.complete_up_to, options.max_length);
    for (const double length : last.coordinates) {
        double nearest = INFINITY;
        for (const SpectrumLength& l : spectrum.lengths)
            nearest = std::min(nearest, std::abs(l.length - length));
        EXPECT_LT(nearest, 1e-9) << length;
    }
}

/// Twisted and stretched, as the teapots of the thesis's Figure 35 are.
std::vector<SurfaceMesh> twisted_tori(const SurfaceMesh& holed_torus, int steps) {
    std::vector<SurfaceMesh> meshes;
    for (int k = 0; k <= steps; ++k)
        meshes.push_back(moved(holed_torus, [t = static_cast<double>(k) / steps](const Point& p) -> Point {
            const double angle = 0.5 * t * p[0];
            return {(1.0 + 0.4 * t) * p[0], std::cos(angle) * p[1] - std::sin(angle) * p[2],
                    std::sin(angle) * p[1] + std::cos(angle) * p[2]};
        }));
    return meshes;
}

TEST(ShapePath, ADeformedOneHoledTorusKeepsItsTraceIdentity) {
    const std::vector<PathFrame> frames = follow(twisted_tori(sample("punctured-torus", 800), 5));
    for (const PathFrame& f : frames) {
        ASSERT_EQ(f.status, Status::converged) << f.message;
        ASSERT_EQ(f.names, (std::vector<std::string>{"a1", "b1", "a1b1"}));
        // tr [a,b] = x^2 + y^2 + z^2 - x y z - 2 for the traces x, y, z of a, b, ab; the boundary, -2
        // cosh(c/2), comes from another solve.
        const double x = 2 * std::cosh(f.coordinates[0] / 2), y = 2 * std::cosh(f.coordinates[1] / 2),
                     z = 2 * std::cosh(f.coordinates[2] / 2);
        const double boundary = 2 * std::acosh((x * y * z + 2 - x * x - y * y - z * z) / 2);
        EXPECT_NEAR(boundary, std::exp(f.fingerprint[0]), 1e-8);
    }
    EXPECT_GT(frames.back().length, 0.1);
}

TEST(ShapePath, TheReversedSequenceIsTheReversedCurve) {
    std::vector<SurfaceMesh> meshes = twisted_tori(sample("punctured-torus", 800), 4);
    const std::vector<PathFrame> there = follow(meshes);
    std::reverse(meshes.begin(), meshes.end());
    const std::vector<PathFrame> back = follow(meshes);
    for (std::size_t k = 0; k < there.size(); ++k)
        EXPECT_LT(distance(there[k].coordinates, back[there.size() - 1 - k].coordinates), 1e-9) << k;
    for (std::size_t k = 1; k < there.size(); ++k) {
        EXPECT_NEAR(there[k].step, back[there.size() - k].step, 1e-9);
        EXPECT_NEAR(there[k].free_step, back[there.size() - k].free_step, 1e-9);
        EXPECT_NEAR(there[k].step, distance(there[k].coordinates, there[k - 1].coordinates), 1e-12);
        EXPECT_NEAR(there[k].length, there[k - 1].length + there[k].step, 1e-12);
        EXPECT_GT(there[k].step, 0.0);
    }
    EXPECT_NEAR(there.back().length, back.back().length, 1e-9);
}

/// A flat torus of modulus tau as a grid of n x m parallelograms, by edge lengths alone.
SurfaceMesh flat_torus(std::complex<double> tau, Index n, Index m) {
    SurfaceMesh mesh;
    mesh.connectivity =
        make_surface_mesh(testing::bumpy_torus(n, m, 0.0).points, torus_grid(n, m)).connectivity;
    const Connectivity& c = mesh.connectivity;
    const auto step = [](Index from, Index to, Index size) {
        const Index d = (to - from + size) % size;
        return static_cast<double>(d > 1 ? d - size : d) / static_cast<double>(size);
    };
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index v = c.tail[at(h)], w = c.head(h);
        mesh.edge_length.push_back(std::abs(step(v / m, w / m, n) + tau * step(v % m, w % m, m)));
    }
    for (Index v = 0; v < n * m; ++v) mesh.input_vertex.push_back(v);
    return mesh;
}

TEST(ShapePath, ATorusCrossesTheFundamentalDomainWithoutAJump) {
    // Through Re = 1/2, then down through |tau| = 1.
    std::vector<std::complex<double>> moduli;
    for (int k = 0; k <= 10; ++k) moduli.emplace_back(0.05 + 0.14 * k, 1.3);
    for (int k = 1; k <= 8; ++k) moduli.emplace_back(1.45 - 0.02 * k, 1.3 - 0.1 * k);
    for (const bool same : {true, false}) {
        std::vector<SurfaceMesh> meshes;
        for (std::size_t k = 0; k < moduli.size(); ++k)
            meshes.push_back(flat_torus(moduli[k], same ? 6 : 5 + static_cast<Index>(k), same ? 5 : 7));
        const std::vector<PathFrame> frames = follow(meshes);
        double total = 0.0;
        bool left = false;
        for (std::size_t k = 0; k < frames.size(); ++k) {
            const PathFrame& f = frames[k];
            ASSERT_EQ(f.status, Status::converged) << f.message;
            EXPECT_EQ(f.marking, same && k > 0 ? MarkingSource::carried : MarkingSource::own);
            EXPECT_NEAR(f.coordinates[0], moduli[k].real(), 1e-9) << k;
            EXPECT_NEAR(f.coordinates[1], moduli[k].imag(), 1e-9) << k;
            left = left || distance(f.coordinates, f.fingerprint) > 0.5;
            if (k == 0) continue;
            const double half = 0.5 * std::acosh(1 + std::norm(moduli[k] - moduli[k - 1]) /
                                                         (2 * moduli[k].imag() * moduli[k - 1].imag()));
            EXPECT_NEAR(f.step, half, 1e-9);
            EXPECT_NEAR(f.free_step, torus_distance(moduli[k], moduli[k - 1]), 1e-9);
            total += half;
        }
        EXPECT_TRUE(left) << "the path leaves the fundamental domain";
        EXPECT_NEAR(frames.back().length, total, 1e-8);
    }
}

TEST(ShapePath, AnnuliSpheresAndOtherTrianglesTakeTheirOwn) {
    ShapePath annuli{ShapeOptions{}};
    GenerateOptions options;
    options.faces = 300;
    PathFrame last;
    for (const double height : {1.0, 1.5, 2.5}) {
        options.height = height;
        last = annuli.add(generate("annulus", options));
        ASSERT_EQ(last.status, Status::converged);
        EXPECT_EQ(last.marking, MarkingSource::none);
    }
    EXPECT_NEAR(last.length, 0.5 * std::log(2.5), 1e-8);

    ShapePath spheres{ShapeOptions{}};
    const SurfaceMesh sphere = sample("sphere", 320);
    spheres.add(sphere);
    const PathFrame egg = spheres.add(moved(sphere, [](const Point& p) -> Point {
        return {1.4 * p[0], p[1], p[2] * (1 + 0.2 * p[0])};
    }));
    ASSERT_EQ(egg.status, Status::converged);
    EXPECT_GT(egg.step, 0.01);

    ShapePath eights{ShapeOptions{}};
    const SurfaceMesh few = sample("eight", 700), many = sample("eight", 1300);
    const PathFrame first = eights.add(swollen(few, 0.1)), second = eights.add(swollen(many, 0.1)),
                    third = eights.add(swollen(many, 0.12));
    EXPECT_EQ(first.marking, MarkingSource::own);
    EXPECT_EQ(second.marking, MarkingSource::own);
    EXPECT_EQ(third.marking, MarkingSource::carried);
    EXPECT_EQ(first.marking_number, 0);
    EXPECT_EQ(second.marking_number, 1);
    EXPECT_EQ(third.marking_number, 1);
    eights.begin_sequence();
    const PathFrame shared = eights.add(swollen(few, 0.11));
    EXPECT_EQ(shared.marking, MarkingSource::carried)
        << "sequences with the same triangles share their marking";
    EXPECT_EQ(shared.marking_number, 0);
    EXPECT_EQ(shared.length, 0.0);
}

TEST(ShapePath, AMarkingThatCostsTooMuchIsAStatus) {
    // A budget that does for the spectrum of this surface, but not for its marking.
    const SurfaceMesh mesh = swollen(sample("eight", 800), 0.1);
    ShapeOptions options;
    options.budget = 1500;
    options.max_length = 0.5;
    options.fingerprint = 1;
    const ShapeDescriptor d = describe_shape(mesh, options);
    if (d.status != Status::converged || !d.coordinates.empty())
        GTEST_SKIP() << "budgets are spent otherwise by now";
    ShapePath path(options);
    const PathFrame frame = path.add(mesh);
    EXPECT_EQ(frame.status, Status::max_iterations);
    EXPECT_NE(frame.message.find("no coordinates"), std::string::npos);
}

TEST(ShapePath, AFailureIsPassedOver) {
    const std::vector<SurfaceMesh> meshes = twisted_tori(sample("punctured-torus", 800), 2);
    ShapePath path{ShapeOptions{}};
    path.add(meshes[0]);
    const PathFrame other = path.add(sample("torus", 200));
    EXPECT_EQ(other.status, Status::invalid_input);
    EXPECT_NE(other.message.find("unlike the frames before"), std::string::npos);
    EXPECT_TRUE(std::isnan(other.step));
    EXPECT_TRUE(other.coordinates.empty());
    path.set_interruption([]() -> std::optional<Status> { return Status::timeout; });
    EXPECT_EQ(path.add(meshes[1]).status, Status::timeout);
    path.set_interruption({});
    const PathFrame after = path.add(meshes[2]);
    ASSERT_EQ(after.status, Status::converged);
    EXPECT_EQ(after.marking, MarkingSource::carried);
    const std::vector<PathFrame> direct = follow({meshes[0], meshes[2]});
    EXPECT_EQ(after.coordinates, direct[1].coordinates);
    EXPECT_EQ(after.step, direct[1].step);
    EXPECT_EQ(after.length, direct[1].length);
}

}  // namespace
}  // namespace ricci
