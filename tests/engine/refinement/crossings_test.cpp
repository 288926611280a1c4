// Curves of one triangulation across another, and where they cross its edges.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/refinement/crossing_points.h"
#include "engine/surfaces/generate.h"
#include "engine/surfaces/regular_map.h"
#include "kernels/delaunay.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using namespace ricci::testing;
using Real = long double;

/// Two triangles 0 1 2 and 1 0 3 with the edge 0-1 between them.
Connectivity quadrilateral() {
    return build_connectivity(std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}}, 4);
}

/// Logarithms of lengths given by ends.
template <class Length>
std::vector<Real> logs(const Connectivity& c, Length&& length) {
    std::vector<Real> result;
    for (Index h = 0; h < c.halfedge_count(); ++h)
        result.push_back(std::log(Real(length(c.tail[at(h)], c.head(h)))));
    return result;
}

struct OneFlip {
    NormalCurves curves;
    CurvePaths paths;
    explicit OneFlip(const Connectivity& c) : curves(c) {
        curves.flip(0);
        paths = curves.trace();
    }
};

TEST(StraightCrossings, DiagonalsOfAPlanarQuadrilateral) {
    // 2 above and 3 below the edge from 0 to 1.
    const double x[4] = {0, 3, 1, 2.2}, y[4] = {0, 0, 2, -1.5};
    const OneFlip flip(quadrilateral());
    const auto length = [&](Index i, Index j) { return std::hypot(x[i] - x[j], y[i] - y[j]); };
    const auto points =
        straight_crossings(flip.curves.connectivity(), logs(flip.curves.connectivity(), length), flip.paths);
    ASSERT_EQ(points.size(), 1U);
    // The line from 3 to 2 meets the x axis at s.
    const double t = 1.5 / 3.5, s = x[3] + t * (x[2] - x[3]);
    EXPECT_NEAR(static_cast<double>(points[0].on_curve), s / 3, 1e-15);
    const Index h = flip.paths.crossing[0].halfedge;
    const bool up = flip.curves.connectivity().tail[at(h)] == 3;
    EXPECT_NEAR(static_cast<double>(points[0].on_edge), up ? t : 1 - t, 1e-15);
}

/// An ideal vertex as a symmetric matrix w w^T of rank one: (w0 w0, w0 w1, w1 w1).
std::array<double, 3> light_vector(const std::array<double, 2>& w) {
    return {w[0] * w[0], w[0] * w[1], w[1] * w[1]};
}
std::array<double, 3> cross(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

TEST(IdealCrossings, AgreeWithPlanesThroughLightLikeVectors) {
    // Lambda lengths are |det(w_i, w_j)|; the point where geodesics cross is on both planes.
    Random random(7);
    for (int trial = 0; trial < 50; ++trial) {
        // On the ideal circle the order is 0, 3, 1, 2 (by the slope of w), so 0-1 and 3-2 cross.
        std::array<std::array<double, 2>, 4> w;
        const double angle[4] = {random.uniform(0.1, 0.5), random.uniform(1.3, 1.8), random.uniform(2.1, 2.9),
                                 random.uniform(0.7, 1.1)};
        for (std::size_t i = 0; i < 4; ++i) {
            const double size = random.uniform(0.5, 2.0);
            w[i] = {size * std::cos(angle[i]), size * std::sin(angle[i])};
        }
        std::vector<double> u;
        for (int i = 0; i < 4; ++i) u.push_back(random.uniform(-1, 1));
        const auto lambda = [&](Index i, Index j) {
            return std::abs(w[at(i)][0] * w[at(j)][1] - w[at(i)][1] * w[at(j)][0]);
        };
        const OneFlip flip(quadrilateral());
        const Connectivity& c = flip.curves.connectivity();
        const auto points = ideal_crossings(c, logs(c, lambda), u, flip.paths);
        ASSERT_EQ(points.size(), 1U);
        const auto v = [&](Index i) { return light_vector(w[at(i)]); };
        const auto both = cross(cross(v(0), v(1)), cross(v(2), v(3)));
        // (1 - t) v0 + t v1 is that point up to a factor, and tail e^u v_tail + head e^u v_head is it
        // exactly.
        const auto t = static_cast<double>(points[0].on_curve);
        std::array<double, 3> on_curve{}, on_edge{};
        const Index h = flip.paths.crossing[0].halfedge, tail = c.tail[at(h)], head = c.head(h);
        for (std::size_t k = 0; k < 3; ++k) {
            on_curve[k] = (1 - t) * v(0)[k] + t * v(1)[k];
            on_edge[k] = static_cast<double>(points[0].tail) * std::exp(u[at(tail)]) * v(tail)[k] +
                         static_cast<double>(points[0].head) * std::exp(u[at(head)]) * v(head)[k];
        }
        const double factor = on_curve[0] / both[0];
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(on_curve[k], factor * both[k], 1e-12);
            EXPECT_NEAR(on_edge[k], on_curve[k], 1e-12);
        }
    }
}

/// Length of every original edge through the faces it crosses, unfolded, against its own length.
void expect_straight(IntrinsicTriangulation<Real> t) {
    const IntrinsicTriangulation<Real> original = t;
    NormalCurves curves(t.connectivity);
    DelaunayWorkspace workspace;
    make_delaunay<Real>(t, {}, FlipRule::isometric, workspace);
    for (const Index h : workspace.flipped) curves.flip(h);
    EXPECT_EQ(curves.connectivity().twin, t.connectivity.twin);
    const CurvePaths paths = curves.trace();
    const auto points = straight_crossings(t.connectivity, t.log_chord, paths);
    std::size_t crossed = 0;
    for (Index e = 0; e < t.connectivity.edge_count; ++e) {
        const Index first = paths.first[at(e)], last = paths.first[at(e) + 1];
        crossed += first < last ? 1 : 0;
        for (Index k = first; k < last; ++k) {
            EXPECT_GT(points[at(k)].on_edge, 0);
            EXPECT_LT(points[at(k)].on_edge, 1);
            EXPECT_GT(points[at(k)].on_curve, k == first ? Real(0) : points[at(k) - 1].on_curve);
            EXPECT_LT(points[at(k)].on_curve, 1);
        }
    }
    EXPECT_GT(crossed, 0U) << "nothing flipped: the surface is no test";
}

TEST(NormalCurves, FollowIsometricFlipsAsStraightLines) {
    expect_straight(intrinsic_triangulation<Real>(bumpy_torus(12, 9, 0.25)));
    GenerateOptions options;
    options.faces = 1500;
    options.jitter = 0.45;
    expect_straight(intrinsic_triangulation<Real>(generate("eight", options)));
    expect_straight(one_vertex_torus<Real>(1.0L, 1.1L, 2.05L));
}

TEST(NormalCurves, FourFlipsOfAnEdgeAreNone) {
    for (const SurfaceMesh& mesh : {make_bolza(), make_klein_quartic(), icosahedron(0.1)}) {
        const Connectivity& c = mesh.connectivity;
        for (Index h = 0; h < c.halfedge_count(); h += 7) {
            if (c.twin[at(h)] < h) continue;
            NormalCurves curves(c);
            const DirectedEdge before = curves.shared(h);
            Index slot = h;
            for (int k = 0; k < 4; ++k) {
                curves.flip(slot);
                slot = next_halfedge(slot);  // where the new edge is
                if (k == 0) {
                    EXPECT_EQ(curves.count(slot), 1);
                }
                if (k == 1) {
                    EXPECT_EQ(curves.count(slot), 0);
                }
            }
            EXPECT_EQ(curves.shared(slot) / 2, before / 2);
        }
    }
}

}  // namespace
}  // namespace ricci
