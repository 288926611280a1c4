// The length spectrum of any surface that has one, with words and curves.
#pragma once

#include <string>

#include "engine/shape_space/length_spectrum.h"
#include "engine/shape_space/surface_curve.h"

namespace ricci {

struct SurfaceSpectrumOptions {
    FlowOptions flow;
    double max_length = 4.0;
    std::int64_t count = 0;
    std::int64_t budget = SpectrumOptions{}.budget;
    bool words = true;       // in the canonical generators
    bool draw = false;       // curves on the surface
    std::int64_t drawn = 0;  // of the so many shortest primitive ones; 0: of all
};

/// A primitive closed geodesic, up to orientation.
struct SurfaceGeodesic {
    double length = 0.0;
    Index boundary = -1;  // the boundary component that it is
    std::string word;     // "" where not asked for, or not to be had (message)
    SurfaceCurve curve;   // empty where not asked for
};

/// chi < 0: hyperbolic lengths; torus: in units of the shortest; annulus: of the core. Spheres and disks have
/// no closed geodesics in their spherical metrics but great circles: std::invalid_argument.
struct SurfaceSpectrum {
    Index genus = 0, boundaries = 0;
    Geometry geometry = Geometry::hyperbolic;
    Status status = Status::converged;
    MetricAccuracy accuracy;
    std::string message, unit;
    std::vector<double> lengths;        // ascending, powers included, with multiplicity
    std::vector<Index> power;           // 1: primitive
    std::vector<std::size_t> geodesic;  // index into geodesics
    std::vector<SurfaceGeodesic> geodesics;
    double complete_up_to = 0.0;
    double relator_error = 0.0;  // of the deck transformation group (surface_group.h)
    double word_error = 0.0;     // largest relative difference of a length from that of its word's deck
                                 // transformation, over words short enough for double
    SurfaceStructure structure;  // empty where neither words nor curves were asked for (hyperbolic)
};

/// `mesh` must outlive the result.
SurfaceSpectrum make_surface_spectrum(const SurfaceMesh& mesh, const SurfaceSpectrumOptions& options);

}  // namespace ricci
