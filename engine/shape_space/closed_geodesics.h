// All closed geodesics of a coarse surface up to a length.
#pragma once

#include <limits>

#include "engine/shape_space/closed_geodesic.h"

namespace ricci {

struct ClosedGeodesics {
    std::vector<ClosedGeodesic> primitive;  // ascending by length, each once, up to orientation
    double complete_up_to = 0.0;            // proved: every primitive one up to here is among them
    std::int64_t crossed = 0;               // edges of the universal cover that were crossed
    std::int64_t missed =
        0;  // passes that the enumeration at their own vertex did not find: 0, but for rounding
};

/// A closed geodesic of length L that comes within r of p is the axis of an element with d(p, gp) <= 2
/// asinh(cosh r sinh(L/2)) (the idea: Hodgson, Weeks 1994; here exact for the hyperbolic plane). Every point
/// of a coarse surface lies within the radius of a vertex, so the elements found around all vertices have
/// every axis. Axes are the same closed geodesic where following one leads to the other. Stops at `budget`
/// crossings of edges, with nothing found and complete_up_to 0.
ClosedGeodesics find_closed_geodesics(const CoarseSurface& surface, double max_length,
                                      std::int64_t budget = std::numeric_limits<std::int64_t>::max(),
                                      std::span<const Cocycle> cocycles = {});

/// A line at a vertex that is the axis of a closed geodesic.
struct AxisAt {
    double length = 0.0;  // the shortest translation along it
    Minkowski normal{};
    Isometry<double> element{};
};
/// All lines within the radius of `vertex` that are axes up to `max_length`, each once, ascending by length.
/// `budget` goes down by the edges crossed; negative: it ended first.
std::vector<AxisAt> axes_at(const CoarseSurface& surface, Index vertex, double max_length,
                            std::int64_t& budget);

}  // namespace ricci
