// Coordinates of a hyperbolic surface in Teichmueller space (thesis, section 6.3.4).
#pragma once

#include "engine/shape_space/marking.h"

namespace ricci {

/// A coordinate: the length of the closed geodesic of a curve.
struct LengthCoordinate {
    std::string name;
    BasedCurve curve;
    double length = 0.0;
};

/// A curve of the pants decomposition.
struct FenchelNielsen {
    std::string name;
    double length = 0.0,
           twist = 0.0;  // twist: a length, from where the dual curve (b, or y) would be shortest
};

/// Luo's coordinates in the building blocks of the thesis's Figures 42 to 44, for chi < 0, by the chain of
/// Marking:
///   every handle, block I: the lengths of a, b, ab;
///   every boundary: its length; every curve x2, x3, ... of the chain: its length;
///   blocks II and III, i.e. every curve s = e(i) (around handle i) or x(k) with pairs of pants on both sides
///   (that of e(i) closing up to the handle): the length of z(s), which meets s twice (dual_curves.h), and of
///   y(s) for the first such s.
/// 6g - 5 + 3r numbers, one more than the dimension: with y(s) there is the trace identity of the four-holed
/// sphere around the first s. Closed genus 2 has e1 = e2 = s: 3 + 3 + 1 with z(e1) but not y, and the
/// relation is that both handles agree in e. Pants: the three boundaries. (1,1): a, b, ab; the boundary
/// follows. At a given length of s, z has a twist between 3l/8 and 7l/8 by the choice of y, where its length
/// grows strictly with the twist, so the numbers determine the marked surface.
struct TeichmullerCoordinates {
    std::vector<LengthCoordinate> lengths;
    std::vector<FenchelNielsen> pants;   // a1, e1, a2, ..., x2, ...; boundaries have a length alone and come
                                         // as coordinates above
    std::vector<MarkingChoice> choices;  // of the marking, and of y(s)
    double smallest_gap = 0.0;
};

TeichmullerCoordinates teichmuller_coordinates(const ExactSurface& surface, const Marking& marking);
TeichmullerCoordinates teichmuller_coordinates(const CoarseSurface& surface, const Marking& marking);

/// Lengths of the seams of a pair of pants: the sides of its right-angled hexagon between halves of the
/// boundaries, seams[k] opposite boundary k (thesis, section 6.3.3.2).
std::array<double, 3> hexagon_seams(const std::array<double, 3>& boundary_lengths);

}  // namespace ricci
