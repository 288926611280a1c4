#include "engine/shape_space/surface_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "engine/flow/cancellation.h"
#include "engine/layout/transport.h"
#include "engine/shape_space/annulus.h"
#include "engine/shape_space/drawn_geodesic.h"
#include "engine/shape_space/lattice.h"

namespace ricci {
namespace {

bool wanted(const SurfaceSpectrumOptions& o, std::size_t k) {
    return o.drawn == 0 || static_cast<std::int64_t>(k) < o.drawn;
}

/// Word and curve of a geodesic that start_on_line or start_on_axis began.
void describe(const SurfaceStructure& structure, const SurfaceSpectrumOptions& options, std::size_t k,
              SurfaceCurve curve, SurfaceSpectrum& s) {
    SurfaceGeodesic& g = s.geodesics[k];
    if (options.words) {
        const Word word = canonical_word(structure, curve.path);
        g.word = canonical_text(structure, word);
        if (structure.kappa < 0 && structure.group.relator_error < 1e-8) {
            const double length = word_length(structure, word);
            if (g.length < 12 && word.size() < 40)
                s.word_error = std::max(s.word_error, std::abs(length - g.length) / g.length);
        }
    }
    if (options.draw && wanted(options, k)) g.curve = std::move(curve);
}

void hyperbolic(const SurfaceMesh& mesh, const SurfaceSpectrumOptions& options, SurfaceSpectrum& s) {
    const bool curves = options.words || options.draw;
    FlowResult flow;
    if (curves) {
        s.structure = make_sharp_structure(mesh, options.flow, 19);
        s.relator_error = s.structure.group.relator_error;
        flow = s.structure.flow;
    } else {
        flow = solve_sharply(mesh, options.flow);
    }
    s.status = flow.outcome.status;
    s.accuracy = accuracy_of(flow);
    s.message = flow.message;
    if (s.status != Status::converged) return;
    const CoarseSurface surface = curves ? coarse_surface_of(mesh, flow, options.flow.delaunay,
                                                             &*s.structure.refinement, &*s.structure.metric)
                                         : coarse_surface_of(mesh, flow, options.flow.delaunay);
    if (!curves) s.relator_error = surface.angle_error;
    SpectrumOptions spectrum;
    spectrum.max_length = options.max_length;
    spectrum.count = options.count;
    spectrum.budget = options.budget;
    const LengthSpectrum found = length_spectrum(surface, spectrum);
    const std::vector<Index> component = input_boundaries(surface, mesh.connectivity);
    s.complete_up_to = found.complete_up_to;
    for (const SpectrumLength& l : found.lengths) {
        s.lengths.push_back(l.length);
        s.power.push_back(l.power);
        s.geodesic.push_back(l.geodesic);
    }
    for (std::size_t k = 0; k < found.geodesics.size(); ++k) {
        if (found.geodesics[k].length > found.complete_up_to) break;  // beyond the count
        const Index b = found.boundary[k];
        s.geodesics.push_back(
            {found.geodesics[k].length, b < 0 ? b : component[static_cast<std::size_t>(b)], "", {}});
        if (!options.words && !(options.draw && wanted(options, k))) continue;
        cancellation_point();
        try {
            describe(s.structure, options, k,
                     draw_geodesic(s.structure, mesh.connectivity, surface, found.geodesics[k]), s);
        } catch (const std::runtime_error& e) {
            s.message = "geodesic " + std::to_string(k) + " is not drawn: " + e.what();
        }
    }
}

/// The translation along a closed geodesic of a flat surface, as a curve.
SurfaceCurve flat_curve(const SurfaceMesh& mesh, const SurfaceStructure& structure,
                        const Isometry<double>& element) {
    const PieceWalks walks(*structure.refinement, mesh.connectivity, *structure.basis);
    return trace_geodesic(*structure.refinement, *structure.metric, mesh.connectivity,
                          start_on_axis(*structure.refinement, *structure.metric,
                                        walks.home(structure.basis->base()), element));
}

Isometry<double> power_of(const Isometry<double>& x, std::int64_t power) {
    const Isometry<double> factor = power < 0 ? inverse(x) : x;
    Isometry<double> result;
    for (std::int64_t k = 0; k < std::abs(power); ++k) result = compose(0, result, factor);
    return result;
}

void torus(const SurfaceMesh& mesh, const SurfaceSpectrumOptions& options, SurfaceSpectrum& s) {
    s.unit = "in units of the shortest";
    const Lattice lattice = torus_lattice(s.structure.group);
    const LatticeSpectrum found = lattice_spectrum(lattice, options.max_length, options.count);
    s.complete_up_to = found.complete_up_to;
    std::vector<std::pair<LatticeCoefficients, std::size_t>> known;
    for (const LatticeLength& l : found.lengths) {
        const LatticeCoefficients c{l.coefficients[0] / l.power, l.coefficients[1] / l.power};
        auto it = std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.first == c; });
        if (it == known.end()) {
            const std::size_t k = s.geodesics.size();
            s.geodesics.push_back({l.length / static_cast<double>(l.power), -1, "", {}});
            if (options.words) s.geodesics[k].word = canonical_text(s.structure, lattice_word(c));
            if (options.draw && wanted(options, k))
                s.geodesics[k].curve =
                    flat_curve(mesh, s.structure,
                               compose(0, power_of(s.structure.group.generators[0].element, c[0]),
                                       power_of(s.structure.group.generators[1].element, c[1])));
            it = known.insert(known.end(), {c, k});
        }
        s.lengths.push_back(l.length);
        s.power.push_back(static_cast<Index>(l.power));
        s.geodesic.push_back(it->second);
    }
}

void annulus(const SurfaceMesh& mesh, const SurfaceSpectrumOptions& options, SurfaceSpectrum& s) {
    s.unit = "in units of the core";
    make_annulus(s.structure);  // throws where the structure is none
    const AnnulusSpectrum found = annulus_spectrum(options.max_length, options.count);
    s.complete_up_to = found.complete_up_to;
    s.lengths = found.lengths;
    s.power.resize(s.lengths.size());
    std::iota(s.power.begin(), s.power.end(), 1);
    s.geodesic.assign(s.lengths.size(), 0);
    s.geodesics.push_back({1.0, 0, "", {}});
    if (options.words) s.geodesics[0].word = s.structure.group.generators[0].name;
    if (options.draw)
        s.geodesics[0].curve = flat_curve(mesh, s.structure, s.structure.group.generators[0].element);
}

}  // namespace

SurfaceSpectrum make_surface_spectrum(const SurfaceMesh& mesh, const SurfaceSpectrumOptions& options) {
    const Topology topology = topology_of(mesh.connectivity);
    if (topology.euler_characteristic > 0)
        throw std::invalid_argument(
            "spheres and disks have no length spectrum: all closed curves on them shrink to points; ricci "
            "teichmuller "
            "gives the descriptors of such shapes");
    SurfaceSpectrum s;
    s.genus = topology.genus;
    s.boundaries = topology.boundaries;
    if (topology.euler_characteristic < 0) {
        hyperbolic(mesh, options, s);
        return s;
    }
    s.geometry = Geometry::euclidean;
    s.structure = make_sharp_structure(mesh, options.flow, 19);
    s.status = s.structure.flow.outcome.status;
    s.accuracy = accuracy_of(s.structure.flow);
    s.message = s.structure.flow.message;
    if (s.status != Status::converged) return s;
    s.relator_error = s.structure.group.relator_error;
    if (topology.genus == 1)
        torus(mesh, options, s);
    else
        annulus(mesh, options, s);
    return s;
}

}  // namespace ricci
