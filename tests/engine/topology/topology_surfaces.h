// Surfaces for topology tests, also with loops and multi-edges, and measures that do not use what is tested.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/surfaces/generate.h"
#include "engine/topology/homotopy_basis.h"
#include "kernels/edge_flip.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci::testing {

struct TestSurface {
    std::string name;
    Connectivity connectivity;
    std::vector<double> length;  // 3F
    std::vector<Index> cones;
};

/// A torus of which only the rows and columns of cells divisible by `spacing` are left, of n x n: genus 1,
/// (n / spacing)^2 holes, every vertex on the boundary, where paths come and go.
inline SurfaceMesh ribbons(Index n, Index spacing) {
    const std::vector<Triangle> all = torus_grid(n, n);
    std::vector<Triangle> kept;
    for (Index cell = 0; cell < n * n; ++cell) {
        if (cell / n % spacing != 0 && cell % n % spacing != 0) continue;
        kept.push_back(all[at(2 * cell)]);
        kept.push_back(all[at(2 * cell + 1)]);
    }
    return make_surface_mesh(bumpy_torus(n, n).points, kept);
}

inline SurfaceMesh named_surface(const std::string& name) {
    if (name == "one-vertex torus") return intrinsic_mesh(one_vertex_torus(1.0, 1.1, 1.3));
    if (name == "folded square") return intrinsic_mesh(folded_square(1.0));
    if (name == "one ribbon") return ribbons(5, 5);
    if (name == "many ribbons") return ribbons(12, 4);
    GenerateOptions options;
    options.faces = 20;  // the smallest pattern there is
    const std::size_t space = name.find(' ');
    if (space != std::string::npos) options.genus = std::stoi(name.substr(space + 1));
    return generate(name.substr(0, space), options);
}

/// Edge lengths at random, equal on twins.
inline std::vector<double> random_lengths(const Connectivity& c, Random& random) {
    const std::vector<double> of_edge = random.uniforms(at(c.edge_count), 0.5, 2.0);
    std::vector<double> length;
    for (const Index e : c.edge) length.push_back(of_edge[at(e)]);
    return length;
}

/// Flips about three times as many random edges as there are, which makes loops and multi-edges.
inline void flip_at_random(Connectivity& c, Random& random) {
    std::vector<double> unused(c.tail.size(), 0.0);
    for (Index i = 0; i < 3 * c.edge_count; ++i) {
        const Index h = random.below(c.halfedge_count());
        if (flippable(c, h)) flip_edge<double>(c, unused, h, 0.0);
    }
}

/// Up to `count` different interior vertices; one used vertex is left for the base.
inline std::vector<Index> random_cones(const Connectivity& c, Index count, Random& random) {
    const std::vector<std::uint8_t> used = used_vertices(c), boundary = boundary_vertices(c);
    std::vector<Index> cones;
    Index free = 0;
    for (const std::uint8_t u : used) free += u;
    for (const Index v : random.permutation(c.vertex_count)) {
        if (free == 1 || static_cast<Index>(cones.size()) == count) break;
        if (used[at(v)] == 0 || boundary[at(v)] != 0) continue;
        cones.push_back(v);
        --free;
    }
    return cones;
}

/// Every surface as it is, with random lengths and flips, and with few and many cones.
inline std::vector<TestSurface> test_surfaces() {
    std::vector<TestSurface> surfaces;
    Random random(7);
    for (const char* name :
         {"sphere", "torus", "eight", "genus-g 3", "genus-g 5", "genus-g 8", "genus-g-one-boundary 1",
          "genus-g-one-boundary 4", "pants", "annulus", "disk", "klein-quartic", "bolza", "one-vertex torus",
          "folded square", "one ribbon", "many ribbons"}) {
        const SurfaceMesh mesh = named_surface(name);
        surfaces.push_back({name, mesh.connectivity, mesh.edge_length, {}});
        for (const Index cones : {0, 1, 3, 40}) {
            TestSurface flipped{std::string(name) + ", flipped, up to " + std::to_string(cones) + " cones",
                                mesh.connectivity,
                                {},
                                {}};
            flip_at_random(flipped.connectivity, random);
            flipped.length = random_lengths(flipped.connectivity, random);
            flipped.cones = random_cones(flipped.connectivity, cones, random);
            surfaces.push_back(std::move(flipped));
        }
    }
    return surfaces;
}

inline HomotopyBasis basis_of(const TestSurface& surface) {
    return make_homotopy_basis(surface.connectivity, surface.length, {.base = -1, .cones = surface.cones});
}

/// Algebraic intersection numbers of closed walks on the surface with its holes closed: the first walk is
/// pushed to its left and crosses the edges that leave its vertices on that side.
class Intersections {
  public:
    explicit Intersections(const Connectivity& c)
        : c_(c), place_(c.tail.size(), -1), reverse_place_(c.tail.size(), -1) {
        star_.resize(at(c.vertex_count));
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            std::vector<Step>& star = star_[at(c.tail[at(h)])];
            if (star.empty()) star = star_from(h);
            for (std::size_t i = 0; i < star.size(); ++i) {
                std::vector<Index>& place = star[i] >= 0 ? place_ : reverse_place_;
                place[at(halfedge_of(star[i]))] = static_cast<Index>(i);
            }
        }
    }

    /// +1 where (direction of first, direction of second) is a positive frame.
    [[nodiscard]] Index number(const EdgePath& first, const EdgePath& second) const {
        std::vector<Index> times(c_.tail.size(), 0);  // the second walk along each halfedge, less against it
        for (const Step s : second) {
            times[at(halfedge_of(s))] += s >= 0 ? 1 : -1;
            const Index twin = c_.twin[at(halfedge_of(s))];
            if (twin != kNoTwin) --times[at(twin)];
        }
        Index sum = 0;
        for (std::size_t i = 0; i < first.size(); ++i) {
            const Step in = reversed_step(c_, first[i]), out = first[(i + 1) % first.size()];
            const std::vector<Step>& star = star_[at(step_tail(c_, out))];
            const auto size = static_cast<Index>(star.size());
            for (Index k = (place(out) + 1) % size; k != place(in); k = (k + 1) % size) {
                if (k == place(out)) break;
                const Step s = star[at(k)];
                sum += s >= 0 ? times[at(s)] : -times[at(~s)];
            }
        }
        return sum;
    }

  private:
    [[nodiscard]] Index place(Step s) const { return s >= 0 ? place_[at(s)] : reverse_place_[at(~s)]; }

    /// Steps that leave the tail of h, counterclockwise.
    [[nodiscard]] std::vector<Step> star_from(Index h) const {
        Index first = h;
        while (c_.twin[at(first)] != kNoTwin) {
            first = next_halfedge(c_.twin[at(first)]);
            if (first == h) break;
        }
        std::vector<Step> star;
        for (Index o = first;;) {
            star.push_back(o);
            const Index p = prev_halfedge(o);
            o = c_.twin[at(p)];
            if (o == kNoTwin) star.push_back(~p);
            if (o == kNoTwin || o == first) return star;
        }
    }

    const Connectivity& c_;
    std::vector<std::vector<Step>> star_;
    std::vector<Index> place_, reverse_place_;
};

}  // namespace ricci::testing
