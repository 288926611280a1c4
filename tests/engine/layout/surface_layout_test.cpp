#include "engine/layout/surface_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "engine/surfaces/regular_map.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::frame_at;
using testing::position_of;
using testing::structure_of;
using Vector = std::array<double, 3>;

/// Difference of two vectors: between d and sqrt(2) t d for points at distance d near (x, t).
double gap(const Vector& p, const Vector& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// Three layouts from different first faces are one figure in three places (thesis, Table 10).
void expect_one_figure(const SurfaceMesh& mesh) {
    StructureOptions options;
    options.flow.tolerance = 1e-12;
    const SurfaceStructure s = structure_of(mesh, options);
    const CommonRefinement& r = *s.refinement;
    const Index faces = mesh.connectivity.face_count();
    for (const Index seed : {Index{0}, faces / 3, faces - 1}) {
        const SurfaceLayout other =
            make_surface_layout(s.kappa, r, mesh.connectivity, *s.basis, s.cut, {.seed_face = seed});
        EXPECT_EQ(r.input_face[at(other.root_piece)], seed);
        EXPECT_LE(other.closing_error, 1e-10);
        ASSERT_EQ(other.corner_vertex, s.layout.corner_vertex);
        // One side of one piece: a long one, and near both origins, where coordinates show directions best.
        Index side = 0;
        const auto merit = [&](Index c) {
            return testing::distance(s.kappa, position_of(s.layout, c), position_of(s.layout, r.next(c))) /
                   (position_of(s.layout, c)[2] * position_of(other, c)[2]);
        };
        for (Index c = 0; c < r.corner_count(); ++c)
            if (merit(c) > merit(side)) side = c;
        const Isometry<double> motion = compose(
            s.kappa, frame_at(s.kappa, position_of(other, side), position_of(other, r.next(side))),
            inverse(frame_at(s.kappa, position_of(s.layout, side), position_of(s.layout, r.next(side)))));
        double worst = 0;
        for (std::size_t v = 0; v < other.position.size(); ++v) {
            const Vector moved = apply(s.kappa, motion, s.layout.position[v]);
            worst = std::max({worst, testing::distance(s.kappa, moved, other.position[v]),
                              gap(moved, other.position[v]) / moved[2]});
        }
        // Frames come by other ways, which differ by the curvatures of 1e-12 that they enclose; that and the
        // rounding of the fitted motion are seen across the domain (e^R is about 150).
        EXPECT_LE(worst, 1e-9);
        for (std::size_t k = 0; k < other.pairings.size(); ++k) {
            const auto moved =
                compose(s.kappa, compose(s.kappa, motion, s.layout.pairings[k].element), inverse(motion));
            EXPECT_NEAR(testing::trace_size(moved), testing::trace_size(other.pairings[k].element),
                        1e-9 * testing::trace_size(moved));
        }
    }
}

TEST(SurfaceLayout, IsOneFigureWhereverItStarts) {
    expect_one_figure(testing::generated("eight", 2000, 0.3));
    expect_one_figure(testing::generated("pants", 1000, 0.3));
    expect_one_figure(testing::generated("torus", 1000, 0.3));
}

TEST(SurfaceLayout, OfTheEightIsOneFigureWhereverItStarts) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight.off");
    expect_one_figure(testing::load_component(path));
}

/// The motion that takes the copy of an input edge on the partner side to that on the side itself.
Isometry<double> pairing_by_edge(const SurfaceStructure& s, const std::vector<Index>& corners) {
    const CommonRefinement& r = *s.refinement;
    const Index first = corners.front(), last = corners.back();
    const Vector &p = position_of(s.layout, first), &q = position_of(s.layout, r.next(last));
    const Vector& p_there = position_of(s.layout, r.next(r.twin[at(first)]));
    const Vector& q_there = position_of(s.layout, r.twin[at(last)]);
    return compose(s.kappa, frame_at(s.kappa, p, q), inverse(frame_at(s.kappa, p_there, q_there)));
}

/// Corners along every input halfedge, in order from its tail.
std::vector<std::vector<Index>> corners_along(const CommonRefinement& r, const Connectivity& c) {
    std::vector<std::map<Index, Index>> by_vertex(c.tail.size());
    for (Index k = 0; k < r.corner_count(); ++k)
        if (r.input_halfedge[at(k)] >= 0) by_vertex[at(r.input_halfedge[at(k)])][r.vertex[at(k)]] = k;
    std::vector<std::vector<Index>> along(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        Index v = c.tail[at(h)];
        for (std::size_t n = 0; n < by_vertex[at(h)].size(); ++n) {
            along[at(h)].push_back(by_vertex[at(h)].at(v));
            v = r.vertex[at(r.next(along[at(h)].back()))];
        }
    }
    return along;
}

TEST(SurfaceLayout, PairsSidesTheSameWayByAnyOfTheirEdges) {
    for (const char* name : {"eight", "genus-g", "torus", "pants"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = testing::generated(name, 1500, 0.3, 3);
        const SurfaceStructure s = structure_of(mesh);
        const auto along = corners_along(*s.refinement, mesh.connectivity);
        EXPECT_FALSE(s.layout.pairings.empty());
        for (const SidePairing& pairing : s.layout.pairings) {
            EXPECT_LE(pairing.spread, 1e-9);
            const std::vector<Index>& chain = s.cut.sides[at(pairing.side)].halfedges;
            for (const std::size_t k : {std::size_t{0}, chain.size() / 2, chain.size() - 1}) {
                const Isometry<double> element = pairing_by_edge(s, along[at(chain[k])]);
                // Seen from the edge, as spreads are: back by the one, there by the other. Short edges (0.02)
                // know their direction to 1e-15 times cosh^2 of the distance, 1e4, over their length.
                const Isometry<double> place =
                    frame_at(s.kappa, position_of(s.layout, along[at(chain[k])].front()),
                             position_of(s.layout, s.refinement->next(along[at(chain[k])].back())));
                const auto difference =
                    compose(s.kappa, inverse(place),
                            compose(s.kappa, compose(s.kappa, element, inverse(pairing.element)), place));
                EXPECT_LE(distance_to_identity(difference), 1e-9);
            }
        }
    }
}

TEST(SurfaceLayout, PairingsOfPartnersAreInverse) {
    const SurfaceMesh mesh = testing::generated("genus-g", 1000, 0.3, 3);
    const SurfaceStructure s = structure_of(mesh);
    std::map<Index, Isometry<double>> element;
    for (const SidePairing& pairing : s.layout.pairings) element[pairing.side] = pairing.element;
    for (const auto& [side, g] : element) {
        const auto product = compose(-1, g, element.at(s.cut.sides[at(side)].partner));
        // Elements reach e^R = 1e3 and more, squared in the product.
        EXPECT_LE(distance_to_identity(product), 1e-9);
    }
}

TEST(SurfaceLayout, PairingsAreElementsOfTheGroup) {
    // A pairing as a word: from the base into the domain, across the side, and back. The letters of a once
    // cut torus are its two translations.
    const SurfaceMesh mesh = testing::generated("eight", 1000, 0.3);
    const SurfaceStructure s = structure_of(mesh);
    // A generator acts on the layout as base_frame g base_frame^-1: it must take each copy of the base vertex
    // to where tessellation has one. All images of the base by letters are images by products of pairings.
    const std::vector<Isometry<double>> copies = tessellate(s.layout, 20000, 12.0);
    const Vector base = image_of_origin(-1, s.layout.base_frame);
    for (const Isometry<double>& letter : s.group.letters) {
        const auto moved =
            compose(-1, compose(-1, s.layout.base_frame, letter), inverse(s.layout.base_frame));
        const Vector image = apply(-1, moved, base);
        double nearest = 1e300;
        for (const Isometry<double>& g : copies) nearest = std::min(nearest, gap(apply(-1, g, base), image));
        EXPECT_LE(nearest, 1e-9 * image[2]);
    }
}

TEST(SurfaceLayout, AnglesAddUpAndPiecesLieTheRightWayRound) {
    for (const char* name :
         {"eight", "genus-g", "torus", "pants", "annulus", "genus-g-one-boundary", "sphere", "disk"}) {
        SCOPED_TRACE(name);
        const SurfaceMesh mesh = testing::generated(name, 800, 0.4, 3);
        const SurfaceStructure s = structure_of(mesh);
        EXPECT_EQ(s.layout.flipped, 0);
        EXPECT_EQ(s.layout.degenerate, 0);
        EXPECT_LE(s.layout.closing_error, 1e-10);
        // Residuals of 1e-10 and, where pieces have sides of 1e-6, directions known to 1e-9.
        testing::expect_flat_angles(*s.refinement, s.layout, 1e-7);
    }
}

TEST(Tessellation, HasNoCopyTwiceAndAllNeighbours) {
    for (const SurfaceMesh& mesh :
         {make_bolza(), make_klein_quartic(), testing::generated("eight", 600, 0.3)}) {
        const SurfaceStructure s = structure_of(mesh);
        const double reach = 2 * s.layout.radius + 1;
        const std::vector<Isometry<double>> copies = tessellate(s.layout, 3000, reach);
        ASSERT_GT(copies.size(), s.layout.pairings.size());
        EXPECT_LE(distance_to_identity(copies.front()), 0.0);
        const auto find = [&](const Isometry<double>& g) {
            std::size_t count = 0;
            for (const Isometry<double>& x : copies)
                // Elements differ by at least the systole: trace 2 + ...; rounding is 1e-16 e^(2 R).
                count += distance_to_identity(compose(-1, inverse(g), x)) < 1e-3 ? 1 : 0;
            return count;
        };
        for (const SidePairing& pairing : s.layout.pairings) {
            const Vector origin = image_of_origin(-1, pairing.element);
            if (std::acosh(origin[2]) < reach) {
                EXPECT_EQ(find(pairing.element), 1u);
            }
        }
        for (std::size_t k = 0; k < copies.size(); k += 7) EXPECT_EQ(find(copies[k]), 1u);
        for (const Isometry<double>& g : copies)
            EXPECT_LE(std::acosh(image_of_origin(-1, g)[2]), reach + 1e-9);
    }
    const SurfaceStructure s = structure_of(make_bolza());
    EXPECT_EQ(tessellate(s.layout, 5, 100.0).size(), 5u);
    EXPECT_EQ(tessellate(s.layout, 1000, 0.0).size(), 1u);
}

TEST(Tessellation, OfATorusFillsItsLattice) {
    const SurfaceMesh mesh = testing::generated("torus", 500, 0.3);
    const SurfaceStructure s = structure_of(mesh);
    std::array<std::complex<double>, 2> w;
    for (std::size_t k = 0; k < 2; ++k) {
        const Vector p = image_of_origin(0, s.group.generators[k].element);
        // The layout is turned against the frame at the base: by the argument of base_frame's a, twice.
        const std::complex<double> turn(s.layout.base_frame.a.re, s.layout.base_frame.a.im);
        w[k] = std::complex<double>(p[0], p[1]) * turn * turn;
    }
    const double radius = 6.0;
    const std::vector<Isometry<double>> copies = tessellate(s.layout, 100000, radius);
    std::size_t points = 0;
    for (int m = -60; m <= 60; ++m)
        for (int n = -60; n <= 60; ++n) points += std::abs(1.0 * m * w[0] + 1.0 * n * w[1]) <= radius ? 1 : 0;
    EXPECT_EQ(copies.size(), points);
    EXPECT_NEAR(static_cast<double>(points), std::numbers::pi * radius * radius, 12.0);  // area 1 each
    const double determinant = (std::conj(w[0]) * w[1]).imag();
    for (const Isometry<double>& g : copies) {
        const Vector p = image_of_origin(0, g);
        const std::complex<double> z(p[0], p[1]);
        const double m = (std::conj(z) * w[1]).imag() / determinant,
                     n = (std::conj(w[0]) * z).imag() / determinant;
        EXPECT_NEAR(m, std::round(m), 1e-9);
        EXPECT_NEAR(n, std::round(n), 1e-9);
    }
}

}  // namespace
}  // namespace ricci
