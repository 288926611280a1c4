// Surfaces with geodesic boundary: the boundary's deck transformation is as long as the boundary.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::position_of;
using testing::structure_of;

/// Length of every boundary component in the layout, in the order of the basis.
std::vector<double> boundary_lengths(const SurfaceMesh& mesh, const SurfaceStructure& s) {
    const CommonRefinement& r = *s.refinement;
    std::vector<Index> component(mesh.connectivity.tail.size(), -1);
    for (Index j = 0; j < s.basis->boundaries(); ++j)
        for (const Index h : s.basis->boundary_walk(j)) component[at(h)] = j;
    std::vector<double> length(at(s.basis->boundaries()), 0.0);
    for (Index c = 0; c < r.corner_count(); ++c) {
        if (r.twin[at(c)] >= 0) continue;
        length[at(component[at(r.input_halfedge[at(c)])])] +=
            testing::distance(s.kappa, position_of(s.layout, c), position_of(s.layout, r.next(c)));
    }
    return length;
}

void expect_geodesic_boundary(const SurfaceMesh& mesh) {
    StructureOptions options;
    options.flow.tolerance = 1e-12;
    const SurfaceStructure s = structure_of(mesh, options);
    ASSERT_EQ(s.kappa, -1);
    const std::vector<double> length = boundary_lengths(mesh, s);
    ASSERT_FALSE(length.empty());
    for (std::size_t j = 0; j < length.size(); ++j) {
        const Isometry<double>& letter = s.group.letters[at(s.basis->loops()) + j];
        const double trace = testing::trace_size(letter);
        EXPECT_GT(trace, 2.0);
        // The trace is the half product of exponentials; the letter is carried from the base and back, which
        // costs e^(2 d) roundings, d about 3.
        EXPECT_NEAR(trace, 2 * std::cosh(length[j] / 2), 1e-9 * trace);
    }
    // A punctured relator, closed.
    EXPECT_LE(s.group.relator_error, 1e-9);
    EXPECT_EQ(s.layout.flipped, 0);
}

TEST(BoundaryLayout, TheBoundaryIsAsLongAsItsTransformation) {
    expect_geodesic_boundary(testing::generated("pants", 1000));
    expect_geodesic_boundary(testing::generated("pants", 1000, 0.4));
    expect_geodesic_boundary(testing::generated("punctured-torus", 1000, 0.4));
    expect_geodesic_boundary(testing::generated("genus-g-one-boundary", 1500, 0.3, 2));
}

TEST(BoundaryLayout, SoAreThoseOfScans) {
    RICCI_DATA_FILE_OR_SKIP(pants, "meshes/pants/TwoHoleExample.off");
    RICCI_DATA_FILE_OR_SKIP(handles, "meshes/handles_with_boundary/eight.hole_g2b1.off");
    expect_geodesic_boundary(testing::load_component(pants));
    expect_geodesic_boundary(testing::load_component(handles));
}

TEST(BoundaryLayout, AnglesAtTheBoundaryAddUpToHalfATurn) {
    for (const char* name : {"pants", "punctured-torus", "annulus"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = testing::generated(name, 600, 0.4);
        StructureOptions options;
        options.flow.tolerance = 1e-12;
        const SurfaceStructure s = structure_of(mesh, options);
        const CommonRefinement& r = *s.refinement;
        std::vector<double> sum(at(r.input_vertices), 0.0);
        for (Index c = 0; c < r.corner_count(); ++c)
            if (r.vertex[at(c)] < r.input_vertices)
                sum[at(r.vertex[at(c)])] += testing::image_angle(r, s.layout, c);
        const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity);
        // The double is symmetric only in so far as its flips are; angles only see rounding of sides of 1e-4.
        for (std::size_t v = 0; v < sum.size(); ++v)
            EXPECT_NEAR(sum[v], (boundary[v] ? 1 : 2) * std::numbers::pi, 1e-10);
    }
}

TEST(BoundaryLayout, TheDoubleOfAHalfIsTheWhole) {
    // pants and punctured-torus are halves of the eight, whose mirrors are geodesics: boundary lengths are
    // those of closed loops there. A mirror image has the same length, so traces of the same loop agree.
    const SurfaceMesh whole = testing::generated("eight", 1500),
                      half = testing::generated("punctured-torus", 750);
    ASSERT_EQ(whole.connectivity.face_count(), 2 * half.connectivity.face_count());
    const SurfaceStructure a = structure_of(whole), b = structure_of(half);
    const double trace = testing::trace_size(b.group.letters.back());
    // The waist as a closed path of the whole: vertices by position.
    EdgePath waist;
    for (const Index h : b.basis->boundary_walk(0))
        for (Index g = 0; g < whole.connectivity.halfedge_count(); ++g)
            if (whole.points[at(whole.connectivity.tail[at(g)])] ==
                    half.points[at(half.connectivity.tail[at(h)])] &&
                whole.points[at(whole.connectivity.head(g))] == half.points[at(half.connectivity.head(h))])
                waist.push_back(g);
    ASSERT_EQ(waist.size(), b.basis->boundary_walk(0).size());
    const auto there = testing::element_of(a.group, a.basis->word_of_path(waist));
    EXPECT_NEAR(testing::trace_size(there), trace, 1e-9 * trace);
}

}  // namespace
}  // namespace ricci
