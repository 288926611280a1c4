// Small surfaces made by hand, for tests that want to see every face.
#pragma once

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "kernels/intrinsic_triangulation.h"
#include "kernels/surface_mesh.h"
#include "tests/support/random.h"

namespace ricci::testing {

inline std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

inline SurfaceMesh octahedron() {
    return make_surface_mesh(
        {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
        std::vector<Triangle>{
            {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

inline std::vector<Triangle> icosahedron_triangles() {
    return {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
            {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
            {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
}

/// Every vertex displaced by up to `noise` in each coordinate.
inline SurfaceMesh icosahedron(double noise = 0.0, std::uint64_t seed = 1) {
    const double t = std::numbers::phi;
    std::vector<Point> points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                                 {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
    Random random(seed);
    for (Point& p : points)
        for (double& x : p) x += random.uniform(-noise, noise);
    return make_surface_mesh(std::move(points), icosahedron_triangles());
}

/// Two triangles per cell of an n x m grid, closed to a torus.
inline std::vector<Triangle> torus_grid(Index n, Index m) {
    std::vector<Triangle> triangles;
    const auto vertex = [n, m](Index i, Index j) { return (i % n) * m + j % m; };
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < m; ++j) {
            triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    return triangles;
}

/// A torus of revolution, R = 2, r = 1, whose vertices are displaced at random: no two of its edges are
/// alike.
inline SurfaceMesh bumpy_torus(Index n, Index m, double noise = 0.05, std::uint64_t seed = 1) {
    Random random(seed);
    std::vector<Point> points;
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < m; ++j) {
            const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
            const double distance = 2 + std::cos(v);
            Point p{distance * std::cos(u), distance * std::sin(u), std::sin(v)};
            for (double& x : p) x += random.uniform(-noise, noise);
            points.push_back(p);
        }
    return make_surface_mesh(std::move(points), torus_grid(n, m));
}

/// A wavy square of n x n cells: a disk with interior and boundary vertices.
inline SurfaceMesh wavy_square(Index n, double noise = 0.0, std::uint64_t seed = 1) {
    Random random(seed);
    std::vector<Point> points;
    for (Index i = 0; i <= n; ++i)
        for (Index j = 0; j <= n; ++j) {
            const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
            points.push_back({x + random.uniform(-noise, noise) / n, y + random.uniform(-noise, noise) / n,
                              0.2 * std::sin(3 * x + 2 * y) + random.uniform(-noise, noise) / n});
        }
    std::vector<Triangle> triangles;
    const auto vertex = [n](Index i, Index j) { return i * (n + 1) + j; };
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) {
            triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    return make_surface_mesh(std::move(points), triangles);
}

/// The surface of a triangulation known by its lengths. `V` input vertices keep their numbers.
template <class Real>
SurfaceMesh intrinsic_mesh(const IntrinsicTriangulation<Real>& triangulation) {
    SurfaceMesh mesh;
    mesh.connectivity = triangulation.connectivity;
    for (const Real log_length : triangulation.log_chord)
        mesh.edge_length.push_back(static_cast<double>(std::exp(log_length)));
    mesh.input_vertex.resize(at(mesh.connectivity.vertex_count));
    std::iota(mesh.input_vertex.begin(), mesh.input_vertex.end(), Index{0});
    return mesh;
}

/// A flat torus with one vertex: both faces have the sides a, b, c.
template <class Real>
IntrinsicTriangulation<Real> one_vertex_torus(Real a, Real b, Real c) {
    IntrinsicTriangulation<Real> t;
    t.connectivity = connectivity_from_gluing({0, 0, 0, 0, 0, 0}, {3, 4, 5, 0, 1, 2}, 1);
    t.log_chord = {std::log(a), std::log(b), std::log(c), std::log(a), std::log(b), std::log(c)};
    return t;
}

/// A sphere of two faces whose outer halfedges are glued to each other within each face: a flip turns the
/// edge between them into the edge between two cones. Face 0: 0 -> 1 (to face 1), 1 -> 2 glued to 2 -> 1 ...
/// see the numbers.
template <class Real>
IntrinsicTriangulation<Real> folded_square(Real diagonal_half) {
    // The square (0, 1, 2, 3) cut along 0-2, each corner fold gluing neighbouring sides: 0-1 with 2-1, 0-3
    // with 2-3. Then 0 and 2 are one vertex and the edge between the faces is a loop.
    IntrinsicTriangulation<Real> t;
    // face 0: 0 -> 1 -> 0' -> 0; face 1: 0 -> 0' -> 2(=old 3) -> 0, with 0' = 0.
    t.connectivity = connectivity_from_gluing({0, 1, 0, 0, 0, 2}, {1, 0, 3, 2, 5, 4}, 3);
    const Real side = std::log(std::sqrt(Real(2)) * diagonal_half), diagonal = std::log(2 * diagonal_half);
    t.log_chord = {side, side, diagonal, diagonal, side, side};
    return t;
}

/// The same surface with its vertices renumbered (old v becomes number[v]) and its faces in another order and
/// rotation.
inline SurfaceMesh relabelled(const SurfaceMesh& mesh, const std::vector<Index>& number, Random& random) {
    std::vector<Point> points(mesh.points.size());
    for (std::size_t v = 0; v < points.size(); ++v) points[at(number[v])] = mesh.points[v];
    const std::vector<Triangle> old = triangles_of(mesh.connectivity);
    std::vector<Triangle> triangles(old.size());
    const std::vector<Index> order = random.permutation(static_cast<Index>(old.size()));
    for (std::size_t f = 0; f < old.size(); ++f) {
        const auto turn = random.below(std::size_t{3});
        for (std::size_t k = 0; k < 3; ++k) triangles[at(order[f])][k] = number[at(old[f][(k + turn) % 3])];
    }
    return make_surface_mesh(std::move(points), triangles);
}

}  // namespace ricci::testing
