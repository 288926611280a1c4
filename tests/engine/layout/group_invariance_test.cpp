// What a group must not depend on: how the surface lies in space up to Moebius maps, how it is numbered, from
// where it is looked at, how its flat faces are cut.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>

#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::element_of;
using testing::Random;
using testing::structure_of;
using testing::trace_size;

/// Loops of the first structure's letters as closed paths of the second surface.
using PathMap = std::function<EdgePath(const EdgePath&)>;

/// tr(a), tr(b), tr(ab) of all pairs of letters determine a group up to one conjugation (Fricke). The loops
/// of the letters all start at the base of `first`; in the other basis each is joined to its base by the same
/// tree path.
void expect_same_group(const SurfaceStructure& first, const SurfaceStructure& second, const PathMap& moved,
                       double tolerance) {
    std::vector<Isometry<double>> there;
    const Index letters = first.basis->loops() + first.basis->boundaries();
    for (Index k = 0; k < letters; ++k) {
        const EdgePath path = moved(first.basis->loop_path(k));
        there.push_back(element_of(second.group, second.basis->word_of_path(path)));
    }
    const std::vector<Isometry<double>>& here = first.group.letters;
    double worst = 0;
    const auto compare = [&](const Isometry<double>& x, const Isometry<double>& y) {
        const double error = std::abs(trace_size(x) - trace_size(y)) / trace_size(x);
        worst = error > worst || std::isnan(error) ? error : worst;
    };
    for (std::size_t a = 0; a < here.size(); ++a) {
        compare(here[a], there[a]);
        for (std::size_t b = 0; b < here.size(); ++b) {
            if (a == b) continue;
            compare(compose(-1, here[a], here[b]), compose(-1, there[a], there[b]));
            compare(compose(-1, here[a], inverse(here[b])), compose(-1, there[a], inverse(there[b])));
        }
    }
    EXPECT_LE(worst, tolerance);
    EXPECT_GT(letters, 0);
}

EdgePath unmoved(const EdgePath& path) {
    return path;
}

/// A point outside the surface, `out` times its width away.
Point outside(const SurfaceMesh& mesh, double out) {
    Point low = mesh.points.front(), high = low;
    for (const Point& p : mesh.points)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    const double width = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    return {high[0] + 0.6 * out * width, high[1] + 0.3 * out * width, high[2] + 0.7 * out * width};
}

void expect_moebius_invariance(const SurfaceMesh& mesh, double out, bool delaunay) {
    StructureOptions options;
    options.base = 0;
    options.flow.delaunay = delaunay;
    options.flow.tolerance = 1e-12;
    const SurfaceMesh other = testing::inverted(mesh, outside(mesh, out));
    // Two residuals of 1e-12, and u that is rounded at e^-24 (the inversion shrinks by up to 1e4): the error
    // of a trace is that of the metric times the length of the loop.
    expect_same_group(structure_of(mesh, options), structure_of(other, options), unmoved, 1e-9);
}

TEST(GroupInvariance, AMoebiusInversionChangesNothingWithoutDelaunayFlips) {
    expect_moebius_invariance(testing::generated("eight", 1500, 0.3), 0.1, false);
    expect_moebius_invariance(testing::generated("genus-g", 1500, 0.2, 3), 0.5, false);
}

TEST(GroupInvariance, AMoebiusInversionOfTheEightChangesNothing) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight.off");
    expect_moebius_invariance(testing::load_component(path), 0.1, false);
}

void expect_delaunay_invariance(const SurfaceMesh& mesh, double out) {
    ASSERT_EQ(count_non_delaunay(intrinsic_triangulation<double>(mesh), {}), 0);
    const SurfaceMesh other = testing::inverted(mesh, outside(mesh, out));
    ASSERT_EQ(count_non_delaunay(intrinsic_triangulation<double>(other), {}), 0);
    expect_moebius_invariance(mesh, out, true);
}

TEST(GroupInvariance, NorWithThemWhereBothMeshesAreDelaunay) {
    // From far away an inversion is nearly a similarity.
    expect_delaunay_invariance(testing::generated("eight", 400), 3);
    expect_delaunay_invariance(testing::generated("genus-g", 400, 0.0, 3), 3);
}

TEST(GroupInvariance, NorWithThemOnTheEight) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight.off");
    expect_delaunay_invariance(testing::load_component(path), 3);
}

TEST(GroupInvariance, DelaunayFlipsDoChangeTheGroupOfAPoorMesh) {
    // Else the test above would prove nothing.
    const SurfaceMesh mesh = testing::generated("eight", 1500, 0.45);
    StructureOptions with, without;
    with.base = without.base = 0;
    without.flow.delaunay = false;
    const SurfaceStructure a = structure_of(mesh, with), b = structure_of(mesh, without);
    EXPECT_GT(a.refinement->isometric_flips, 0);
    const double there = trace_size(element_of(b.group, b.basis->word_of_path(a.basis->loop_path(0))));
    EXPECT_GT(std::abs(trace_size(a.group.letters[0]) - there), 1e-6);
}

/// Paths by the vertices that they visit, on a surface without multi-edges.
PathMap renumbered(const Connectivity& from, const Connectivity& to, const std::vector<Index>& number) {
    auto step = std::make_shared<std::map<std::pair<Index, Index>, Step>>();
    for (Index h = 0; h < to.halfedge_count(); ++h) {
        (*step)[{to.tail[at(h)], to.head(h)}] = h;
        if (to.twin[at(h)] == kNoTwin) (*step)[{to.head(h), to.tail[at(h)]}] = ~h;
    }
    return [step, &from, &number](const EdgePath& path) {
        EdgePath moved;
        for (const Step s : path)
            moved.push_back(step->at({number[at(step_tail(from, s))], number[at(step_head(from, s))]}));
        return moved;
    };
}

TEST(GroupInvariance, NumbersDoNotMatter) {
    for (const char* name : {"eight", "genus-g-one-boundary", "pants"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = testing::generated(name, 1000, 0.3, 1);
        Random random(3);
        const std::vector<Index> number = random.permutation(mesh.connectivity.vertex_count);
        const SurfaceMesh other = testing::relabelled(mesh, number, random);
        StructureOptions options;
        options.flow.tolerance = 1e-12;
        const SurfaceStructure a = structure_of(mesh, options), b = structure_of(other, options);
        // Residuals of 1e-12 each.
        expect_same_group(a, b, renumbered(mesh.connectivity, other.connectivity, number), 1e-9);
    }
}

TEST(GroupInvariance, TheBasePointDoesNotMatter) {
    for (const char* name : {"eight", "genus-g", "genus-g-one-boundary", "pants"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = testing::generated(name, 1000, 0.3, 3);
        StructureOptions options;
        const SurfaceStructure a = structure_of(mesh, options);
        for (const Index base : {Index{0}, mesh.connectivity.vertex_count / 2}) {
            options.base = base;
            const SurfaceStructure b = structure_of(mesh, options);
            EXPECT_EQ(b.basis->base(), base);
            // The same metric, of residual 1e-12 at most; loops pass its vertices on different sides, and far
            // ones count e^R, some 1e3.
            expect_same_group(a, b, unmoved, 1e-9);
        }
    }
}

TEST(GroupInvariance, TheCutOfFlatFacesDoesNotMatter) {
    // Vertices are cones of the flat metric, so every triangulation has the same Delaunay one.
    const SurfaceMesh mesh = testing::generated("eight", 400, 0.3);
    const SurfaceMesh other = testing::scrambled(mesh, 2000, 7);
    StructureOptions options;
    options.flow.tolerance = 1e-12;
    const SurfaceStructure a = structure_of(mesh, options), b = structure_of(other, options);
    EXPECT_GT(b.refinement->isometric_flips, 100);
    // Edge paths do not carry over; the lengths of the final triangulation determine the metric.
    std::vector<double> x = a.flow.edge_length, y = b.flow.edge_length;
    std::sort(x.begin(), x.end());
    std::sort(y.begin(), y.end());
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(x[k], y[k], 1e-9);
}

}  // namespace
}  // namespace ricci
