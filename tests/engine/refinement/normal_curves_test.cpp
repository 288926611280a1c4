#include "engine/refinement/normal_curves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/refinement/crossing_points.h"
#include "tests/engine/refinement/refinement_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::NamedMesh;
using Real = long double;

/// A triangulation and its isometric Delaunay one, with the flips between them.
struct Flipped {
    IntrinsicTriangulation<Real> start, end;
    NormalCurves curves;

    explicit Flipped(const SurfaceMesh& mesh)
        : start(intrinsic_triangulation<Real>(mesh)), end(start), curves(start.connectivity) {
        DelaunayWorkspace workspace;
        EXPECT_TRUE(make_delaunay<Real>(end, {}, FlipRule::isometric, workspace).finished);
        for (const Index h : workspace.flipped) curves.flip(h);
    }
};

/// Where a curve meets the boundary of a face: a distance from the tail of a halfedge.
struct Mark {
    Index halfedge = -1;
    Real distance = 0;
};

/// Length of the segment between marks on two different sides of one face, by the law of cosines.
Real segment_length(std::span<const Real> log_length, Mark p, Mark q) {
    const auto length = [&](Index h) { return std::exp(log_length[at(h)]); };
    if (q.halfedge != next_halfedge(p.halfedge)) std::swap(p, q);
    const Real a = length(p.halfedge), b = length(q.halfedge), c = length(next_halfedge(q.halfedge));
    const Real cosine = (a * a + b * b - c * c) / (2 * a * b), from_p = a - p.distance, from_q = q.distance;
    return std::sqrt(from_p * from_p + from_q * from_q - 2 * from_p * from_q * cosine);
}

TEST(NormalCurves, RunsAlongTheSameEdgesAsTheResultOfTheFlips) {
    for (const NamedMesh& surface : testing::refinement_surfaces()) {
        SCOPED_TRACE(surface.name);
        const Flipped flipped(surface.mesh);
        EXPECT_EQ(flipped.curves.connectivity().twin, flipped.end.connectivity.twin);
        EXPECT_EQ(flipped.curves.connectivity().tail, flipped.end.connectivity.tail);
        const CurvePaths paths = flipped.curves.trace();
        for (const Index h : edge_halfedges(flipped.start.connectivity)) {
            const Index along = paths.shared[at(flipped.start.connectivity.edge[at(h)])];
            if (along < 0) continue;
            EXPECT_EQ(flipped.end.connectivity.tail[at(along)], flipped.start.connectivity.tail[at(h)]);
            EXPECT_EQ(flipped.end.connectivity.head(along), flipped.start.connectivity.head(h));
            // The lengths of edges that were flipped there and back carry a few roundings of 5e-20, magnified
            // by thin quadrilaterals (angles from 0.1 on).
            EXPECT_NEAR(
                static_cast<double>(flipped.end.log_chord[at(along)] - flipped.start.log_chord[at(h)]), 0.0,
                1e-15);
        }
    }
}

TEST(NormalCurves, ACurveThroughTheStripIsAsLongAsItsEdge) {
    std::size_t crossings = 0;
    for (const NamedMesh& surface : testing::refinement_surfaces()) {
        SCOPED_TRACE(surface.name);
        const Flipped flipped(surface.mesh);
        const Connectivity& c = flipped.end.connectivity;
        const std::vector<Real>& log_length = flipped.end.log_chord;
        const CurvePaths paths = flipped.curves.trace();
        const auto points = straight_crossings(c, log_length, paths);
        for (const Index original : edge_halfedges(flipped.start.connectivity)) {
            const Index e = flipped.start.connectivity.edge[at(original)];
            const Real whole = std::exp(flipped.start.log_chord[at(original)]);
            const std::span<const Crossing> path = paths.of(e);
            if (path.empty()) continue;
            // A corner is a mark at the start of its halfedge.
            Mark from{prev_halfedge(path.front().halfedge), 0};
            EXPECT_EQ(c.tail[at(from.halfedge)], flipped.start.connectivity.tail[at(original)]);
            Real done = 0;
            for (std::size_t k = 0; k < path.size(); ++k) {
                const Index h = path[k].halfedge, t = c.twin[at(h)];
                const CrossingPoint& point = points[at(paths.first[at(e)]) + k];
                EXPECT_GT(point.on_edge, 0);
                EXPECT_LT(point.on_edge, 1);
                const Real width = std::exp(log_length[at(h)]);
                const Real step = segment_length(log_length, from, {h, point.on_edge * width});
                // Double inputs, long double arithmetic; the law of cosines cancels in thin faces.
                EXPECT_NEAR(static_cast<double>((done + step) / whole), static_cast<double>(point.on_curve),
                            1e-13);
                done += step;
                from = {t, (1 - point.on_edge) * width};
                ++crossings;
            }
            const Index last = prev_halfedge(from.halfedge);  // starts at the far corner
            EXPECT_EQ(c.tail[at(last)], flipped.start.connectivity.head(original));
            done += segment_length(log_length, from, {last, 0});
            EXPECT_NEAR(static_cast<double>(done / whole), 1.0, 1e-13);
        }
    }
    EXPECT_GT(crossings, 400u);
}

/// Flips one edge again and again, wherever its halfedge moves; returns that.
Index flip_repeatedly(NormalCurves& curves, Index h, int times) {
    for (int i = 0; i < times; ++i) {
        curves.flip(h);
        h = next_halfedge(h);
    }
    return h;
}

TEST(NormalCurves, FlippingAnEdgeRepeatedlyBringsEverythingBack) {
    for (const NamedMesh& surface : testing::refinement_surfaces()) {
        SCOPED_TRACE(surface.name);
        const Flipped flipped(surface.mesh);
        const CurvePaths before = flipped.curves.trace();
        for (Index h = 0; h < flipped.end.connectivity.halfedge_count(); h += 1 + h / 20) {
            if (!flippable(flipped.end.connectivity, h)) continue;
            NormalCurves curves = flipped.curves;
            const DirectedEdge shared = curves.shared(h);
            const Index count = curves.count(h);
            // Two flips turn the edge by half a turn, four by a whole one: a face's halfedges are then one
            // further, and in their old places after twelve.
            Index diagonal = flip_repeatedly(curves, h, 2);
            EXPECT_EQ(curves.shared(diagonal), shared < 0 ? shared : reversed(shared));
            EXPECT_EQ(curves.count(diagonal), count);
            diagonal = flip_repeatedly(curves, diagonal, 2);
            EXPECT_EQ(diagonal, next_halfedge(h));
            EXPECT_EQ(curves.shared(diagonal), shared);
            flip_repeatedly(curves, diagonal, 8);
            EXPECT_EQ(curves.connectivity().twin, flipped.end.connectivity.twin);
            const CurvePaths after = curves.trace();
            EXPECT_EQ(after.shared, before.shared);
            EXPECT_EQ(after.first, before.first);
            for (std::size_t x = 0; x < before.crossing.size(); ++x) {
                EXPECT_EQ(after.crossing[x].halfedge, before.crossing[x].halfedge);
                EXPECT_EQ(after.crossing[x].position, before.crossing[x].position);
            }
        }
    }
}

TEST(NormalCurves, AnyFlipsCanBeUndone) {
    // How curves run is a matter of topology alone: flips need not be geodesic in a given flat metric.
    for (const NamedMesh& surface : testing::refinement_surfaces()) {
        SCOPED_TRACE(surface.name);
        testing::Random random(6);
        const Connectivity& original = surface.mesh.connectivity;
        NormalCurves curves(original);
        std::vector<Index> flips;
        // Crossings may grow like a power of two.
        for (Index i = 0; i < 12; ++i) {
            const Index h = random.below(original.halfedge_count());
            if (!flippable(curves.connectivity(), h)) continue;
            curves.flip(h);
            flips.push_back(h);
        }
        (void)curves.trace();  // throws where curves do not add up
        for (; !flips.empty(); flips.pop_back()) flip_repeatedly(curves, next_halfedge(flips.back()), 11);
        EXPECT_EQ(curves.connectivity().tail, original.tail);
        EXPECT_EQ(curves.connectivity().twin, original.twin);
        const CurvePaths paths = curves.trace();
        EXPECT_TRUE(paths.crossing.empty());
        EXPECT_EQ(paths.shared, edge_halfedges(original));
    }
}

}  // namespace
}  // namespace ricci
