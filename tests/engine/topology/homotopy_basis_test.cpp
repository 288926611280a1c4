#include "engine/topology/homotopy_basis.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <queue>
#include <stdexcept>

#include "tests/engine/topology/topology_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::basis_of;
using testing::Random;
using testing::test_surfaces;
using testing::TestSurface;

double length_of(const EdgePath& path, std::span<const double> length) {
    double sum = 0;
    for (const Step s : path) sum += length[at(halfedge_of(s))];
    return sum;
}

/// The boundary of a face read corner by corner: cones' letters included.
Word face_word(const HomotopyBasis& basis, Index f) {
    Word word;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        append_reduced(word, basis.word_of(h));
        for (std::size_t i = 0; i < basis.cones().size(); ++i) {
            const auto letter = basis.loops() + basis.boundaries() + static_cast<Index>(i) + 1;
            if (basis.cone_halfedge(static_cast<Index>(i)) == h) append_reduced(word, Word{-letter});
        }
    }
    return word;
}

TEST(HomotopyBasis, CountsLoopsAndPunctures) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const HomotopyBasis basis = basis_of(surface);
        const Topology topology = topology_of(surface.connectivity);
        EXPECT_EQ(basis.genus(), topology.genus);
        EXPECT_EQ(basis.loops(), 2 * topology.genus);
        EXPECT_EQ(basis.boundaries(), topology.boundaries);
        EXPECT_EQ(basis.letter_names().size(), at(basis.letters()));
        EXPECT_EQ(basis.relator().size(), at(2 * basis.loops() + basis.punctures()));
        for (Index letter = 1; letter <= basis.letters(); ++letter) {
            const bool cone = letter > basis.loops() + basis.boundaries();
            EXPECT_EQ(std::ranges::count(basis.relator(), letter), cone ? 0 : 1);
            EXPECT_EQ(std::ranges::count(basis.relator(), -letter), cone || letter <= basis.loops() ? 1 : 0);
        }
        EXPECT_EQ(cyclically_reduced(basis.relator()), basis.relator());
    }
}

TEST(HomotopyBasis, LoopsCloseAtTheBaseAndReadTheirLetter) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const HomotopyBasis basis = basis_of(surface);
        double longest = 0;
        for (Index k = 0; k < basis.loops() + basis.boundaries(); ++k) {
            const EdgePath path = basis.loop_path(k);
            EXPECT_EQ(step_tail(surface.connectivity, path.front()), basis.base());
            EXPECT_EQ(step_head(surface.connectivity, path.back()), basis.base());
            EXPECT_EQ(basis.word_of_path(path), Word{k + 1});
            if (k >= basis.loops()) continue;
            // The loops come by length; sums along them round differently from the order's keys.
            EXPECT_GE(length_of(path, surface.length), longest * (1 - 1e-12));
            longest = length_of(path, surface.length);
        }
    }
}

TEST(HomotopyBasis, EveryFaceButTheRootIsTrivialAndTheRootReadsTheRelator) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const HomotopyBasis basis = basis_of(surface);
        EXPECT_EQ(face_word(basis, 0), basis.relator());
        for (Index f = 1; f < surface.connectivity.face_count(); ++f)
            EXPECT_EQ(face_word(basis, f), Word{}) << "face " << f;
    }
}

TEST(HomotopyBasis, TwinsAreInverseAndTreeEdgesTrivial) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const Connectivity& c = surface.connectivity;
        const HomotopyBasis basis = basis_of(surface);
        for (Index h = 0; h < c.halfedge_count(); ++h)
            EXPECT_EQ(basis.word_of(reversed_step(c, h)), inverse(basis.word_of(h)));
        for (Index v = 0; v < c.vertex_count; ++v)
            for (const Step s : basis.tree_path(v)) EXPECT_EQ(basis.word_of(s), Word{});
    }
}

TEST(HomotopyBasis, WalksReadTheirWord) {
    Random random(11);
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const HomotopyBasis basis = basis_of(surface);
        const Index letters = basis.loops() + basis.boundaries();  // a cone's circle is no edge path
        for (int trial = 0; trial < 20 && letters > 0; ++trial) {
            Word word;
            for (Index i = random.below(8); i >= 0; --i)
                word.push_back((random.below(letters) + 1) * (random.below(2) == 0 ? 1 : -1));
            const EdgePath path = basis.walk(word);
            EXPECT_EQ(basis.word_of_path(path), reduced(word));
            for (std::size_t i = 0; i + 1 < path.size(); ++i)
                EXPECT_NE(reversed_step(surface.connectivity, path[i]), path[i + 1]) << "backtracking";
        }
    }
}

TEST(HomotopyBasis, ABoundaryOfADiskIsItsRelator) {
    const SurfaceMesh mesh = testing::wavy_square(4);
    const HomotopyBasis basis = make_homotopy_basis(mesh.connectivity, mesh.edge_length);
    EXPECT_EQ(basis.relator(), Word{1});
    EXPECT_EQ(basis.boundary_walk(0).size(), 16u);
}

/// The walk around v along the edges opposite to it, counterclockwise from the tail of its tree edge.
EdgePath link_walk(const Connectivity& c, Index tree_halfedge) {
    EdgePath path;
    const Index first = c.twin[at(tree_halfedge)];
    for (Index h = first; path.empty() || h != first; h = c.twin[at(prev_halfedge(h))])
        path.push_back(next_halfedge(h));
    return path;
}

TEST(HomotopyBasis, TheLinkOfAConeReadsItsLetter) {
    for (const char* name : {"sphere", "torus", "eight", "pants", "klein-quartic"}) {
        SCOPED_TRACE(name);
        GenerateOptions options;
        options.faces = 600;
        const SurfaceMesh mesh = generate(name, options);
        const Connectivity& c = mesh.connectivity;
        const std::vector<std::uint8_t> boundary = boundary_vertices(c);
        for (Index v = 0; v < c.vertex_count; ++v) {
            if (boundary[at(v)] != 0) continue;
            const Index base = v == c.tail[0] ? c.head(0) : c.tail[0];
            const HomotopyBasis basis =
                make_homotopy_basis(c, mesh.edge_length, {.base = base, .cones = {v}});
            const Index letter = basis.loops() + basis.boundaries() + 1;
            const Word around = basis.word_of_path(link_walk(c, basis.cone_halfedge(0)));
            // Face 0 stands for the relation among the letters: around it words agree up to that only.
            const Word difference = product(around, Word{-letter});
            ASSERT_TRUE(difference.empty() || (c.tail[0] == v || c.tail[1] == v || c.tail[2] == v)) << v;
            if (difference.empty()) continue;
            ASSERT_TRUE(are_conjugate(difference, basis.relator()) ||
                        are_conjugate(difference, inverse(basis.relator())))
                << "cone " << v;
        }
    }
}

TEST(HomotopyBasis, LoopsGenerateTheHomologyOfTheClosedSurface) {
    // Exponents of the letters, against crossings: each loop's intersections with a random walk follow
    // from the walk's word and the loops' own intersections.
    Random random(13);
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const Connectivity& c = surface.connectivity;
        const HomotopyBasis basis = basis_of(surface);
        if (!surface.cones.empty()) continue;  // the words do not see them in homology
        const testing::Intersections intersections(c);
        const VertexStars stars = vertex_stars(c);
        EdgePath walk;
        Index here = basis.base();
        for (int i = 0; i < 60; ++i) {
            const auto leaving = stars.leaving(here);
            walk.push_back(leaving[random.below(leaving.size())]);
            here = step_head(c, walk.back());
        }
        const EdgePath home = reversed_path(c, basis.tree_path(here));
        walk.insert(walk.end(), home.begin(), home.end());
        const Word word = basis.word_of_path(walk);
        for (Index k = 0; k < basis.loops(); ++k) {
            Index expected = 0;
            for (const Index letter : word) {
                const EdgePath loop = basis.loop_path(generator_of(letter));
                expected += (letter > 0 ? 1 : -1) * intersections.number(basis.loop_path(k), loop);
            }
            EXPECT_EQ(intersections.number(basis.loop_path(k), walk), expected) << "loop " << k;
        }
    }
}

/// Torus grid n x m: how far a halfedge moves in rows and columns.
std::array<Index, 2> displacement(const Connectivity& c, Index h, Index n, Index m) {
    const auto wrapped = [](Index difference, Index period) {
        return difference > 1 ? difference - period : (difference < -1 ? difference + period : difference);
    };
    const Index v = c.tail[at(h)], w = c.head(h);
    return {wrapped(w / m - v / m, n), wrapped(w % m - v % m, m)};
}

struct CoverPoint {
    double distance;
    Index row, column;  // in the plane
    bool operator>(const CoverPoint& other) const { return distance > other.distance; }
};

/// Lengths of the shortest walks from vertex 0 to its translates by (p n, q m), |p|, |q| <= 2, by Dijkstra's
/// algorithm in the plane. [p + 2][q + 2]
std::array<std::array<double, 5>, 5> shortest_translations(const SurfaceMesh& mesh, Index n, Index m) {
    const Connectivity& c = mesh.connectivity;
    const Index rows = 8 * n + 1, columns = 8 * m + 1;  // room to leave the translates' hull and return
    const auto place = [&](Index i, Index j) { return at((i + 4 * n) * columns + j + 4 * m); };
    std::vector<double> d(at(rows * columns), 1e300);
    std::priority_queue<CoverPoint, std::vector<CoverPoint>, std::greater<>> queue;
    queue.push({0.0, 0, 0});
    d[place(0, 0)] = 0;
    while (!queue.empty()) {
        const CoverPoint p = queue.top();
        queue.pop();
        if (p.distance > d[place(p.row, p.column)]) continue;
        const Index v = (p.row + 4 * n) % n * m + (p.column + 4 * m) % m;
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            if (c.tail[at(h)] != v) continue;
            const auto [di, dj] = displacement(c, h, n, m);
            const Index i = p.row + di, j = p.column + dj;
            if (std::abs(i) > 4 * n || std::abs(j) > 4 * m) continue;
            const double reached = p.distance + mesh.edge_length[at(h)];
            if (reached >= d[place(i, j)]) continue;
            d[place(i, j)] = reached;
            queue.push({reached, i, j});
        }
    }
    std::array<std::array<double, 5>, 5> shortest{};
    for (Index p = -2; p <= 2; ++p)
        for (Index q = -2; q <= 2; ++q) shortest[at(p + 2)][at(q + 2)] = d[place(p * n, q * m)];
    return shortest;
}

TEST(HomotopyBasis, IsTheShortestOnATorus) {
    // On a torus homotopy is displacement; two loops are a basis where their displacements have determinant
    // +-1. The bumps are large, so that the longer class (2, 0) and the like cost more: |p|, |q| <= 2 is
    // enough.
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        const Index n = 4, m = 3;
        const SurfaceMesh mesh = testing::bumpy_torus(n, m, 0.6, seed);
        const auto shortest = shortest_translations(mesh, n, m);
        double least = 1e300;
        for (Index p = -2; p <= 2; ++p)
            for (Index q = -2; q <= 2; ++q)
                for (Index r = -2; r <= 2; ++r)
                    for (Index s = -2; s <= 2; ++s)
                        if (std::abs(p * s - q * r) == 1)
                            least = std::min(least,
                                             shortest[at(p + 2)][at(q + 2)] + shortest[at(r + 2)][at(s + 2)]);
        const HomotopyBasis basis =
            make_homotopy_basis(mesh.connectivity, mesh.edge_length, {.base = 0, .cones = {}});
        const double found =
            length_of(basis.loop_path(0), mesh.edge_length) + length_of(basis.loop_path(1), mesh.edge_length);
        EXPECT_NEAR(found, least, 1e-12 * least);  // sums of a dozen lengths in another order
    }
}

TEST(HomotopyBasis, IsTheSameEveryTime) {
    for (const TestSurface& surface : test_surfaces()) {
        const HomotopyBasis first = basis_of(surface), second = basis_of(surface);
        EXPECT_EQ(first.base(), second.base());
        EXPECT_EQ(first.relator(), second.relator());
    }
}

TEST(HomotopyBasis, RefusesWhatItCannotUse) {
    const SurfaceMesh mesh = testing::wavy_square(3);
    const Connectivity& c = mesh.connectivity;
    const std::vector<double>& length = mesh.edge_length;
    const auto make = [&](Index base, std::vector<Index> cones) {
        return make_homotopy_basis(c, length, {.base = base, .cones = std::move(cones)});
    };
    EXPECT_NO_THROW(make(5, {6}));
    EXPECT_THROW(make(-2, {}), std::invalid_argument);
    EXPECT_THROW(make(16, {}), std::invalid_argument);
    EXPECT_THROW(make(5, {5}), std::invalid_argument);
    EXPECT_THROW(make(5, {6, 6}), std::invalid_argument);
    EXPECT_THROW(make(5, {16}), std::invalid_argument);
    EXPECT_THROW(make(5, {0}), std::invalid_argument) << "on the boundary";
    EXPECT_THROW(make_homotopy_basis(c, std::span(length).first(3), {}), std::invalid_argument);
    std::vector<double> zero = length;
    zero[4] = 0;
    EXPECT_THROW(make_homotopy_basis(c, zero), std::invalid_argument);
    const HomotopyBasis basis = make(5, {});
    EXPECT_THROW((void)basis.word_of_path(EdgePath{0, 1}), std::invalid_argument) << "not closed";
    EXPECT_EQ(basis.word_of_path(EdgePath{}), Word{});
}

TEST(HomotopyBasis, RefusesTwoComponentsButNotUnusedVertices) {
    const std::vector<Triangle> two = {{0, 1, 2}, {4, 5, 6}}, one = {{0, 1, 2}};
    const Connectivity apart = build_connectivity(two, 7), unused = build_connectivity(one, 7);
    const std::vector<double> ones(6, 1.0);
    EXPECT_THROW(make_homotopy_basis(apart, ones), std::invalid_argument);
    EXPECT_THROW(make_homotopy_basis(unused, std::span(ones).first(3), {.base = 3, .cones = {}}),
                 std::invalid_argument);
    EXPECT_EQ(make_homotopy_basis(unused, std::span(ones).first(3)).relator(), Word{1});
    const Connectivity empty = build_connectivity({}, 3);
    EXPECT_THROW(make_homotopy_basis(empty, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
