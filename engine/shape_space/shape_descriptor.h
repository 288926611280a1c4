// What an index keeps of a shape: its complete length spectrum, its Teichmueller coordinates, and a vector of
// fixed size to seek neighbours in. All of it is a function of the conformal structure alone (of the geometry
// after Moebius normalisation for spheres and disks): no names, counts or hashes.
#pragma once

#include <string>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/shape_space/coarse_surface.h"

namespace ricci {

struct ShapeOptions {
    FlowOptions flow;
    double max_length = 4.0;          // the spectrum is complete up to here (chi < 0); normalised for chi = 0
    std::int64_t count = 0;           // > 0: instead, at least so many lengths
    bool coordinates = true;          // Teichmueller coordinates too
    std::int64_t fingerprint = 12;    // lengths in the fingerprint, boundaries not counted (chi < 0)
    std::int64_t budget = 300000000;  // edges of the universal cover to cross for each: about 20 s
};

/// Seconds spent.
struct ShapeSeconds {
    double flow = 0, surface = 0, spectrum = 0, coordinates = 0;
};

struct ShapeDescriptor {
    Index genus = 0, boundaries = 0;
    Status status = Status::converged;
    MetricAccuracy accuracy;
    std::string message;  // why, where not converged; else notes (a near-tie in the marking, ...)
    // Closed geodesics up to orientation, powers included, ascending, with multiplicity. Torus: in units of
    // the shortest; annulus: of the core curve; empty for spheres and disks.
    std::vector<double> lengths;
    std::vector<std::uint8_t> primitive;
    double complete_up_to = 0.0;
    // Teichmueller coordinates (docs/shape_space.md), equal names in equal order for equal topological types.
    std::vector<double> coordinates;
    std::vector<std::string> names;
    double marking_gap = 0.0;  // smallest relative gap between the curve taken and the next best, over the
                               // choices that made the marking; small: unstable
    // Where neighbours are sought, Euclidean; one size per topological type.
    //   chi < 0: logarithms of the boundaries' lengths, ascending, then of the shortest other primitive ones,
    //   no more than 4 (3g - 3 + r), so that pants have their boundaries alone; torus: (Re, Im) of the
    //   reduced modulus; annulus: log of the modulus; sphere, disk: the descriptor of sphere_descriptor.h.
    std::vector<double> fingerprint;
    ShapeSeconds seconds;
};

/// Describes one connected surface. Numerical outcomes are a status; throws std::invalid_argument for options
/// that do not fit.
ShapeDescriptor describe_shape(const SurfaceMesh& mesh, const ShapeOptions& options);

/// Its parts for a hyperbolic surface that is there already; `d` has genus and boundaries. Lengths and
/// fingerprint; false, with status and message, where the budget ends before the fingerprint is full.
bool describe_spectrum(const CoarseSurface& surface, const ShapeOptions& options, ShapeDescriptor& d);
/// Coordinates by the marking of the rule, or a message why not.
void describe_coordinates(const CoarseSurface& surface, const ShapeOptions& options, ShapeDescriptor& d);

}  // namespace ricci
