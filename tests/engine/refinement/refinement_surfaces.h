// Surfaces whose triangulations are far from Delaunay, so that many edges cross.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/surfaces/generate.h"
#include "engine/surfaces/regular_map.h"
#include "kernels/delaunay.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci::testing {

struct NamedMesh {
    std::string name;
    SurfaceMesh mesh;
};

inline SurfaceMesh generated(const std::string& name, Index faces, double jitter = 0.0, Index genus = 2) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    options.genus = genus;
    options.seed = 3;
    return generate(name, options);
}

/// Angle between the halfedges that start where h and prev(h) meet, from lengths by the law of cosines.
inline double corner_angle_at_tail(const std::vector<long double>& log_length, Index h) {
    const double a = std::exp(static_cast<double>(log_length[at(h)])),
                 b = std::exp(static_cast<double>(log_length[at(prev_halfedge(h))])),
                 c = std::exp(static_cast<double>(log_length[at(next_halfedge(h))]));
    return std::acos((a * a + b * b - c * c) / (2 * a * b));
}

/// Whether the two flat triangles at the edge of h form a convex quadrilateral, by a margin of 0.2.
inline bool convex(const IntrinsicTriangulation<long double>& t, Index h) {
    const Connectivity& c = t.connectivity;
    if (!flippable(c, h)) return false;
    const Index w = c.twin[at(h)];
    const double tail =
        corner_angle_at_tail(t.log_chord, h) + corner_angle_at_tail(t.log_chord, next_halfedge(w));
    const double head =
        corner_angle_at_tail(t.log_chord, next_halfedge(h)) + corner_angle_at_tail(t.log_chord, w);
    return tail < std::numbers::pi - 0.2 && head < std::numbers::pi - 0.2;
}

/// The same flat surface, its edges flipped at random (geodesically) up to `flips` times: loops and
/// multi-edges on small ones, and long thin faces everywhere.
inline SurfaceMesh scrambled(const SurfaceMesh& mesh, Index flips, std::uint64_t seed) {
    Random random(seed);
    auto t = intrinsic_triangulation<long double>(mesh);
    for (Index i = 0; i < flips; ++i) {
        const Index h = random.below(t.connectivity.halfedge_count());
        if (!convex(t, h)) continue;
        const long double length = unfolded_log<long double>(t.log_chord, t.connectivity, h);
        flip_edge<long double>(t.connectivity, t.log_chord, h, length);
    }
    return intrinsic_mesh(t);
}

/// Surfaces of every kind: closed or not, embedded or intrinsic, with loops.
inline std::vector<NamedMesh> refinement_surfaces() {
    std::vector<NamedMesh> surfaces;
    const auto add = [&](std::string name, SurfaceMesh mesh) {
        surfaces.push_back({std::move(name), std::move(mesh)});
    };
    add("noisy icosahedron", icosahedron(0.4, 2));
    add("bumpy torus", bumpy_torus(9, 7, 0.25, 4));
    add("wavy square", wavy_square(6, 0.35, 2));
    add("eight", generated("eight", 400, 0.4));
    add("genus 3", generated("genus-g", 600, 0.4, 3));
    add("pants", generated("pants", 300, 0.4));
    add("genus 1, one boundary", generated("genus-g-one-boundary", 300, 0.4, 1));
    add("annulus", generated("annulus", 120, 0.4));
    add("disk", generated("disk", 120, 0.4));
    add("one-vertex torus", intrinsic_mesh(one_vertex_torus(1.0L, 1.3L, 2.2L)));
    add("scrambled folded square", scrambled(intrinsic_mesh(folded_square(1.0L)), 8, 1));
    add("scrambled torus", scrambled(bumpy_torus(5, 4, 0.1, 1), 300, 2));
    add("scrambled bolza", scrambled(make_bolza(), 200, 3));
    add("scrambled klein quartic", scrambled(make_klein_quartic(), 300, 4));
    return surfaces;
}

}  // namespace ricci::testing
