#include "engine/shape_space/drawn_geodesic.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>

#include "engine/shape_space/based_curve.h"
#include "engine/shape_space/length_spectrum.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A pass at a vertex that the final triangulation has, or one carried to such a vertex.
GeodesicPass pass_at_vertex(const CoarseSurface& s, const ClosedGeodesic& g) {
    for (const GeodesicPass& p : g.passes)
        if (s.final_face[at(p.vertex)] >= 0) return p;
    std::vector<std::uint8_t> seen(s.final_face.size(), 0);
    std::queue<GeodesicPass> front;
    front.push(g.passes.front());
    seen[at(g.passes.front().vertex)] = 1;
    while (!front.empty()) {
        const GeodesicPass p = front.front();
        front.pop();
        if (s.final_face[at(p.vertex)] >= 0) return p;
        for_neighbours(s, p.vertex, [&](CoarseStep step, Index w) {
            if (seen[at(w)]) return;
            seen[at(w)] = 1;
            front.push({w, apply(-1, inverse(s.along(step)), p.normal), 0.0});
        });
    }
    throw std::runtime_error("no vertex of the surface is left to start a geodesic at");
}

}  // namespace

SurfaceCurve draw_geodesic(const SurfaceStructure& structure, const Connectivity& input,
                           const CoarseSurface& s, const ClosedGeodesic& geodesic) {
    const CommonRefinement& r = *structure.refinement;
    const GeodesicPass pass = pass_at_vertex(s, geodesic);
    const LineNormal line = moved_line(-1, s.in_final_face[at(pass.vertex)], pass.normal);
    const auto piece = std::find(r.final_face.begin(), r.final_face.end(), s.final_face[at(pass.vertex)]);
    const GeodesicStart start = start_on_line(
        r, *structure.metric, static_cast<Index>(piece - r.final_face.begin()), line, geodesic.length);
    return trace_geodesic(r, *structure.metric, input, start);
}

Word canonical_word(const SurfaceStructure& structure, std::span<const Step> path) {
    return in_canonical_generators(structure.canonical, structure.basis->word_of_path(path), true);
}

std::string canonical_text(const SurfaceStructure& structure, std::span<const Index> word) {
    std::vector<std::string> names;
    for (const GroupGenerator& g : structure.group.generators) names.push_back(g.name);
    return to_text(word, names);
}

double word_length(const SurfaceStructure& structure, std::span<const Index> word) {
    Isometry<double> element;
    for (const Index letter : word) {
        const Isometry<double>& g = structure.group.generators[at(generator_of(letter))].element;
        element = compose(structure.kappa, element, letter > 0 ? g : inverse(g));
    }
    return translation_length(structure.kappa, element);
}

double loop_length(const SurfaceStructure& structure, std::span<const Step> path) {
    Isometry<double> element;
    for (const Index letter : cyclically_reduced(structure.basis->word_of_path(path))) {
        const Isometry<double>& x = structure.group.letters[at(generator_of(letter))];
        element = compose(structure.kappa, element, letter > 0 ? x : inverse(x));
    }
    return translation_length(structure.kappa, element);
}

SurfaceStructure make_sharp_structure(const SurfaceMesh& mesh, const FlowOptions& flow, int max_digits) {
    StructureOptions options;
    options.max_digits = max_digits;
    SurfaceStructure s;
    solve_sharply(flow, [&](const FlowOptions& sharp) {
        options.flow = sharp;
        s = make_surface_structure(mesh, options);
        return s.flow.outcome.status;
    });
    return s;
}

}  // namespace ricci
