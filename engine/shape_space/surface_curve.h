// Closed geodesics of the final metric as curves on the input surface.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/shape_space/line_walk.h"
#include "engine/topology/edge_path.h"

namespace ricci {

/// A closed geodesic in the frame of a final face. kappa -1 or 0.
struct GeodesicStart {
    Index final_face = -1;
    std::array<double, 3> point{};  // on the geodesic, as a vector (x, t) of isometry.h; in or on the face
    LineNormal normal{};            // of its plane through the origin, as in line_walk.h: any size; the
                                    // positive side is on the left
    double length = 0.0;            // once around
};

/// A closed curve on the input surface: straight in every piece of the common refinement.
struct SurfaceCurve {
    std::vector<Point> points;    // S+1, the last is the first; empty for intrinsic surfaces
    std::vector<Index> face;      // S, input face of each segment
    std::vector<double> lengths;  // S, in the final metric
    EdgePath path;                // closed edge path of the input mesh, homotopic to the curve
    double length = 0.0;          // in the final metric, measured along the curve
    double closing_error = 0.0;   // in the final metric: how far apart the two halves are where they meet
};

/// Draws the geodesic. It is followed from `point` both ways, half its length each, so that errors grow to
/// e^(length/2) times theirs at the start only; then, in the hyperbolic plane, its axis is taken anew from
/// the isometry of the faces that were crossed, which depends on `start` no more, and followed again. So
/// lengths up to about 40 close, and starts need not be exact. The curve begins where it leaves the piece of
/// `point`.
///
/// Vertices of the refinement that the geodesic meets lie on its left; where it leaves the surface that way,
/// it is followed once more with them on its right: so geodesics along the boundary, and others as near to it
/// as rounding, are drawn too. Costs time in proportion to the pieces passed, and to all pieces once.
///
/// Throws std::invalid_argument for a face out of range, a length that is not positive, kappa = 1;
/// std::runtime_error where the geodesic misses its face or the surface (the mirror half of a double is not
/// part of it), where it does not close, and LeavesSurface (line_walk.h), naming the boundary edge, where it
/// leaves the surface, as only lines do that are no closed geodesics of it, or ones too long to follow.
SurfaceCurve trace_geodesic(const CommonRefinement& refinement, const FinalMetric<double>& metric,
                            const Connectivity& input, const GeodesicStart& start);

/// The start of a closed geodesic that is known by its line in the frame of the final face of a piece (in
/// that of halfedge h: moved_line(kappa, metric.to_halfedge(h), line)), near or far: the walk goes from the
/// middle of the piece straight to the line. Throws std::runtime_error as above where it leaves the surface.
GeodesicStart start_on_line(const CommonRefinement& refinement, const FinalMetric<double>& metric,
                            Index piece, const LineNormal& line, double length);

/// The same for a deck transformation that is a translation, run in its direction. `element` is given in the
/// frame of the final face of the piece of `corner`, as a Holonomy gives it at home(base). In the plane,
/// where all parallels are closed, the one through the middle of that piece. Throws std::invalid_argument
/// where `element` is no translation.
GeodesicStart start_on_axis(const CommonRefinement& refinement, const FinalMetric<double>& metric,
                            Index corner, const Isometry<double>& element);

/// An edge path homotopic to a closed curve that leaves faces across `crossed`, in order: each crossing is
/// moved to the tail of its halfedge, on the right of the curve. Not shortened.
EdgePath path_along(const Connectivity& input, std::span<const Index> crossed);

}  // namespace ricci
