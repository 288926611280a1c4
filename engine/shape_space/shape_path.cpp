#include "engine/shape_space/shape_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>

#include "engine/shape_space/drawn_geodesic.h"
#include "engine/shape_space/flat_distance.h"
#include "engine/shape_space/lattice.h"
#include "engine/shape_space/length_spectrum.h"
#include "engine/shape_space/nearest_modulus.h"

namespace ricci {
namespace {

/// Relative differences of lengths above this are worth a note.
constexpr double kSpread = 1e-8;

bool same_triangles(const Connectivity& x, const Connectivity& y) {
    return x.vertex_count == y.vertex_count && x.tail == y.tail && x.twin == y.twin;
}

double euclidean(std::span<const double> x, std::span<const double> y) {
    if (x.size() != y.size()) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) sum += (x[k] - y[k]) * (x[k] - y[k]);
    return std::sqrt(sum);
}

void note(PathFrame& frame, const std::string& text) {
    frame.message += (frame.message.empty() ? "" : "; ") + text;
}

bool converged(PathFrame& frame, const FlowResult& flow) {
    if (flow.outcome.status == Status::converged) return true;
    frame.status = flow.outcome.status;
    frame.message = flow.message;
    return false;
}

/// m letters[0] + n letters[1] as a loop at the base.
EdgePath lattice_path(const HomotopyBasis& basis, const LatticeCoefficients& c) {
    return basis.walk(lattice_word(c));
}

/// The translation of a closed edge path of a flat torus, through its homology class.
std::complex<double> translation_along(const SurfaceStructure& s, std::span<const Step> path) {
    std::complex<double> sum;
    for (const Index letter : s.basis->word_of_path(path)) {
        const std::complex<double> t =
            translation_of(s.group.letters[static_cast<std::size_t>(generator_of(letter))]);
        sum += letter > 0 ? t : -t;
    }
    return sum;
}

std::complex<double> modulus_of(const PathFrame& torus) {
    return {torus.coordinates[0], torus.coordinates[1]};
}

}  // namespace

std::string_view name_of(MarkingSource source) {
    switch (source) {
        case MarkingSource::none:
            return "none";
        case MarkingSource::own:
            return "own";
        case MarkingSource::carried:
            return "carried";
    }
    return "";
}

void ShapePath::begin_sequence() {
    last_.reset();
    modulus_ = first_modulus_;
}

const ShapePath::KnownMarking* ShapePath::known(const Connectivity& connectivity) const {
    for (const KnownMarking& m : markings_)
        if (same_triangles(m.connectivity, connectivity)) return &m;
    return nullptr;
}

void ShapePath::describe_hyperbolic(const SurfaceMesh& mesh, PathFrame& frame) {
    const SurfaceStructure s = make_sharp_structure(mesh, options_.flow, 16);
    if (!converged(frame, s.flow)) return;
    const CoarseSurface coarse =
        coarse_surface_of(mesh, s.flow, options_.flow.delaunay, &*s.refinement, &*s.metric);
    ShapeDescriptor d;
    d.genus = frame.genus;
    d.boundaries = frame.boundaries;
    const bool full = describe_spectrum(coarse, options_, d);
    frame.fingerprint = d.fingerprint;
    if (!full) {
        frame.status = d.status;
        frame.message = d.message;
    } else if (const KnownMarking* m = known(mesh.connectivity)) {
        describe_coordinates(coarse, options_, d);  // for the gap that a marking of its own would have
        frame.message = d.message;
        frame.marking_gap = d.marking_gap;
        frame.marking = MarkingSource::carried;
        frame.marking_number = m->number;
        frame.names = m->curves.names;
        frame.coordinates = carried_lengths(m->curves, s, mesh.connectivity, frame.marking_spread);
        if (frame.marking_spread > kSpread) note(frame, "rounding grows along the carried curves");
    } else {
        describe_own_marking(mesh, s, coarse, frame);
    }
}

void ShapePath::describe_own_marking(const SurfaceMesh& mesh, const SurfaceStructure& s,
                                     const CoarseSurface& coarse, PathFrame& frame) {
    const ExactSurface surface(coarse);
    MarkingOptions marking;
    marking.budget = options_.budget;
    TeichmullerCoordinates c;
    try {
        c = teichmuller_coordinates(surface, make_marking(surface, marking));
    } catch (const std::runtime_error& e) {
        frame.status = Status::max_iterations;  // as a rule the budget ended; the message says so
        frame.message = std::string("no coordinates: ") + e.what();
        return;
    }
    frame.marking = MarkingSource::own;
    frame.marking_number = next_number_++;
    for (const LengthCoordinate& l : c.lengths) {
        frame.coordinates.push_back(l.length);
        frame.names.push_back(l.name);
    }
    frame.marking_gap = c.smallest_gap;
    frame.message = near_ties(c.choices);
    try {
        DrawnMarking drawn = draw_marking(s, mesh.connectivity, surface, c);
        double spread = 0.0;
        const std::vector<double> lengths = carried_lengths(drawn, s, mesh.connectivity, spread);
        for (std::size_t k = 0; k < lengths.size(); ++k)
            frame.marking_spread =
                std::max(frame.marking_spread, std::abs(lengths[k] / frame.coordinates[k] - 1.0));
        if (frame.marking_spread > kSpread)
            note(frame, "the curves drawn on the mesh differ from those of the marking");
        markings_.push_back({frame.marking_number, mesh.connectivity, std::move(drawn), {}});
    } catch (const std::runtime_error& e) {
        note(frame, std::string("the marking cannot be carried on: ") + e.what());
    }
}

void ShapePath::describe_torus(const SurfaceMesh& mesh, PathFrame& frame) {
    const SurfaceStructure s = make_sharp_structure(mesh, options_.flow, 16);
    if (!converged(frame, s.flow)) return;
    std::complex<double> modulus;
    if (const KnownMarking* m = known(mesh.connectivity)) {
        frame.marking = MarkingSource::carried;
        modulus = translation_along(s, m->basis.second) / translation_along(s, m->basis.first);
    } else {
        frame.marking = MarkingSource::own;
        const Lattice lattice =
            reduce_lattice(translation_of(s.group.letters[0]), translation_of(s.group.letters[1]));
        LatticeCoefficients a = lattice.first_coefficients, b = lattice.second_coefficients;
        modulus = lattice.second / lattice.first;
        if (modulus_) {
            const EquivalentModulus near = nearest_modulus(modulus, *modulus_);
            const ModularElement& g = near.element;
            modulus = near.modulus;
            const LatticeCoefficients first{g[2] * b[0] + g[3] * a[0], g[2] * b[1] + g[3] * a[1]};
            b = {g[0] * b[0] + g[1] * a[0], g[0] * b[1] + g[1] * a[1]};
            a = first;
        }
        markings_.push_back(
            {0, mesh.connectivity, {}, {lattice_path(*s.basis, a), lattice_path(*s.basis, b)}});
    }
    frame.marking_number = 0;
    frame.marking_gap = 1.0;
    const std::complex<double> reduced = torus_lattice(s.group).modulus;
    frame.fingerprint = {reduced.real(), reduced.imag()};
    if (!first_modulus_) first_modulus_ = modulus;
    modulus_ = modulus;
    frame.names = {"modulus_re", "modulus_im"};
    frame.coordinates = {modulus.real(), modulus.imag()};
}

void ShapePath::describe(const SurfaceMesh& mesh, PathFrame& frame) {
    const Topology topology = topology_of(mesh.connectivity);
    frame.genus = topology.genus;
    frame.boundaries = topology.boundaries;
    if (type_ && *type_ != std::pair(frame.genus, frame.boundaries))
        throw std::invalid_argument("genus " + std::to_string(frame.genus) + " with " +
                                    std::to_string(frame.boundaries) +
                                    " boundaries, unlike the frames before (" + std::to_string(type_->first) +
                                    ", " + std::to_string(type_->second) + ")");
    if (topology.euler_characteristic < 0) return describe_hyperbolic(mesh, frame);
    if (topology.genus == 1) return describe_torus(mesh, frame);
    ShapeDescriptor d = describe_shape(mesh, options_);
    frame.status = d.status;
    frame.message = std::move(d.message);
    frame.fingerprint = std::move(d.fingerprint);
    frame.marking_gap = d.marking_gap;
    frame.coordinates = std::move(d.coordinates);
    frame.names = std::move(d.names);
}

void ShapePath::measure_step(PathFrame& frame) {
    if (!last_) return;
    const bool annulus = frame.genus == 0 && frame.boundaries == 2,
               torus = frame.genus == 1 && frame.boundaries == 0;
    if (torus) {
        frame.step = marked_torus_distance(modulus_of(*last_), modulus_of(frame));
        frame.free_step = torus_distance(modulus_of(*last_), modulus_of(frame));
    } else if (annulus) {
        frame.step = frame.free_step = annulus_distance(last_->coordinates[0], frame.coordinates[0]);
    } else {
        frame.step = euclidean(last_->coordinates, frame.coordinates);
        frame.free_step = euclidean(last_->fingerprint, frame.fingerprint);
    }
    frame.length = last_->length + frame.step;
}

PathFrame failed_frame(Status status, const std::string& message) {
    PathFrame frame;
    frame.status = status;
    frame.message = message;
    frame.marking_gap = frame.marking_spread = frame.step = frame.free_step = frame.length =
        std::numeric_limits<double>::quiet_NaN();
    return frame;
}

PathFrame ShapePath::add(const SurfaceMesh& mesh) {
    PathFrame frame;
    try {
        describe(mesh, frame);
        if (frame.status == Status::converged) measure_step(frame);
    } catch (const std::invalid_argument& e) {
        return failed_frame(Status::invalid_input, e.what());
    } catch (const std::bad_alloc&) {
        return failed_frame(Status::out_of_memory, "memory ran out");
    } catch (const std::exception& e) {
        return failed_frame(Status::internal_error, e.what());
    }
    if (frame.status != Status::converged) return failed_frame(frame.status, frame.message);
    type_ = {frame.genus, frame.boundaries};
    last_ = frame;
    return frame;
}

}  // namespace ricci
