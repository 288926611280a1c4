// A coarse surface is the same surface as the one it was made of, exactly: angles, area, frames, boundaries.
#include "engine/shape_space/coarse_surface.h"

#include "engine/shape_space/unfolding.h"
#include "engine/topology/boundary_loops.h"
#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::generated;
using testing::hyperbolic_angle;
using testing::NamedMesh;
using testing::smooth_triangulation;

constexpr double kPi = std::numbers::pi;

std::vector<NamedMesh> surfaces() {
    std::vector<NamedMesh> all;
    for (NamedMesh& s : testing::refinement_surfaces())
        if (topology_of(s.mesh.connectivity).euler_characteristic < 0) all.push_back(std::move(s));
    all.push_back({"genus 2, one boundary", generated("genus-g-one-boundary", 500, 0.3)});
    all.push_back({"klein quartic", make_klein_quartic()});
    return all;
}

double angle_at(const CoarseSurface& s, Index h) {
    return hyperbolic_angle(s.half_chord[at(h)], s.half_chord[at(prev_halfedge(h))],
                            s.half_chord[at(next_halfedge(h))]);
}

/// Angles, by lengths alone, add up; so does the area; steps are the moves along edges. Edges of length l, as
/// they arise where few vertices are left, cost e^l of the digits.
void expect_exact(const CoarseSurface& s, const Topology& topology, double angle_error = 1e-11) {
    const Connectivity& c = s.connectivity;
    EXPECT_EQ(s.genus, topology.genus);
    EXPECT_EQ(s.boundaries, topology.boundaries);
    EXPECT_EQ(topology_of(c).euler_characteristic, topology.euler_characteristic);
    EXPECT_LE(s.angle_error, angle_error);
    std::vector<double> sum(at(c.vertex_count), 0.0);
    std::vector<std::uint8_t> boundary(sum.size(), 0);
    double area = 0;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        sum[at(c.tail[at(h)])] += angle_at(s, h);
        area += kPi / 3 - angle_at(s, h);
        if (c.twin[at(h)] == kNoTwin) boundary[at(c.tail[at(h)])] = 1;
        // d(frame, next frame) = the edge's length; sinh of half of it is |b|.
        ASSERT_NEAR(std::sqrt(squared(s.step[at(h)].b)), s.half_chord[at(h)], 1e-11);
        const Index t = c.twin[at(h)], turned = s.turned(h);
        if (t != kNoTwin) {
            ASSERT_NEAR(s.half_chord[at(h)], s.half_chord[at(t)], 1e-12);
            const Isometry<double> there_and_back = compose(-1, s.step[at(h)], s.step[at(t)]);
            ASSERT_LE(distance_to_identity(there_and_back), 1e-10);
        }
        if (turned != kNoTwin) {
            const double step = s.direction[at(turned)] - s.direction[at(h)] - angle_at(s, h);
            ASSERT_NEAR(std::remainder(step, 2 * kPi), 0.0, 1e-9);
        }
        if (h % 3 != 0) continue;
        const Isometry<double> around =
            compose(-1, compose(-1, s.step[at(h)], s.step[at(h) + 1]), s.step[at(h) + 2]);
        ASSERT_LE(distance_to_identity(around), 1e-9);
    }
    EXPECT_NEAR(area, -2 * kPi * topology.euler_characteristic, 1e-9);
    for (std::size_t v = 0; v < sum.size(); ++v) {
        ASSERT_NEAR(sum[v], boundary[v] ? kPi : 2 * kPi, 2 * angle_error);
        const Index out = s.outgoing[v];
        ASSERT_EQ(c.tail[at(out)], static_cast<Index>(v));
        ASSERT_EQ(c.twin[at(out)] == kNoTwin, boundary[v] != 0);
    }
}

TEST(CoarseSurface, AnglesAreaAndStepsAreExact) {
    for (const NamedMesh& item : surfaces()) {
        const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
        Index most = fine.connectivity.vertex_count + 1;
        for (const double spacing : {0.0, 0.5, 0.9, 1.3, 4.0}) {
            SCOPED_TRACE(item.name + ", spacing " + std::to_string(spacing));
            CoarseOptions options;
            options.spacing = spacing;
            options.largest_radius = std::max(1.1, spacing);
            const CoarseSurface s = make_coarse_surface(fine, options);
            expect_exact(s, topology_of(item.mesh.connectivity), spacing > 1 ? 1e-9 : 1e-11);
            if (spacing == 0.0) {
                EXPECT_GE(s.connectivity.vertex_count, fine.connectivity.vertex_count);
            } else if (!item.mesh.intrinsic()) {
                EXPECT_LT(s.connectivity.vertex_count, most) << "nothing was removed";
            }
            most = s.connectivity.vertex_count + (spacing > 0.9 ? 10 : 0);
        }
    }
}

TEST(CoarseSurface, RadiiCover) {
    for (const NamedMesh& item : surfaces()) {
        SCOPED_TRACE(item.name);
        const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
        for (const double largest : {1.1, 0.6}) {
            CoarseOptions options;
            options.largest_radius = largest;
            const CoarseSurface s = make_coarse_surface(fine, options);
            expect_exact(s, topology_of(item.mesh.connectivity));
            double tightest = 0;
            for (const double r : s.radius) ASSERT_LE(r, largest);
            for (Index f = 0; f < s.connectivity.face_count(); ++f) {
                const std::size_t h = 3 * at(f);
                const std::vector<double> sides{s.half_chord[h], s.half_chord[h + 1], s.half_chord[h + 2]};
                const auto corner = make_final_metric<double>(-1, sides).corners(0);
                for (int i = 0; i <= 20; ++i)
                    for (int j = 0; i + j <= 20; ++j) {
                        const auto x = testing::mixed(corner, i / 20.0, j / 20.0);
                        double best = 1e300;
                        for (std::size_t k = 0; k < 3; ++k)
                            best = std::min(best, testing::distance(-1, x, corner[k]) /
                                                      s.radius[at(s.connectivity.tail[h + k])]);
                        ASSERT_LE(best, 1 + 1e-9);
                        tightest = std::max(tightest, best);
                    }
            }
            EXPECT_GE(tightest, 0.85) << "radii are larger than need be";
        }
    }
}

TEST(CoarseSurface, VerticesArePutInWhereTheyAreWanting) {
    for (const NamedMesh& item : surfaces()) {
        SCOPED_TRACE(item.name);
        const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
        CoarseOptions options;
        options.spacing = 4.0;
        options.largest_radius = 0.7;
        const CoarseSurface s = make_coarse_surface(fine, options);
        Index put_in = 0;
        for (std::size_t v = 0; v < s.fine_vertex.size(); ++v) {
            put_in += s.fine_vertex[v] < 0 ? 1 : 0;
            EXPECT_EQ(s.fine_vertex[v] < 0, s.reference[v] == kNoTwin);
            EXPECT_EQ(s.fine_vertex[v] < 0, s.final_face[v] < 0);
            if (s.fine_vertex[v] < 0) continue;
            EXPECT_EQ(fine.connectivity.tail[at(s.reference[v])], s.fine_vertex[v]);
        }
        EXPECT_GT(put_in, 0);
        expect_exact(s, topology_of(item.mesh.connectivity), 1e-9);
    }
}

/// Lifts of vertices that both surfaces have, seen from one of them: the frames are the same whatever was
/// removed or put in.
void expect_same_view(const CoarseSurface& all, const CoarseSurface& few) {
    std::map<Index, Index> number;
    for (std::size_t v = 0; v < all.fine_vertex.size(); ++v)
        if (all.fine_vertex[v] >= 0) number[all.fine_vertex[v]] = static_cast<Index>(v);
    std::vector<std::uint8_t> in_few(all.fine_vertex.size(), 0);
    for (const Index v : few.fine_vertex)
        if (v >= 0) in_few[at(number.at(v))] = 1;
    constexpr double kDistance = 2.3;
    const auto budget = std::numeric_limits<std::int64_t>::max();
    Index seen = 0;
    for (Index p = 0; p < few.connectivity.vertex_count; ++p) {
        if (few.fine_vertex[at(p)] < 0) continue;
        testing::IsometrySet fine, coarse;
        Unfolding(all).visit(number.at(few.fine_vertex[at(p)]), kDistance, budget,
                             [&](Index v, const Isometry<double>& x) {
                                 if (in_few[at(v)]) fine.insert(x, all.fine_vertex[at(v)]);
                             });
        Unfolding(few).visit(p, kDistance, budget, [&](Index v, const Isometry<double>& x) {
            if (few.fine_vertex[at(v)] >= 0) coarse.insert(x, few.fine_vertex[at(v)]);
        });
        ASSERT_EQ(fine.elements().size(), coarse.elements().size());
        for (std::size_t k = 0; k < fine.elements().size(); ++k)
            ASSERT_GE(coarse.find(fine.elements()[k], fine.labels()[k]), 0);
        seen += static_cast<Index>(fine.elements().size());
    }
    EXPECT_GT(seen, 30);
}

TEST(CoarseSurface, FramesAreThoseOfTheFineTriangulation) {
    for (const NamedMesh& item : surfaces()) {
        SCOPED_TRACE(item.name);
        const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
        CoarseOptions all;
        all.spacing = 0.0;
        const CoarseSurface every = make_coarse_surface(fine, all);
        for (const double largest : {1.1, 0.6}) {
            CoarseOptions options;
            options.largest_radius = largest;
            expect_same_view(every, make_coarse_surface(fine, options));
        }
    }
}

TEST(CoarseSurface, BoundariesAreNamedAndKeepTheirLength) {
    for (const NamedMesh& item : surfaces()) {
        const Connectivity& input = item.mesh.connectivity;
        const std::vector<std::vector<Index>> loops = boundary_loops(input);
        if (loops.empty()) continue;
        SCOPED_TRACE(item.name);
        // From the deck transformations: c1, c2, ... go around the boundaries in the order of their loops.
        StructureOptions options;
        options.flow.tolerance = 1e-12;
        const SurfaceStructure structure = testing::structure_of(item.mesh, options);
        std::vector<double> length(loops.size());
        for (const GroupGenerator& g : structure.group.generators)
            if (g.name[0] == 'c')
                length.at(at(std::stoi(g.name.substr(1)) - 1)) =
                    2 * std::acosh(testing::trace_size(g.element) / 2);
        for (const double spacing : {0.3, 0.9, 4.0}) {
            const CoarseSurface s = testing::thinned(item.mesh, spacing);
            std::vector<Index> named = input_boundaries(s, input);
            const std::vector<std::vector<Index>> coarse = boundary_loops(s.connectivity);
            ASSERT_EQ(named.size(), loops.size());
            ASSERT_EQ(coarse.size(), loops.size());
            for (std::size_t k = 0; k < coarse.size(); ++k) {
                double sum = 0;
                for (const Index h : coarse[k]) sum += 2 * std::asinh(s.half_chord[at(h)]);
                ASSERT_GE(named[k], 0);
                EXPECT_NEAR(sum, length[at(named[k])], 1e-9);
            }
            std::sort(named.begin(), named.end());
            for (std::size_t k = 0; k < named.size(); ++k) EXPECT_EQ(named[k], static_cast<Index>(k));
        }
    }
}

}  // namespace
}  // namespace ricci
