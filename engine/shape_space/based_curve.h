// Closed curves as elements of the fundamental group at a vertex.
#pragma once

#include "engine/shape_space/closed_geodesic.h"
#include "engine/shape_space/exact_surface.h"

namespace ricci {

/// An oriented closed curve: an element of the fundamental group at a vertex, in the frame of that vertex.
struct BasedCurve {
    Index vertex = 0;
    Isometry<Exact> element;
};

inline Isometry<Exact> product(const Isometry<Exact>& x, const Isometry<Exact>& y) {
    return compose(-1, x, y);
}
template <class... More>
Isometry<Exact> product(const Isometry<Exact>& x, const Isometry<Exact>& y, const More&... more) {
    return product(product(x, y), more...);
}
/// t x t^-1.
inline Isometry<Exact> conjugated(const Isometry<Exact>& x, const Isometry<Exact>& t) {
    return product(t, x, inverse(t));
}

/// translation_length and axis_normal (closed_geodesic.h), rounded at the end.
double translation_length(const Isometry<Exact>& element);
Minkowski axis_normal(const Isometry<Exact>& element);

/// The same free homotopy class seen from a vertex that its geodesic passes: from vertex to vertex towards
/// the foot of the perpendicular. `carried` (unless null) becomes the isometry from the frame of the new
/// vertex to that of the old one.
BasedCurve moved_to_axis(const ExactSurface& surface, const BasedCurve& curve,
                         Isometry<Exact>* carried = nullptr);

/// A closed geodesic with what it takes to move from one of its passes to another.
struct BasedGeodesic {
    ClosedGeodesic geodesic;
    Isometry<Exact> element;              // in the frame of passes[0]
    std::vector<Isometry<Exact>> frames;  // per pass, from the frame of its vertex to that of passes[0]

    /// The element as seen from the vertex of a pass.
    [[nodiscard]] Isometry<Exact> at_pass(std::size_t pass) const {
        return conjugated(element, inverse(frames[pass]));
    }
};

/// All passes of the geodesic of a curve, each taken from the exact element: however long it is. Throws
/// std::runtime_error where the curve has no geodesic.
BasedGeodesic follow_curve(const ExactSurface& surface, const BasedCurve& curve);

/// The same without frames.
ClosedGeodesic geodesic_of(const CoarseSurface& surface, const BasedCurve& curve);

}  // namespace ricci
