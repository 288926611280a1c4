#include "engine/shape_space/length_spectrum.h"

#include <algorithm>
#include <cmath>

#include "engine/shape_space/line_table.h"
#include "engine/topology/boundary_loops.h"

namespace ricci {
namespace {

/// Powers of all primitive geodesics up to a length.
std::vector<SpectrumLength> with_powers(const std::vector<ClosedGeodesic>& geodesics, double max_length) {
    std::vector<SpectrumLength> lengths;
    for (std::size_t k = 0; k < geodesics.size(); ++k)
        for (Index power = 1; power * geodesics[k].length <= max_length; ++power)
            lengths.push_back({power * geodesics[k].length, k, power});
    std::sort(lengths.begin(), lengths.end(), [](const SpectrumLength& x, const SpectrumLength& y) {
        return x.length != y.length ? x.length < y.length
               : x.power != y.power ? x.power < y.power
                                    : x.geodesic < y.geodesic;
    });
    return lengths;
}

/// Cuts after the multiplet of the count-th.
void keep_count(LengthSpectrum& s, std::size_t count) {
    const double last = s.lengths[count - 1].length * (1 + 1e-9);
    if (s.lengths.back().length <= last) return;
    while (s.lengths.back().length > last) s.lengths.pop_back();
    s.complete_up_to = s.lengths.back().length;
}

void name_boundaries(const CoarseSurface& surface, LengthSpectrum& s) {
    s.boundary.assign(s.geodesics.size(), -1);
    LineTable lines;
    const std::vector<std::vector<Index>> loops = boundary_loops(surface.connectivity);
    for (std::size_t j = 0; j < loops.size(); ++j) {
        const auto first = static_cast<std::size_t>(loops[j].front());
        const double direction = surface.direction[first];
        lines.insert(surface.connectivity.tail[first], {-std::sin(direction), std::cos(direction), 0.0},
                     static_cast<Index>(j));
    }
    for (std::size_t k = 0; k < s.geodesics.size(); ++k)
        for (const GeodesicPass& p : s.geodesics[k].passes)
            if (const Index j = lines.find(p.vertex, p.normal); j >= 0) s.boundary[k] = j;
}

bool enough(const LengthSpectrum& s, const SpectrumOptions& o) {
    return static_cast<std::int64_t>(s.lengths.size()) >= o.count &&
           std::count(s.boundary.begin(), s.boundary.end(), -1) >= o.inner_count;
}

}  // namespace

LengthSpectrum length_spectrum(const CoarseSurface& surface, const SpectrumOptions& options) {
    LengthSpectrum s;
    std::int64_t budget = options.budget;
    double length = options.count > 0 ? 2.0 : options.max_length;
    for (;;) {
        // The next length costs about e^(difference) times as much: not begun where the budget cannot bear
        // it.
        ClosedGeodesics found = find_closed_geodesics(surface, length, budget);
        if (found.complete_up_to == 0.0) {
            if (s.complete_up_to > 0 || length < 0.25) break;
            budget = options.budget;
            length /= 2;
            continue;
        }
        budget -= found.crossed;
        s.crossed += found.crossed;
        s.geodesics = std::move(found.primitive);
        s.complete_up_to = found.complete_up_to;
        s.lengths = with_powers(s.geodesics, s.complete_up_to);
        name_boundaries(surface, s);
        if (enough(s, options) || length < options.max_length * (options.count == 0)) break;
        length += length < 6 ? 1.0 : 0.5;
    }
    if (options.count > 0 && enough(s, options)) keep_count(s, static_cast<std::size_t>(options.count));
    return s;
}

std::vector<Index> input_boundaries(const CoarseSurface& surface, const Connectivity& input) {
    std::vector<Index> component(static_cast<std::size_t>(input.vertex_count), -1), found;
    const std::vector<std::vector<Index>> loops = boundary_loops(input);
    for (std::size_t j = 0; j < loops.size(); ++j)
        for (const Index h : loops[j])
            component[static_cast<std::size_t>(input.tail[static_cast<std::size_t>(h)])] =
                static_cast<Index>(j);
    for (const Index v : surface.boundary_vertex)
        found.push_back(v < 0 ? -1 : component[static_cast<std::size_t>(v)]);
    return found;
}

FlowResult solve_sharply(const SurfaceMesh& mesh, const FlowOptions& options) {
    FlowResult flow;
    solve_sharply(options, [&](const FlowOptions& sharp) {
        flow = solve_flow(mesh, sharp);
        return flow.outcome.status;
    });
    return flow;
}

CoarseSurface coarse_surface_of(const SurfaceMesh& mesh, const FlowResult& flow, bool delaunay,
                                const CommonRefinement* refinement, const FinalMetric<double>* metric) {
    if (flow.doubled) {
        if (refinement && metric) return make_coarse_surface(half_triangulation(*refinement, *metric));
        const CommonRefinement own = make_common_refinement(mesh, flow.conformal_factor, true, delaunay);
        return make_coarse_surface(half_triangulation(own, make_final_metric(-1, own)));
    }
    std::vector<double> half_chord;
    if (metric) {
        half_chord = metric->half_chord;
    } else {
        for (const double l : flow.edge_length) half_chord.push_back(std::sinh(l / 2));
    }
    const Connectivity& final_triangulation =
        refinement ? refinement->final_triangulation.connectivity : flow.triangulation;
    return make_coarse_surface(closed_triangulation(final_triangulation, std::move(half_chord)));
}

}  // namespace ricci
