// Flips, removals and splits leave a smooth surface as it is: angle sums, area, topology, lengths,
// directions.
#include "engine/shape_space/thinning.h"

#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::generated;
using testing::hyperbolic_angle;
using testing::Random;
using testing::smooth_triangulation;

constexpr double kPi = std::numbers::pi;

std::vector<Index> alive_halfedges(const Thinning& t) {
    std::vector<Index> halfedges;
    for (Index h = 0; h < t.connectivity().halfedge_count(); ++h)
        if (t.alive(face_of(h))) halfedges.push_back(h);
    return halfedges;
}

Index vertices_left(const Thinning& t) {
    Index count = 0;
    for (Index v = 0; v < t.connectivity().vertex_count; ++v) count += t.outgoing(v) != kNoTwin ? 1 : 0;
    return count;
}

double angle_at(const Thinning& t, Index h) {
    return hyperbolic_angle(t.half_chord(h), t.half_chord(prev_halfedge(h)), t.half_chord(next_halfedge(h)));
}

/// Half chords of all edges, ascending.
std::vector<double> edges_of(const Thinning& t) {
    std::vector<double> edges;
    for (const Index h : alive_halfedges(t))
        if (h > t.connectivity().twin[at(h)]) edges.push_back(t.half_chord(h));
    std::sort(edges.begin(), edges.end());
    return edges;
}

/// Everything about gluing, angles and directions that must hold at any time. Angles are taken from lengths
/// alone.
void expect_sound(const Thinning& t, Index euler_characteristic, double tolerance) {
    const Connectivity& c = t.connectivity();
    std::vector<double> sum(at(c.vertex_count), 0.0);
    std::vector<std::uint8_t> boundary(sum.size(), 0);
    Index halves = 0, rims = 0, faces = 0;
    double area = 0;
    for (const Index h : alive_halfedges(t)) {
        const Index w = c.twin[at(h)], v = c.tail[at(h)];
        const double angle = angle_at(t, h);
        ASSERT_NEAR(std::atan2(t.angle(h).im, t.angle(h).re), angle, tolerance);
        sum[at(v)] += angle;
        area -= angle;
        faces += h % 3 == 0 ? 1 : 0;
        ++halves;
        if (w == kNoTwin) {
            ++rims;
            boundary[at(v)] = 1;
            ASSERT_EQ(t.outgoing(v), h) << "the boundary's halfedge comes first";
        } else {
            ASSERT_TRUE(t.alive(face_of(w)));
            ASSERT_EQ(c.twin[at(w)], h);
            ASSERT_EQ(c.tail[at(w)], c.head(h));
            ASSERT_NEAR(t.half_chord(h), t.half_chord(w), 1e-12 * (1 + t.half_chord(h)));
            ASSERT_EQ(c.edge[at(h)], c.edge[at(w)]);
            // Counterclockwise from w is what follows h: its tail is where w starts.
            const double turned =
                t.direction(w) - t.direction(next_halfedge(h)) - angle_at(t, next_halfedge(h));
            ASSERT_NEAR(std::remainder(turned, 2 * kPi), 0.0, tolerance);
        }
    }
    area += kPi * faces;
    EXPECT_NEAR(area, -2 * kPi * euler_characteristic, tolerance * faces);
    EXPECT_EQ(vertices_left(t) - (halves + rims) / 2 + faces, euler_characteristic);
    for (Index v = 0; v < c.vertex_count; ++v) {
        const Index out = t.outgoing(v);
        if (out == kNoTwin) {
            ASSERT_EQ(sum[at(v)], 0.0) << "a removed vertex has corners";
            continue;
        }
        ASSERT_TRUE(t.alive(face_of(out)));
        ASSERT_EQ(c.tail[at(out)], v);
        ASSERT_NEAR(sum[at(v)], boundary[at(v)] ? kPi : 2 * kPi, tolerance);
        if (!boundary[at(v)]) continue;
        ASSERT_EQ(t.direction(out), 0.0);
    }
}

Index characteristic(const HyperbolicTriangulation& fine) {
    return topology_of(fine.connectivity).euler_characteristic;
}

/// The same surface with edges flipped at random, as far as quadrilaterals are convex by a margin of 0.2.
HyperbolicTriangulation flipped_at_random(HyperbolicTriangulation fine, int flips, std::uint64_t seed) {
    Random random(seed);
    Connectivity& c = fine.connectivity;
    std::vector<double> log_chord;
    for (const double s : fine.half_chord) log_chord.push_back(std::log(s));
    const auto chord = [&](Index h) { return std::exp(log_chord[at(h)]); };
    const auto angle = [&](Index h) {
        return hyperbolic_angle(chord(h), chord(prev_halfedge(h)), chord(next_halfedge(h)));
    };
    for (int k = 0; k < flips; ++k) {
        const Index h = random.below(c.halfedge_count()), w = c.twin[at(h)];
        if (w == kNoTwin || !flippable(c, h)) continue;
        const double tail = angle(h) + angle(next_halfedge(w)), head = angle(next_halfedge(h)) + angle(w);
        if (std::max(tail, head) > kPi - 0.2) continue;
        const double a = 2 * std::asinh(chord(prev_halfedge(h))), b = 2 * std::asinh(chord(next_halfedge(w)));
        const double s = std::sinh((a - b) / 2), sine = std::sin(tail / 2);
        const double square = s * s + std::sinh(a) * std::sinh(b) * sine * sine;
        flip_edge<double>(c, log_chord, h, std::log(square) / 2);
    }
    for (std::size_t h = 0; h < log_chord.size(); ++h) fine.half_chord[h] = std::exp(log_chord[h]);
    return fine;
}

struct Case {
    std::string name;
    SurfaceMesh mesh;
    std::size_t left;  // at most so many vertices cannot be removed: one, or one for each boundary; on the
                       // most symmetric surface flat quadrilaterals stand in the way of more
};
std::vector<Case> cases() {
    std::vector<Case> all;
    all.push_back({"eight", generated("eight", 400, 0.4), 1});
    all.push_back({"genus 3", generated("genus-g", 600, 0.3, 3), 1});
    all.push_back({"pants", generated("pants", 300, 0.4), 3});
    all.push_back({"genus 2, one boundary", generated("genus-g-one-boundary", 500, 0.4), 1});
    all.push_back({"bolza, loops", testing::scrambled(make_bolza(), 200, 3), 3});
    all.push_back({"klein quartic, loops", testing::scrambled(make_klein_quartic(), 300, 4), 1});
    return all;
}

TEST(Thinning, DelaunayIsFoundAgainFromAnyTriangulation) {
    for (const Case& item : cases()) {
        SCOPED_TRACE(item.name);
        const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
        Thinning plain(fine), other(flipped_at_random(fine, 3000, 5));
        const std::vector<double> before = edges_of(other);
        plain.make_delaunay();
        other.make_delaunay();
        expect_sound(plain, characteristic(fine), 1e-9);
        expect_sound(other, characteristic(fine), 1e-9);
        if (item.mesh.intrinsic()) continue;  // so symmetric that Delaunay is not unique
        const std::vector<double> x = edges_of(plain), y = edges_of(other);
        ASSERT_EQ(x.size(), y.size());
        double changed = 0;
        for (std::size_t k = 0; k < x.size(); ++k) {
            ASSERT_NEAR(x[k], y[k], 1e-9);
            changed = std::max(changed, std::abs(x[k] - before[k]));
        }
        EXPECT_GT(changed, 0.01) << "nothing was flipped to begin with";
    }
}

TEST(Thinning, RemovalKeepsTheSurfaceDownToTheLastVertex) {
    for (const Case& item : cases())
        for (const std::uint64_t seed : {1, 2}) {
            SCOPED_TRACE(item.name);
            const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
            Thinning t(fine);
            t.make_delaunay();
            Random random(seed);
            // Twice, since a vertex may be freed by what goes after it.
            for (int round = 0; round < 2; ++round) {
                int count = 0;
                for (const Index v : random.permutation(fine.connectivity.vertex_count)) {
                    const Index before = vertices_left(t);
                    const bool there = t.outgoing(v) != kNoTwin, gone = t.remove(v);
                    ASSERT_EQ(vertices_left(t), before - (gone ? 1 : 0));
                    ASSERT_TRUE(there || !gone);
                    ASSERT_EQ(t.outgoing(v) != kNoTwin, there && !gone);
                    // Every 20th, and when few are left and the gluing is full of loops.
                    if (++count % 20 == 0 || before < 8) {
                        expect_sound(t, characteristic(fine), 1e-9);
                        if (HasFailure()) return;
                    }
                }
            }
            EXPECT_LE(static_cast<std::size_t>(vertices_left(t)), item.left);
            expect_sound(t, characteristic(fine), 1e-9);
            for (Index v = 0; v < fine.connectivity.vertex_count; ++v) EXPECT_FALSE(t.remove(v));
        }
}

TEST(Thinning, SplitsKeepTheSurface) {
    for (const Case& item : cases()) {
        SCOPED_TRACE(item.name);
        const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
        Thinning t(fine);
        t.make_delaunay();
        for (Index v = 0; v < fine.connectivity.vertex_count; ++v) t.remove(v);
        Random random(7);
        for (int k = 0; k < 60; ++k) {
            const std::vector<Index> halfedges = alive_halfedges(t);
            const Index before = t.connectivity().vertex_count, h = halfedges[random.below(halfedges.size())];
            const bool boundary = t.connectivity().twin[at(h)] == kNoTwin;
            t.split(h);
            ASSERT_EQ(t.connectivity().vertex_count, before + 1);
            ASSERT_NE(t.outgoing(before), kNoTwin);
            EXPECT_EQ(t.reference(before), kNoTwin);
            EXPECT_EQ(t.connectivity().twin[at(t.outgoing(before))] == kNoTwin, boundary);
            expect_sound(t, characteristic(fine), 1e-9);
            if (HasFailure()) return;
        }
        // What was put in can be taken out.
        for (Index v = fine.connectivity.vertex_count; v < t.connectivity().vertex_count; ++v) t.remove(v);
        for (Index v = 0; v < t.connectivity().vertex_count; ++v) t.remove(v);
        EXPECT_LE(static_cast<std::size_t>(vertices_left(t)), item.left);
        expect_sound(t, characteristic(fine), 1e-9);
    }
}

TEST(Thinning, RadiusIsLimited) {
    for (const Case& item : cases())
        for (const double largest : {1.1, 0.9, 0.7}) {
            SCOPED_TRACE(item.name);
            const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
            Thinning t(fine);
            t.make_delaunay();
            for (Index v = 0; v < fine.connectivity.vertex_count; ++v) t.remove(v);
            t.limit_radius(largest);
            for (Index f = 0; f < t.connectivity().face_count(); ++f)
                if (t.alive(f)) {
                    ASSERT_LE(t.covering_radius(f), largest);
                }
            expect_sound(t, characteristic(fine), 1e-9);
        }
}

TEST(Thinning, CoveringRadiusCovers) {
    // Faces of a few vertices: acute ones, whose circumcentre has no nearer corner, and obtuse ones.
    Index acute = 0, obtuse = 0;
    for (const Case& item : cases()) {
        SCOPED_TRACE(item.name);
        const HyperbolicTriangulation fine = smooth_triangulation(item.mesh);
        Thinning t(fine);
        for (Index v = 0; v < fine.connectivity.vertex_count; v += 2) t.remove(v);
        for (Index f = 0; f < t.connectivity().face_count(); ++f) {
            if (!t.alive(f)) continue;
            const std::vector<double> sides{t.half_chord(3 * f), t.half_chord(3 * f + 1),
                                            t.half_chord(3 * f + 2)};
            const auto corner = make_final_metric<double>(-1, sides).corners(0);
            double farthest = 0;
            constexpr int kSteps = 24;
            for (int i = 0; i <= kSteps; ++i)
                for (int j = 0; i + j <= kSteps; ++j) {
                    const auto x = testing::mixed(corner, i / double{kSteps}, j / double{kSteps});
                    double nearest = 1e300;
                    for (const auto& p : corner) nearest = std::min(nearest, testing::distance(-1, x, p));
                    farthest = std::max(farthest, nearest);
                }
            const double radius = t.covering_radius(f);
            ASSERT_LE(farthest, radius * (1 + 1e-9));
            const double a = angle_at(t, 3 * f), b = angle_at(t, 3 * f + 1), c = angle_at(t, 3 * f + 2);
            if (2 * std::max({a, b, c}) > a + b + c) {
                ++obtuse;
            } else {
                ++acute;
                ASSERT_GE(farthest, 0.93 * radius) << "larger than need be";
            }
        }
    }
    EXPECT_GT(acute, 100);
    EXPECT_GT(obtuse, 100);
}

}  // namespace
}  // namespace ricci
