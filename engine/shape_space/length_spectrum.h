// The complete length spectrum of a hyperbolic surface (thesis, section 6.3.3).
#pragma once

#include <algorithm>

#include "engine/shape_space/closed_geodesics.h"
#include "engine/structure/surface_structure.h"

namespace ricci {

/// A length of the spectrum: a closed geodesic up to orientation, or a power of one.
struct SpectrumLength {
    double length = 0.0;
    std::size_t geodesic = 0;  // index into LengthSpectrum::geodesics
    Index power = 1;           // 1: primitive
};

struct LengthSpectrum {
    std::vector<SpectrumLength> lengths;    // ascending, each once: multiplicity is how often a length occurs
    std::vector<ClosedGeodesic> geodesics;  // primitive ones, ascending
    std::vector<Index> boundary;  // per geodesic: the boundary component of the coarse surface that it is,
                                  // or -1
    double complete_up_to = 0.0;  // proved: all of them up to here are listed
    std::int64_t crossed = 0;     // edges of the universal cover that were crossed
};

struct SpectrumOptions {
    double max_length = 4.0;
    std::int64_t count = 0;  // > 0: as many as complete the multiplet of the count-th, instead of max_length
    std::int64_t inner_count = 0;  // > 0: at least so many primitive ones that are no boundary too, beyond
                                   // max_length if need be
    std::int64_t budget = 2000000000;  // edges of the universal cover to cross: some minutes
};

/// Lengths are those of the surface itself (not of its double), boundaries each once. Where the budget ends
/// first, complete_up_to is smaller than asked for.
LengthSpectrum length_spectrum(const CoarseSurface& surface, const SpectrumOptions& options = {});

/// Boundary components of the input (in the order of boundary_loops) by those of the coarse surface. // r
std::vector<Index> input_boundaries(const CoarseSurface& surface, const Connectivity& input);

/// Solves to 1e-12, where the requested tolerance is not smaller, since errors of lengths are those of
/// curvature summed up; where that is out of reach, to the requested one. `solve(options)` returns the
/// status.
template <class Solve>
void solve_sharply(const FlowOptions& options, Solve&& solve) {
    FlowOptions sharp = options;
    sharp.tolerance = std::min(options.tolerance, 1e-12);
    sharp.tolerated_rounding = 0.1 * options.tolerance;
    const Status status = solve(sharp);
    if ((status == Status::stalled || status == Status::max_iterations) &&
        sharp.tolerance < options.tolerance)
        solve(options);
}
FlowResult solve_sharply(const SurfaceMesh& mesh, const FlowOptions& options);

/// The smooth hyperbolic surface of a converged flow, closed or with geodesic boundary. `refinement`,
/// `metric`: where they are known already; surfaces with boundary need them, and make them otherwise.
CoarseSurface coarse_surface_of(const SurfaceMesh& mesh, const FlowResult& flow, bool delaunay,
                                const CommonRefinement* refinement = nullptr,
                                const FinalMetric<double>* metric = nullptr);

}  // namespace ricci
