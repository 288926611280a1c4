// Closed geodesics of a coarse surface on the input surface, and their words.
#pragma once

#include <string>

#include "engine/shape_space/closed_geodesic.h"
#include "engine/shape_space/surface_curve.h"
#include "engine/structure/surface_structure.h"

namespace ricci {

/// The geodesic as a polyline on the input surface. `structure`: the one whose metric `surface` was made of.
/// Throws as trace_geodesic.
SurfaceCurve draw_geodesic(const SurfaceStructure& structure, const Connectivity& input,
                           const CoarseSurface& surface, const ClosedGeodesic& geodesic);

/// The free homotopy class of a closed edge path of the input in the canonical generators (thesis, Algorithm
/// 1): generator numbers as in SurfaceGroup::generators; cyclically reduced.
Word canonical_word(const SurfaceStructure& structure, std::span<const Step> path);

/// The same as text, in the generators' names.
std::string canonical_text(const SurfaceStructure& structure, std::span<const Index> word);

/// The length of the closed geodesic in the class of a word in the canonical generators, from the deck
/// transformations: hyperbolic surfaces, and flat ones (of area 1). 0 where there is none.
double word_length(const SurfaceStructure& structure, std::span<const Index> word);

/// The same for a closed edge path of the input, from the letters of the homotopy basis: shorter words, fewer
/// digits lost.
double loop_length(const SurfaceStructure& structure, std::span<const Step> path);

/// make_surface_structure with a flow as by solve_sharply (length_spectrum.h), and at most so many digits for
/// the group: words and curves are right whatever its digits.
SurfaceStructure make_sharp_structure(const SurfaceMesh& mesh, const FlowOptions& flow, int max_digits);

}  // namespace ricci
