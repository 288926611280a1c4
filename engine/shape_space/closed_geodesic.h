// A closed geodesic of a coarse surface, known by where it passes the vertices.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/layout/line.h"
#include "engine/shape_space/coarse_surface.h"

namespace ricci {

/// Vector of Minkowski space, (x, y, t) with product xx' + yy' - tt': a point, or the normal of a line
/// (line.h).
using Minkowski = LineNormal;

inline double minkowski(const Minkowski& x, const Minkowski& y) {
    return line_side(-1, x, y);
}

/// translation_length and translation_axis (line.h) of a hyperbolic element.
inline double translation_length(const Isometry<double>& element) {
    return translation_length(-1, element);
}
inline Minkowski axis_normal(const Isometry<double>& element) {
    return translation_axis(-1, element).value();
}

/// One lift of a closed geodesic within the radius of a vertex.
struct GeodesicPass {
    Index vertex = 0;
    Minkowski normal{};  // of the line in the frame of the vertex, oriented like the geodesic
    double offset =
        0.0;  // arc length from the foot of passes[0] to the foot of this vertex, modulo the length
};

/// A closed 1-form with integer periods, as its values along halfedges. // 3F
using Cocycle = std::vector<Index>;

struct ClosedGeodesic {
    double length = 0.0;
    std::vector<GeodesicPass> passes;  // all there are
    std::vector<Index> periods;        // of the cocycles that were asked for, along the geodesic's direction
};

/// Every pass of the closed geodesic that runs along `normal` in the frame of `vertex`: along its way, points
/// lie within the radius of a vertex of their face, and from one such vertex to the next an edge leads, so
/// following edges finds them all.
ClosedGeodesic follow_geodesic(const CoarseSurface& surface, Index vertex, const Minkowski& normal,
                               double length, std::span<const Cocycle> cocycles = {});

/// The translation by `length` along the line of `normal`: the element that axis_normal undoes.
Isometry<double> translation_along(const Minkowski& normal, double length);

/// Parameter along the line of `normal` of the foot of a point (on the hyperboloid), from the foot of the
/// origin.
double foot_parameter(const Minkowski& normal, const Minkowski& point);

/// Whether two unit normals are the same line and direction, up to rounding.
bool same_normal(const Minkowski& x, const Minkowski& y);

/// Whether the lines of two unit normals cross; rounding does not make a line cross itself.
bool lines_cross(const Minkowski& x, const Minkowski& y);

/// Where two closed geodesics cross: the crossing that is nearest to a vertex.
struct Meeting {
    Index vertex = 0;
    Minkowski first{}, second{};  // the normals there
    Minkowski point{};
};
std::optional<Meeting> nearest_meeting(const ClosedGeodesic& x, const ClosedGeodesic& y);

/// Number of transverse crossings; of a geodesic with itself each double point counts once.
Index crossings(const ClosedGeodesic& x, const ClosedGeodesic& y, const CoarseSurface& surface);
Index self_crossings(const ClosedGeodesic& x, const CoarseSurface& surface);

}  // namespace ricci
