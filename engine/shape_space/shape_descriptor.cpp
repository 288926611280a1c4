#include "engine/shape_space/shape_descriptor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "engine/shape_space/annulus.h"
#include "engine/shape_space/drawn_geodesic.h"
#include "engine/shape_space/lattice.h"
#include "engine/shape_space/length_spectrum.h"
#include "engine/shape_space/sphere_descriptor.h"
#include "engine/shape_space/teichmuller.h"
#include "engine/topology/boundary_loops.h"

namespace ricci {
namespace {

using Clock = std::chrono::steady_clock;

double lap(Clock::time_point& last) {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    return seconds;
}

bool converged(ShapeDescriptor& d, const FlowResult& flow) {
    d.status = flow.outcome.status;
    d.accuracy = accuracy_of(flow);
    d.message = flow.message;
    return d.status == Status::converged;
}

/// Ascending.
std::vector<double> boundary_lengths(const CoarseSurface& s) {
    std::vector<double> lengths;
    for (const std::vector<Index>& loop : boundary_loops(s.connectivity)) {
        double length = 0;
        for (const Index h : loop) length += 2 * std::asinh(s.half_chord[static_cast<std::size_t>(h)]);
        lengths.push_back(length);
    }
    std::sort(lengths.begin(), lengths.end());
    return lengths;
}

void describe_hyperbolic(const SurfaceMesh& mesh, const ShapeOptions& options, ShapeDescriptor& d) {
    auto last = Clock::now();
    const FlowResult flow = solve_sharply(mesh, options.flow);
    d.seconds.flow = lap(last);
    if (!converged(d, flow)) return;
    const CoarseSurface surface = coarse_surface_of(mesh, flow, options.flow.delaunay);
    d.seconds.surface = lap(last);
    const bool full = describe_spectrum(surface, options, d);
    d.seconds.spectrum = lap(last);
    if (!full || !options.coordinates) return;
    describe_coordinates(surface, options, d);
    d.seconds.coordinates = lap(last);
}

void describe_torus(const SurfaceStructure& s, const ShapeOptions& options, ShapeDescriptor& d) {
    const Lattice lattice = torus_lattice(s.group);
    const LatticeSpectrum spectrum = lattice_spectrum(lattice, options.max_length, options.count);
    for (const LatticeLength& l : spectrum.lengths) {
        d.lengths.push_back(l.length);
        d.primitive.push_back(l.primitive());
    }
    d.complete_up_to = spectrum.complete_up_to;
    d.fingerprint = {lattice.modulus.real(), lattice.modulus.imag()};
    d.coordinates = d.fingerprint;
    d.names = {"modulus_re", "modulus_im"};
}

void describe_annulus(const SurfaceStructure& s, const ShapeOptions& options, ShapeDescriptor& d) {
    const Annulus annulus = make_annulus(s);
    AnnulusSpectrum spectrum = annulus_spectrum(options.max_length, options.count);
    d.lengths = std::move(spectrum.lengths);
    d.primitive = std::move(spectrum.primitive);
    d.complete_up_to = spectrum.complete_up_to;
    d.fingerprint = {std::log(annulus.modulus)};
    d.coordinates = {annulus.modulus};
    d.names = {"modulus"};
}

void describe_flat(const SurfaceMesh& mesh, const ShapeOptions& options, ShapeDescriptor& d) {
    auto last = Clock::now();
    const SurfaceStructure s = make_sharp_structure(mesh, options.flow, 16);
    d.seconds.flow = s.seconds.flow;
    d.seconds.surface = lap(last) - s.seconds.flow;
    if (!converged(d, s.flow)) return;
    if (d.genus == 1)
        describe_torus(s, options, d);
    else
        describe_annulus(s, options, d);
    d.marking_gap = 1.0;
    d.seconds.spectrum = lap(last);
}

void describe_sphere(const SurfaceMesh& mesh, const ShapeOptions& options, ShapeDescriptor& d) {
    auto last = Clock::now();
    const FlowResult flow = solve_flow(mesh, options.flow);
    d.seconds.flow = lap(last);
    if (!converged(d, flow)) return;
    SphereDescriptor s = make_sphere_descriptor(mesh, flow);
    d.fingerprint = s.values;
    d.coordinates = std::move(s.values);
    d.names = std::move(s.names);
    d.message = s.message;
    d.marking_gap = 1.0;
    d.seconds.coordinates = lap(last);
}

}  // namespace

bool describe_spectrum(const CoarseSurface& surface, const ShapeOptions& options, ShapeDescriptor& d) {
    SpectrumOptions spectrum;
    spectrum.max_length = options.max_length;
    spectrum.count = options.count;
    spectrum.inner_count = std::min<std::int64_t>(options.fingerprint, 4 * (3 * d.genus - 3 + d.boundaries));
    spectrum.budget = options.budget;
    const LengthSpectrum s = length_spectrum(surface, spectrum);
    d.complete_up_to = options.count > 0 ? s.complete_up_to : std::min(options.max_length, s.complete_up_to);
    for (const SpectrumLength& l : s.lengths) {
        if (l.length > d.complete_up_to) break;
        d.lengths.push_back(l.length);
        d.primitive.push_back(l.power == 1);
    }
    const auto size = static_cast<std::size_t>(spectrum.inner_count + d.boundaries);
    d.fingerprint = boundary_lengths(surface);
    for (std::size_t k = 0; k < s.geodesics.size() && d.fingerprint.size() < size; ++k)
        if (s.boundary[k] < 0) d.fingerprint.push_back(s.geodesics[k].length);
    for (double& x : d.fingerprint) x = std::log(x);
    if (d.fingerprint.size() == size) return true;
    d.status = Status::max_iterations;
    d.message = "the spectrum's budget ended before the fingerprint was full";
    return false;
}

void describe_coordinates(const CoarseSurface& surface, const ShapeOptions& options, ShapeDescriptor& d) {
    try {
        const ExactSurface exact(surface);
        MarkingOptions marking;
        marking.budget = options.budget;
        const TeichmullerCoordinates c = teichmuller_coordinates(exact, make_marking(exact, marking));
        for (const LengthCoordinate& l : c.lengths) {
            d.coordinates.push_back(l.length);
            d.names.push_back(l.name);
        }
        d.marking_gap = c.smallest_gap;
        d.message = near_ties(c.choices);
    } catch (const std::runtime_error& e) {
        d.message = std::string("no coordinates: ") + e.what();
    }
}

ShapeDescriptor describe_shape(const SurfaceMesh& mesh, const ShapeOptions& options) {
    const Topology topology = topology_of(mesh.connectivity);
    ShapeDescriptor d;
    d.genus = topology.genus;
    d.boundaries = topology.boundaries;
    if (topology.euler_characteristic < 0)
        describe_hyperbolic(mesh, options, d);
    else if (topology.euler_characteristic == 0)
        describe_flat(mesh, options, d);
    else
        describe_sphere(mesh, options, d);
    return d;
}

}  // namespace ricci
