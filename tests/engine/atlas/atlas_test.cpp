#include "engine/atlas/atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "engine/atlas/atlas_checks.h"
#include "engine/surfaces/generate.h"
#include "tests/engine/quality/quality_surfaces.h"

namespace ricci {
namespace {

using std::numbers::pi;
using testing::at;

SurfaceMesh generated(const std::string& name, Index faces, Index genus = 2) {
    GenerateOptions options;
    options.faces = faces;
    options.genus = genus;
    options.jitter = 0.3;
    options.seed = 3;
    return generate(name, options);
}

/// A mesh, its solved metric, and an atlas of it.
struct Made {
    SurfaceMesh mesh;
    testing::Solved solved;
    AtlasOptions options;
    Atlas atlas;
    AtlasChecks checks;
};

Made make(SurfaceMesh mesh, AtlasKind kind, const FlowOptions& flow = {}, Index charts = 0) {
    Made m;
    m.mesh = std::move(mesh);
    m.solved = testing::solved(m.mesh, flow);
    EXPECT_EQ(m.solved.flow.outcome.status, Status::converged);
    m.options.kind = kind;
    m.options.charts = charts;
    for (const Cone& cone : flow.cones) m.options.cones.push_back(cone.vertex);
    m.atlas = make_atlas(m.mesh.connectivity, m.solved.refinement, m.solved.metric, m.options);
    m.checks = check_atlas(m.solved.refinement, m.atlas, m.options.cones);
    return m;
}

/// All curvature in one vertex.
FlowOptions one_cone(const SurfaceMesh& mesh, Index v) {
    FlowOptions options;
    options.geometry = Geometry::euclidean;
    options.cones = {{v, 2 * pi * topology_of(mesh.connectivity).euler_characteristic}};
    return options;
}

/// The metric misses its curvature by up to 1e-10 at each vertex, and so do maps taken on either side of one:
/// in a chart or two by V times that, times the size of coordinates and matrix entries (a few units).
double metric_error(const Made& m) {
    return 10 * 1e-10 * m.mesh.connectivity.vertex_count;
}

void expect_whole(const Made& m) {
    EXPECT_GE(m.atlas.charts.size(), 4U);
    EXPECT_GT(m.checks.overlaps, 0);
    EXPECT_GT(m.checks.triples, 0);
    EXPECT_EQ(m.checks.not_disks, 0);
    EXPECT_EQ(m.checks.uncovered_vertices, 0);
    EXPECT_EQ(m.checks.uncovered_sides, 0);
    EXPECT_TRUE(m.atlas.uncovered.empty());
    EXPECT_LT(m.checks.vertex_disagreement, metric_error(m));
    EXPECT_LT(m.checks.edge_disagreement, metric_error(m));
    EXPECT_LT(m.checks.cocycle_error, metric_error(m));
    EXPECT_LT(m.checks.closing_error, metric_error(m));
    EXPECT_LT(m.checks.form_error, 1e-14);  // rounding of a few products
    // A matrix that moves the origin by 10 has entries of e^10 / 2, and takes them off each other.
    EXPECT_LT(m.checks.circle_error, 1e-10);
}

TEST(Atlas, OfClosedSurfacesAndSurfacesWithBoundary) {
    struct Case {
        std::string name;
        Index faces;
        AtlasKind kind;
    };
    for (const Case& x :
         {Case{"torus", 1200, AtlasKind::affine}, Case{"eight", 1500, AtlasKind::hyperbolic},
          Case{"eight", 1500, AtlasKind::projective}, Case{"annulus", 600, AtlasKind::affine},
          Case{"pants", 900, AtlasKind::hyperbolic}, Case{"pants", 900, AtlasKind::projective},
          Case{"sphere", 600, AtlasKind::spherical}, Case{"disk", 600, AtlasKind::spherical}}) {
        SCOPED_TRACE(x.name + " " + std::string(name_of(x.kind)));
        expect_whole(make(generated(x.name, x.faces), x.kind));
    }
}

TEST(Atlas, OneChartAskedFor) {
    // A single patch cannot cover a torus: charts across its seams are added.
    const Made m = make(generated("torus", 800), AtlasKind::affine, {}, 1);
    EXPECT_GT(m.atlas.charts.size(), 1U);
    expect_whole(m);
}

/// Whether the point lies inside the convex polygon, farther than `margin` from its sides.
bool lies_inside(const std::vector<std::array<double, 2>>& polygon, const std::array<double, 2>& x,
                 double margin) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double cross = (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]);
        if (cross <= margin * std::hypot(b[0] - a[0], b[1] - a[1])) return false;
    }
    return true;
}

/// Pieces of the chart whose image holds the middle of another one's.
Index overlapping_pieces(const Made& m, const Chart& chart) {
    const CommonRefinement& r = m.solved.refinement;
    std::vector<std::vector<std::array<double, 2>>> polygon;
    std::vector<std::array<double, 2>> middle;
    for (std::size_t i = 0; i < chart.pieces.size(); ++i) {
        const Index p = chart.pieces[i];
        const auto corner = m.solved.metric.corners(r.final_face[at(p)]);
        polygon.emplace_back();
        std::array<double, 2> sum{};
        for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
            const auto& w = r.weight[at(c)];
            const double total = w[0] + w[1] + w[2];
            std::array<double, 3> x{0, 0, 1};
            for (std::size_t k = 0; k < 2; ++k)
                x[k] = (w[0] * corner[0][k] + w[1] * corner[1][k] + w[2] * corner[2][k]) / total;
            const auto y = apply(0, chart.frame[i], x);
            polygon.back().push_back({y[0], y[1]});
            sum = {sum[0] + y[0], sum[1] + y[1]};
        }
        const auto n = static_cast<double>(polygon.back().size());
        middle.push_back({sum[0] / n, sum[1] / n});
    }
    Index count = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        for (std::size_t j = 0; j < polygon.size(); ++j)
            // Rounding moves points by about 1e-15 of the surface's size, here a few units.
            if (i != j && lies_inside(polygon[i], middle[j], 1e-12)) ++count;
    return count;
}

TEST(Atlas, AffineWithOneCone) {
    for (const Index genus : {2, 3}) {
        SCOPED_TRACE(genus);
        const SurfaceMesh mesh = generated("genus-g", genus == 2 ? 900 : 1300, genus);
        const Index cone = mesh.connectivity.vertex_count / 3;
        const Made m = make(mesh, AtlasKind::affine, one_cone(mesh, cone));
        expect_whole(m);
        for (const Chart& chart : m.atlas.charts) {
            // The cone is on the rim where it is at all, and nothing wraps around it.
            const auto found = std::lower_bound(chart.vertices.begin(), chart.vertices.end(), cone);
            if (found != chart.vertices.end() && *found == cone) {
                EXPECT_EQ(chart.inside[static_cast<std::size_t>(found - chart.vertices.begin())], 0);
            }
            EXPECT_EQ(overlapping_pieces(m, chart), 0);
        }
    }
}

TEST(Atlas, ForgottenConeIsSeen) {
    const SurfaceMesh mesh = generated("eight", 900);
    const Index cone = mesh.connectivity.vertex_count / 3;
    const testing::Solved s = testing::solved(mesh, one_cone(mesh, cone));
    const Atlas atlas = make_atlas(mesh.connectivity, s.refinement, s.metric, {});
    // Its star, 6 pi wide, cannot be laid out one to one.
    EXPECT_NE(std::find(atlas.uncovered.begin(), atlas.uncovered.end(), cone), atlas.uncovered.end());
}

// A flat torus mapped to itself: distances in charts are those of the mesh, whatever pieces edges fall into.
TEST(Atlas, ChartsOfAFlatTorusAreIsometric) {
    const SurfaceMesh mesh = testing::flat_torus(10, 0.3, 4, {1.0, 0.9, 0.0, 0.7});
    const std::vector<double> u(100, 0.0);
    const CommonRefinement r = make_common_refinement(mesh, u, false, true);
    const Atlas atlas = make_atlas(mesh.connectivity, r, make_final_metric(0, r), {});
    const Connectivity& c = mesh.connectivity;
    for (const Chart& chart : atlas.charts)
        for (const Index f : chart.faces)
            for (Index h = 3 * f; h < 3 * f + 3; ++h) {
                const auto place = [&](Index v) {
                    const auto i = static_cast<std::size_t>(
                        std::lower_bound(chart.vertices.begin(), chart.vertices.end(), v) -
                        chart.vertices.begin());
                    return std::array<double, 2>{chart.point[2 * i], chart.point[2 * i + 1]};
                };
                const auto x = place(c.tail[at(h)]), y = place(c.head(h));
                EXPECT_NEAR(std::hypot(y[0] - x[0], y[1] - x[1]), mesh.edge_length[at(h)], 1e-12);
            }
    const AtlasChecks checks = check_atlas(r, atlas, {});
    EXPECT_LT(checks.cocycle_error, 1e-12);
    EXPECT_LT(checks.vertex_disagreement, 1e-12);
    EXPECT_EQ(checks.uncovered_vertices, 0);
}

// Regular triangles with angles 2 pi / 7 have sides with cosh l = cos A / (1 - cos A); the disk of Poincare
// and Klein's show the same points, z -> 2 z / (1 + |z|^2).
TEST(Atlas, ModelsOfTheKleinQuartic) {
    GenerateOptions options;
    options.faces = 56;
    const SurfaceMesh mesh = generate("klein-quartic", options);
    const Made disk = make(mesh, AtlasKind::hyperbolic), klein = make(mesh, AtlasKind::projective);
    expect_whole(disk);
    const double cosine = std::cos(2 * pi / 7), side = std::acosh(cosine / (1 - cosine));
    ASSERT_EQ(disk.atlas.charts.size(), klein.atlas.charts.size());
    const Connectivity& c = mesh.connectivity;
    for (std::size_t k = 0; k < disk.atlas.charts.size(); ++k) {
        const Chart &x = disk.atlas.charts[k], &y = klein.atlas.charts[k];
        ASSERT_EQ(x.vertices, y.vertices);
        for (std::size_t i = 0; i < x.vertices.size(); ++i) {
            const double square = x.point[2 * i] * x.point[2 * i] + x.point[2 * i + 1] * x.point[2 * i + 1];
            for (std::size_t n = 2 * i; n < 2 * i + 2; ++n)
                EXPECT_NEAR(2 * x.point[n] / (1 + square), y.point[n], 1e-14);
        }
        for (const Index f : x.faces)
            for (Index h = 3 * f; h < 3 * f + 3; ++h) {
                const auto place = [&](Index v) {
                    const auto i = static_cast<std::size_t>(
                        std::lower_bound(x.vertices.begin(), x.vertices.end(), v) - x.vertices.begin());
                    return std::array<double, 2>{x.point[2 * i], x.point[2 * i + 1]};
                };
                const auto p = place(c.tail[at(h)]), q = place(c.head(h));
                const double apart = std::hypot(q[0] - p[0], q[1] - p[1]),
                             scale =
                                 std::sqrt((1 - p[0] * p[0] - p[1] * p[1]) * (1 - q[0] * q[0] - q[1] * q[1]));
                // sinh(d/2) = |z - w| / sqrt((1 - |z|^2)(1 - |w|^2)); metric to 1e-10 and a little.
                EXPECT_NEAR(2 * std::asinh(apart / scale), side, 1e-8);
            }
    }
    for (const Transition& t : disk.atlas.transitions) {
        // The Moebius map and the matrix say the same: at (0.3, -0.4), Klein (0.48, -0.64).
        const auto z = apply_transition(AtlasKind::hyperbolic, t, {0.3, -0.4, 0.0}),
                   k = apply_transition(AtlasKind::projective, t, {0.48, -0.64, 0.0});
        const double square = z[0] * z[0] + z[1] * z[1];
        EXPECT_NEAR(2 * z[0] / (1 + square), k[0], 1e-12);
        EXPECT_NEAR(2 * z[1] / (1 + square), k[1], 1e-12);
    }
}

TEST(Atlas, ChecksSeeWhatIsBroken) {
    const Made m = make(generated("eight", 900), AtlasKind::projective);
    const CommonRefinement& r = m.solved.refinement;
    {
        Atlas broken = m.atlas;
        broken.transitions[0].matrix[0] += 1e-3;
        const AtlasChecks checks = check_atlas(r, broken, {});
        EXPECT_GT(checks.form_error, 1e-4);
        EXPECT_GT(checks.circle_error, 1e-5);
        EXPECT_GT(checks.vertex_disagreement, 1e-6);
        EXPECT_GT(checks.cocycle_error, 1e-4);
    }
    {
        Atlas broken = m.atlas;
        const Transition& t = broken.transitions[0];
        ASSERT_GT(t.pieces.size(), 1U);
        Chart& chart = broken.charts[at(t.to)];
        const auto found = std::lower_bound(chart.pieces.begin(), chart.pieces.end(), t.pieces.back());
        chart.frame[static_cast<std::size_t>(found - chart.pieces.begin())].b.re += 1e-3;
        EXPECT_GT(check_atlas(r, broken, {}).edge_disagreement, 1e-5);
    }
    {
        // Without its first chart something lies open.
        Atlas broken = m.atlas;
        broken.charts[0].pieces.resize(1);
        broken.transitions.clear();
        const AtlasChecks checks = check_atlas(r, broken, {});
        EXPECT_GT(checks.uncovered_vertices, 0);
        EXPECT_GT(checks.uncovered_sides, 0);
    }
    {
        // The whole surface is no disk.
        Atlas broken = m.atlas;
        broken.transitions.clear();
        broken.charts[0].pieces.clear();
        for (Index p = 0; p < r.piece_count(); ++p) broken.charts[0].pieces.push_back(p);
        EXPECT_EQ(check_atlas(r, broken, {}).not_disks, 1);
    }
}

TEST(Atlas, HyperbolicChartsDoNotReachFar) {
    // Four patches for an area of 36 pi would reach farther.
    const Made m = make(generated("genus-g", 1500, 10), AtlasKind::hyperbolic, {}, 4);
    expect_whole(m);
    const Connectivity& c = m.mesh.connectivity;
    for (const Chart& chart : m.atlas.charts) {
        if (chart.radius <= 5.0) continue;
        // Then it is the star of a vertex and nothing else.
        const bool star = std::any_of(chart.vertices.begin(), chart.vertices.end(), [&](Index v) {
            return static_cast<std::size_t>(std::count(c.tail.begin(), c.tail.end(), v)) ==
                   chart.faces.size();
        });
        EXPECT_TRUE(star) << chart.radius;
    }
}

TEST(Atlas, TheSameEveryTime) {
    const SurfaceMesh mesh = generated("pants", 600);
    const Made x = make(mesh, AtlasKind::hyperbolic), y = make(mesh, AtlasKind::hyperbolic);
    ASSERT_EQ(x.atlas.charts.size(), y.atlas.charts.size());
    for (std::size_t k = 0; k < x.atlas.charts.size(); ++k) {
        EXPECT_EQ(x.atlas.charts[k].pieces, y.atlas.charts[k].pieces);
        EXPECT_EQ(x.atlas.charts[k].point, y.atlas.charts[k].point);
    }
    ASSERT_EQ(x.atlas.transitions.size(), y.atlas.transitions.size());
    for (std::size_t k = 0; k < x.atlas.transitions.size(); ++k)
        EXPECT_EQ(x.atlas.transitions[k].matrix, y.atlas.transitions[k].matrix);
}

TEST(Atlas, TooCoarseATriangulationIsReported) {
    // The star of the only vertex meets itself.
    const SurfaceMesh mesh = testing::intrinsic_mesh(testing::one_vertex_torus(1.0, 1.1, 1.3));
    const CommonRefinement r = make_common_refinement(mesh, std::vector<double>{0.0}, false, true);
    const Atlas atlas = make_atlas(mesh.connectivity, r, make_final_metric(0, r), {});
    EXPECT_EQ(atlas.uncovered, std::vector<Index>{0});
}

TEST(Atlas, RejectsWhatDoesNotFit) {
    const SurfaceMesh mesh = testing::bumpy_torus(6, 6);
    const testing::Solved s = testing::solved(mesh);
    const auto attempt = [&](const AtlasOptions& options) {
        return make_atlas(mesh.connectivity, s.refinement, s.metric, options);
    };
    EXPECT_THROW(attempt({AtlasKind::hyperbolic, 0, 2, {}}), std::invalid_argument);
    EXPECT_THROW(attempt({AtlasKind::affine, -1, 2, {}}), std::invalid_argument);
    EXPECT_THROW(attempt({AtlasKind::affine, 0, -1, {}}), std::invalid_argument);
    EXPECT_THROW(attempt({AtlasKind::affine, 0, 2, {36}}), std::invalid_argument);
    EXPECT_THROW(attempt({AtlasKind::affine, 0, 2, {-1}}), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
