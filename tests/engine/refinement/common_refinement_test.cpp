#include "engine/refinement/common_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/refinement/null_sides.h"
#include "tests/engine/refinement/refinement_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::NamedMesh;
using testing::Random;

double flat_length(const CommonRefinement& r, Index corner) {
    const auto &p = r.flat[at(corner)], &q = r.flat[at(r.next(corner))];
    return std::hypot(q[0] - p[0], q[1] - p[1]);
}

double longest_edge(const SurfaceMesh& mesh) {
    return *std::max_element(mesh.edge_length.begin(), mesh.edge_length.end());
}

void expect_right_combinatorics(const SurfaceMesh& mesh, const CommonRefinement& r) {
    const Connectivity& c = mesh.connectivity;
    ASSERT_EQ(r.first.size(), at(r.piece_count()) + 1);
    ASSERT_EQ(r.first.back(), r.corner_count());
    EXPECT_EQ(r.input_vertices, c.vertex_count);
    std::vector<std::uint8_t> used(at(r.vertex_count), 0);
    Index edges = 0;
    for (Index p = 0; p < r.piece_count(); ++p) {
        EXPECT_GE(r.first[at(p) + 1] - r.first[at(p)], 3);
        for (Index k = r.first[at(p)]; k < r.first[at(p) + 1]; ++k) {
            EXPECT_EQ(r.piece[at(k)], p);
            const Index v = r.vertex[at(k)], t = r.twin[at(k)], h = r.input_halfedge[at(k)],
                        g = r.final_halfedge[at(k)];
            used[at(v)] = 1;
            edges += t < k ? 1 : 0;
            // A side along neither lies on an edge of the triangulation between the two.
            EXPECT_TRUE(h >= 0 || g >= 0 || (r.isometric_flips > 0 && r.ptolemy_flips > 0));
            if (h >= 0) {
                EXPECT_EQ(face_of(h), r.input_face[at(p)]);
            }
            if (g >= 0) {
                EXPECT_EQ(face_of(g), r.final_face[at(p)]);
            }
            if (t < 0) {
                EXPECT_TRUE(h >= 0 && c.twin[at(h)] == kNoTwin);
                continue;
            }
            EXPECT_EQ(r.twin[at(t)], k);
            EXPECT_EQ(r.vertex[at(t)], r.vertex[at(r.next(k))]);
            EXPECT_EQ(r.vertex[at(r.next(t))], v);
            if (h < 0) {
                EXPECT_EQ(r.input_face[at(r.piece[at(t)])], r.input_face[at(p)]);
            }
            if (g < 0) {
                EXPECT_EQ(r.final_face[at(r.piece[at(t)])], r.final_face[at(p)]);
            }
            EXPECT_EQ(r.input_halfedge[at(t)], h < 0 ? -1 : c.twin[at(h)]);
            EXPECT_EQ(r.final_halfedge[at(t)], g < 0 ? -1 : r.final_triangulation.connectivity.twin[at(g)]);
        }
    }
    const std::vector<std::uint8_t> input_used = used_vertices(c);
    for (std::size_t v = 0; v < input_used.size(); ++v) EXPECT_EQ(used[v], input_used[v]);
    const auto vertices = static_cast<Index>(std::count(used.begin(), used.end(), 1));
    EXPECT_EQ(vertices - edges + r.piece_count(), topology_of(c).euler_characteristic);
}

/// Pieces lie the right way round and fill the input's faces.
void expect_right_areas(const SurfaceMesh& mesh, const CommonRefinement& r, bool whole_final_faces) {
    const PieceAreas areas = piece_areas(r);
    const std::vector<double> face_area = face_areas(mesh);
    std::vector<double> sum(face_area.size(), 0.0);
    std::vector<double> share(at(r.final_triangulation.connectivity.face_count()), 0.0);
    for (Index p = 0; p < r.piece_count(); ++p) {
        // Not even rounding turns a piece over, but it may level one that is thinner than itself.
        EXPECT_GT(areas.flat[at(p)], -areas.flat_rounding[at(p)]);
        EXPECT_GT(areas.final_share[at(p)], -areas.share_rounding[at(p)]);
        sum[at(r.input_face[at(p)])] += areas.flat[at(p)];
        share[at(r.final_face[at(p)])] += areas.final_share[at(p)];
    }
    // Positions are as large as the longest edge and rounded to 1e-16 of it.
    const double longest = longest_edge(mesh);
    for (std::size_t f = 0; f < sum.size(); ++f) EXPECT_NEAR(sum[f], face_area[f], 1e-14 * longest * longest);
    // Weights of corners far apart in scale (e^1.5 per vertex) are rounded one by one.
    for (const double s : share) {
        if (whole_final_faces) {
            EXPECT_NEAR(s, 1.0, 1e-12);
        } else {
            EXPECT_LT(s, 1.0 + 1e-12);
        }
    }
}

/// The sides along every input halfedge follow one another from its tail to its head and are as long as it,
/// in the plane and in space.
void expect_divided_edges(const SurfaceMesh& mesh, const CommonRefinement& r) {
    const Connectivity& c = mesh.connectivity;
    const double tolerance = 1e-14 * longest_edge(mesh);
    std::vector<std::map<Index, Index>> side(c.tail.size());  // per halfedge: corner by its vertex
    for (Index k = 0; k < r.corner_count(); ++k)
        if (r.input_halfedge[at(k)] >= 0) {
            EXPECT_TRUE(side[at(r.input_halfedge[at(k)])].emplace(r.vertex[at(k)], k).second);
        }
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        double sum = 0;
        Index v = c.tail[at(h)];
        for (std::size_t n = 0; n < side[at(h)].size(); ++n) {
            const auto found = side[at(h)].find(v);
            ASSERT_NE(found, side[at(h)].end());
            sum += flat_length(r, found->second);
            v = r.vertex[at(r.next(found->second))];
        }
        EXPECT_EQ(v, c.head(h));
        EXPECT_NEAR(sum, mesh.edge_length[at(h)], tolerance);
    }
    if (mesh.intrinsic()) return;
    ASSERT_EQ(r.points.size(), at(r.vertex_count));
    for (Index v = 0; v < c.vertex_count; ++v) EXPECT_EQ(r.points[at(v)], mesh.points[at(v)]);
    for (Index k = 0; k < r.corner_count(); ++k) {
        const Point &p = r.points[at(r.vertex[at(k)])], &q = r.points[at(r.vertex[at(r.next(k))])];
        EXPECT_NEAR(std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]), flat_length(r, k), tolerance);
    }
}

double sum(const std::array<double, 3>& w) {
    return w[0] + w[1] + w[2];
}

/// Both pieces at a side mean the same point by their weights. The final face's corners are the same vectors
/// up to its frame, so not only up to scale; but the code leaves a factor free.
void expect_equal_weights(const CommonRefinement& r, Index corner, Index other, Index side) {
    const std::array<double, 3>&w = r.weight[at(corner)], &z = r.weight[at(other)];
    for (const double value : w) EXPECT_GE(value, 0.0);
    EXPECT_GT(sum(w), 0.0);
    const Index g = r.final_halfedge[at(side)];
    // The two are computed along different ways, in long double, and rounded once to double.
    constexpr double kTolerance = 1e-14;
    if (g < 0) {
        EXPECT_EQ(r.final_face[at(r.piece[at(corner)])], r.final_face[at(r.piece[at(other)])]);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(w[k] / sum(w), z[k] / sum(z), kTolerance);
        return;
    }
    const Index t = r.final_triangulation.connectivity.twin[at(g)];
    const double tail = w[at(g % 3)], head = w[at(next_halfedge(g) % 3)];
    const double tail_there = z[at(next_halfedge(t) % 3)], head_there = z[at(t % 3)];
    EXPECT_NEAR(tail / (tail + head), tail_there / (tail_there + head_there), kTolerance);
    EXPECT_NEAR(w[at(prev_halfedge(g) % 3)] / sum(w), 0.0, kTolerance);
    EXPECT_NEAR(z[at(prev_halfedge(t) % 3)] / sum(z), 0.0, kTolerance);
}

void expect_agreeing_weights(const CommonRefinement& r) {
    for (Index k = 0; k < r.corner_count(); ++k) {
        const Index t = r.twin[at(k)];
        if (t < k) continue;
        expect_equal_weights(r, k, r.next(t), k);
        expect_equal_weights(r, r.next(k), t, k);
    }
    // A vertex of the input is a corner of the final face.
    for (Index k = 0; k < r.corner_count(); ++k) {
        if (r.vertex[at(k)] >= r.input_vertices) continue;
        const std::array<double, 3>& w = r.weight[at(k)];
        EXPECT_NEAR(*std::max_element(w.begin(), w.end()) / sum(w), 1.0, 1e-15);
        if (r.doubled) continue;
        const auto corner = static_cast<Index>(std::max_element(w.begin(), w.end()) - w.begin());
        EXPECT_EQ(r.final_triangulation.connectivity.tail[at(3 * r.final_face[at(r.piece[at(k)])] + corner)],
                  r.vertex[at(k)]);
    }
}

/// On every piece the map is projective: weights are one linear image of the flat positions (x, y, 1). So
/// what combination of three corners another one is holds for both.
void expect_projective_pieces(const CommonRefinement& r) {
    double worst = 0;
    for (Index p = 0; p < r.piece_count(); ++p) {
        const Index a = r.first[at(p)], end = r.first[at(p) + 1];
        const auto area = [&](Index i, Index j, Index k) {
            const auto &x = r.flat[at(i)], &y = r.flat[at(j)], &z = r.flat[at(k)];
            return (y[0] - x[0]) * (z[1] - x[1]) - (y[1] - x[1]) * (z[0] - x[0]);
        };
        // The widest triangle at the first corner is the basis.
        Index b = a + 1;
        for (Index k = a + 1; k + 1 < end; ++k)
            if (area(a, k, k + 1) > area(a, b, b + 1)) b = k;
        const double whole = area(a, b, b + 1);
        const double extent = std::hypot(r.flat[at(b)][0], r.flat[at(b)][1]) + std::sqrt(whole);
        if (whole < 1e-6 * extent * extent) continue;  // 1e-16 extent^2 / whole is how well corners are known
        for (Index k = a; k < end; ++k) {
            const std::array<double, 3> share = {area(k, b, b + 1) / whole, area(a, k, b + 1) / whole,
                                                 area(a, b, k) / whole};
            for (std::size_t i = 0; i < 3; ++i) {
                const double expected = share[0] * r.weight[at(a)][i] + share[1] * r.weight[at(b)][i] +
                                        share[2] * r.weight[at(b + 1)][i];
                worst = std::max(worst, std::abs(r.weight[at(k)][i] - expected));
            }
        }
    }
    // Weights are 1 at most; corners are known to 1e-10 in the basis.
    EXPECT_LE(worst, 1e-9);
}

void expect_sound(const SurfaceMesh& mesh, const CommonRefinement& r) {
    const bool closed = topology_of(mesh.connectivity).boundaries == 0;
    EXPECT_EQ(check_connectivity(r.final_triangulation.connectivity), std::string());
    expect_right_combinatorics(mesh, r);
    if (::testing::Test::HasFatalFailure()) return;
    expect_right_areas(mesh, r, closed || !r.doubled);
    expect_divided_edges(mesh, r);
    expect_agreeing_weights(r);
    expect_projective_pieces(r);
}

TEST(CommonRefinement, IsSoundOnSurfacesOfEveryKind) {
    std::int64_t isometric = 0, ptolemy = 0;
    Random random(8);
    for (const NamedMesh& surface : testing::refinement_surfaces()) {
        const Connectivity& c = surface.mesh.connectivity;
        for (const double amplitude : {0.0, 0.5, 1.5})
            for (const bool delaunay : {true, false})
                for (const bool doubled : {true, false}) {
                    if (doubled && topology_of(c).boundaries == 0) continue;
                    SCOPED_TRACE(surface.name + ", amplitude " + std::to_string(amplitude) +
                                 (delaunay ? ", delaunay" : "") + (doubled ? ", doubled" : ""));
                    const std::vector<double> u = random.uniforms(at(c.vertex_count), -amplitude, amplitude);
                    const CommonRefinement r = make_common_refinement(surface.mesh, u, doubled, delaunay);
                    EXPECT_EQ(r.doubled, doubled);
                    expect_sound(surface.mesh, r);
                    isometric += r.isometric_flips;
                    ptolemy += r.ptolemy_flips;
                    EXPECT_TRUE(delaunay || r.isometric_flips == 0);
                    EXPECT_EQ(count_non_delaunay<long double>(r.final_triangulation, r.u), 0);
                }
    }
    EXPECT_GT(isometric, 1000);
    EXPECT_GT(ptolemy, 1000);
}

TEST(CommonRefinement, IsTheInputWhereNothingFlips) {
    // Equilateral faces are Delaunay with room to spare.
    for (const SurfaceMesh& mesh : {testing::icosahedron(), make_bolza(), make_klein_quartic()}) {
        const std::vector<double> u(at(mesh.connectivity.vertex_count), 0.7);
        const CommonRefinement r = make_common_refinement(mesh, u, false, true);
        expect_sound(mesh, r);
        EXPECT_EQ(r.piece_count(), mesh.connectivity.face_count());
        EXPECT_EQ(r.vertex_count, mesh.connectivity.vertex_count);
        EXPECT_EQ(r.isometric_flips + r.ptolemy_flips, 0);
    }
}

TEST(CommonRefinement, OfAKeptTriangulationIsTheInput) {
    const SurfaceMesh mesh = testing::bumpy_torus(6, 5, 0.2, 1);
    std::vector<double> log_chord;
    for (const double length : mesh.edge_length) log_chord.push_back(std::log(length) + 0.3);
    const CommonRefinement r = trivial_refinement(mesh, log_chord);
    expect_sound(mesh, r);
    EXPECT_EQ(r.piece_count(), mesh.connectivity.face_count());
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h)
        EXPECT_EQ(static_cast<double>(r.final_triangulation.log_chord[at(h)]), log_chord[at(h)]);
}

/// Numbers that do not depend on how vertices and faces are numbered.
std::vector<std::vector<double>> fingerprint(const CommonRefinement& r) {
    const PieceAreas areas = piece_areas(r);
    std::vector<std::vector<double>> all{areas.flat, areas.final_share, {}, {}, {}};
    for (const Point& p : r.points)
        for (std::size_t k = 0; k < 3; ++k) all[2 + k].push_back(p[k]);
    for (std::vector<double>& values : all) std::sort(values.begin(), values.end());
    return all;
}

TEST(CommonRefinement, DoesNotDependOnNumbers) {
    for (const bool closed : {true, false}) {
        const SurfaceMesh mesh =
            closed ? testing::bumpy_torus(9, 7, 0.25, 4) : testing::wavy_square(7, 0.35, 2);
        const Index vertices = mesh.connectivity.vertex_count;
        Random random(12);
        const std::vector<double> u = random.uniforms(at(vertices), -1, 1);
        const std::vector<Index> number = random.permutation(vertices);
        const SurfaceMesh other = testing::relabelled(mesh, number, random);
        std::vector<double> v(u.size());
        for (std::size_t k = 0; k < u.size(); ++k) v[at(number[k])] = u[k];
        const CommonRefinement a = make_common_refinement(mesh, u, !closed, true),
                               b = make_common_refinement(other, v, !closed, true);
        EXPECT_EQ(a.piece_count(), b.piece_count());
        EXPECT_EQ(a.corner_count(), b.corner_count());
        EXPECT_GT(a.piece_count(), 2 * mesh.connectivity.face_count());
        const auto x = fingerprint(a), y = fingerprint(b);
        for (std::size_t k = 0; k < x.size(); ++k) {
            ASSERT_EQ(x[k].size(), y[k].size());
            // Areas and coordinates of order 1 by other ways of computing: a few roundings.
            for (std::size_t i = 0; i < x[k].size(); ++i) EXPECT_NEAR(x[k][i], y[k][i], 1e-13);
        }
    }
}

TEST(CommonRefinement, AConstantAddedToTheFactorsChangesNothing) {
    const SurfaceMesh mesh = testing::bumpy_torus(7, 6, 0.25, 9);
    Random random(5);
    std::vector<double> u = random.uniforms(at(mesh.connectivity.vertex_count), -1, 1);
    const CommonRefinement a = make_common_refinement(mesh, u, false, true);
    for (double& value : u) value += 7.0;
    const CommonRefinement b = make_common_refinement(mesh, u, false, true);
    EXPECT_EQ(a.vertex, b.vertex);
    EXPECT_EQ(a.twin, b.twin);
    for (std::size_t c = 0; c < a.weight.size(); ++c)
        for (std::size_t k = 0; k < 3; ++k)
            // u + 7 is u rounded to 1e-15.
            EXPECT_NEAR(a.weight[c][k] / sum(a.weight[c]), b.weight[c][k] / sum(b.weight[c]), 1e-14);
}

}  // namespace
}  // namespace ricci
