#include "engine/shape_space/surface_coordinates.h"

#include <algorithm>
#include <stdexcept>

#include "engine/shape_space/annulus.h"
#include "engine/shape_space/drawn_geodesic.h"
#include "engine/shape_space/lattice.h"
#include "engine/shape_space/length_spectrum.h"
#include "engine/shape_space/sphere_descriptor.h"

namespace ricci {
namespace {

/// Classes and lengths of edge paths, by the deck transformations of their words.
std::vector<CoordinateCurve> measured(const SurfaceStructure& structure,
                                      const std::vector<NamedPath>& paths) {
    std::vector<CoordinateCurve> curves;
    for (const NamedPath& p : paths) {
        const Word word = canonical_word(structure, p.path);
        // The relator's element is the identity up to rounding only.
        const double length = word.empty() ? 0.0 : loop_length(structure, p.path);
        curves.push_back({p.name, length, canonical_text(structure, word), {}});
    }
    return curves;
}

void by_rule(const SurfaceMesh& mesh, const SurfaceCoordinateOptions& options, const CoarseSurface& surface,
             SurfaceCoordinates& s) {
    const ExactSurface exact(surface);
    const TeichmullerCoordinates c = teichmuller_coordinates(exact, make_marking(exact, options.marking));
    s.marking = "geometric";
    s.choices = c.choices;
    s.smallest_gap = c.smallest_gap;
    s.pants = c.pants;
    s.message = near_ties(c.choices);
    for (const LengthCoordinate& l : c.lengths) {
        CoordinateCurve curve{l.name, l.length, "", {}};
        if (options.words || options.draw) try {
                const ClosedGeodesic g = follow_curve(exact, moved_to_axis(exact, l.curve)).geodesic;
                curve.curve = draw_geodesic(s.structure, mesh.connectivity, surface, g);
                curve.word = canonical_text(s.structure, canonical_word(s.structure, curve.curve.path));
                if (!options.draw) curve.curve = {};
            } catch (const std::runtime_error& e) {
                s.message = "the curve " + l.name + " is not drawn: " + e.what();
            }
        s.curves.push_back(std::move(curve));
    }
}

void hyperbolic(const SurfaceMesh& mesh, const SurfaceCoordinateOptions& options, SurfaceCoordinates& s) {
    const bool given = !options.marking_curves.empty();
    const bool curves = options.words || options.draw || given || !options.loops.empty();
    FlowResult flow;
    if (curves) {
        // More digits than double for the group only where lengths are taken from it.
        s.structure = make_sharp_structure(mesh, options.flow, given || !options.loops.empty() ? 800 : 19);
        flow = s.structure.flow;
    } else {
        flow = solve_sharply(mesh, options.flow);
    }
    s.status = flow.outcome.status;
    s.accuracy = accuracy_of(flow);
    s.message = flow.message;
    if (s.status != Status::converged) return;
    if (given) {
        s.marking = "curves";
        s.curves = measured(s.structure, options.marking_curves);
    } else {
        const CoarseSurface surface = curves
                                          ? coarse_surface_of(mesh, flow, options.flow.delaunay,
                                                              &*s.structure.refinement, &*s.structure.metric)
                                          : coarse_surface_of(mesh, flow, options.flow.delaunay);
        by_rule(mesh, options, surface, s);
    }
    for (const CoordinateCurve& c : s.curves) {
        s.coordinates.push_back(c.length);
        s.names.push_back(c.name);
    }
    if (s.genus == 0 && s.boundaries == 3 && s.coordinates.size() == 3)
        s.seams = hexagon_seams({s.coordinates[0], s.coordinates[1], s.coordinates[2]});
}

void flat(const SurfaceMesh& mesh, const SurfaceCoordinateOptions& options, SurfaceCoordinates& s) {
    s.geometry = Geometry::euclidean;
    s.structure = make_sharp_structure(mesh, options.flow, 16);
    s.status = s.structure.flow.outcome.status;
    s.accuracy = accuracy_of(s.structure.flow);
    s.message = s.structure.flow.message;
    if (s.status != Status::converged) return;
    if (s.genus == 1) {
        const Lattice lattice = torus_lattice(s.structure.group);
        s.modulus_re = lattice.modulus.real();
        s.modulus_im = lattice.modulus.imag();
        s.length_ratio = lattice.length_ratio;
        s.angle = lattice.angle;
        s.coordinates = {s.modulus_re, s.modulus_im};
        s.names = {"modulus_re", "modulus_im"};
    } else {
        s.modulus = make_annulus(s.structure).modulus;
        s.coordinates = {s.modulus};
        s.names = {"modulus"};
    }
}

void spherical(const SurfaceMesh& mesh, const SurfaceCoordinateOptions& options, SurfaceCoordinates& s) {
    s.geometry = Geometry::spherical;
    const FlowResult flow = solve_flow(mesh, options.flow);
    s.status = flow.outcome.status;
    s.accuracy = accuracy_of(flow);
    s.message = flow.message;
    if (s.status != Status::converged) return;
    SphereDescriptor d = make_sphere_descriptor(mesh, flow);
    s.coordinates = std::move(d.values);
    s.names = std::move(d.names);
    s.message = d.message;
}

}  // namespace

SurfaceCoordinates make_surface_coordinates(const SurfaceMesh& mesh,
                                            const SurfaceCoordinateOptions& options) {
    const Topology topology = topology_of(mesh.connectivity);
    SurfaceCoordinates s;
    s.genus = topology.genus;
    s.boundaries = topology.boundaries;
    s.marking = "none";
    if (topology.euler_characteristic >= 0 && !options.marking_curves.empty())
        throw std::invalid_argument("a marking by curves is for surfaces of negative Euler characteristic");
    if (topology.euler_characteristic > 0 && !options.loops.empty())
        throw std::invalid_argument("all loops on a sphere or a disk shrink to points");
    if (topology.euler_characteristic < 0)
        hyperbolic(mesh, options, s);
    else if (topology.euler_characteristic == 0)
        flat(mesh, options, s);
    else
        spherical(mesh, options, s);
    if (s.status == Status::converged && !options.loops.empty())
        s.loops = measured(s.structure, options.loops);
    return s;
}

}  // namespace ricci
