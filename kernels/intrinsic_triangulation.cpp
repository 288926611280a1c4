#include "kernels/intrinsic_triangulation.h"

#include <cmath>
#include <type_traits>

#include "kernels/extended.h"

namespace ricci {

namespace {

/// At least long double, whatever is asked for.
template <class Real>
using Accurate = std::conditional_t<std::is_floating_point_v<Real>, long double, Real>;

}  // namespace

template <class Real>
IntrinsicTriangulation<Real> intrinsic_triangulation(const SurfaceMesh& mesh) {
    IntrinsicTriangulation<Real> result;
    result.connectivity = mesh.connectivity;
    const Connectivity& c = mesh.connectivity;
    result.log_chord.resize(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const auto s = static_cast<std::size_t>(h);
        const Index t = c.twin[s];
        if (t != kNoTwin && t < h) {
            result.log_chord[s] = result.log_chord[static_cast<std::size_t>(t)];
            continue;
        }
        using std::log;
        Accurate<Real> log_length(0);
        if (!mesh.intrinsic()) {
            // From the points, not from the rounded lengths: slivers need every bit.
            const Point& p = mesh.points[static_cast<std::size_t>(c.tail[s])];
            const Point& q = mesh.points[static_cast<std::size_t>(c.head(h))];
            Accurate<Real> squares(0);
            for (std::size_t k = 0; k < 3; ++k) {
                const Accurate<Real> difference = Accurate<Real>(q[k]) - Accurate<Real>(p[k]);
                squares += difference * difference;
            }
            log_length = log(squares) / 2;
        } else {
            log_length = log(Accurate<Real>(mesh.edge_length[s]));
        }
        result.log_chord[s] = static_cast<Real>(log_length);
    }
    return result;
}

template IntrinsicTriangulation<double> intrinsic_triangulation<double>(const SurfaceMesh&);
template IntrinsicTriangulation<long double> intrinsic_triangulation<long double>(const SurfaceMesh&);
template IntrinsicTriangulation<WideReal> intrinsic_triangulation<WideReal>(const SurfaceMesh&);

IntrinsicTriangulation<double> rounded(const IntrinsicTriangulation<long double>& triangulation) {
    IntrinsicTriangulation<double> result;
    result.connectivity = triangulation.connectivity;
    result.log_chord.assign(triangulation.log_chord.begin(), triangulation.log_chord.end());
    return result;
}

}  // namespace ricci
