#include "kernels/intrinsic_triangulation.h"

namespace ricci {

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
        long double log_length = 0;
        if (!mesh.intrinsic()) {
            // From the points, not from the rounded lengths: slivers need every bit.
            const Point& p = mesh.points[static_cast<std::size_t>(c.tail[s])];
            const Point& q = mesh.points[static_cast<std::size_t>(c.head(h))];
            long double squares = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const long double difference =
                    static_cast<long double>(q[k]) - static_cast<long double>(p[k]);
                squares += difference * difference;
            }
            log_length = std::log(squares) / 2;
        } else {
            log_length = std::log(static_cast<long double>(mesh.edge_length[s]));
        }
        result.log_chord[s] = static_cast<Real>(log_length);
    }
    return result;
}

template IntrinsicTriangulation<double> intrinsic_triangulation<double>(const SurfaceMesh&);
template IntrinsicTriangulation<long double> intrinsic_triangulation<long double>(const SurfaceMesh&);

IntrinsicTriangulation<double> rounded(const IntrinsicTriangulation<long double>& triangulation) {
    IntrinsicTriangulation<double> result;
    result.connectivity = triangulation.connectivity;
    result.log_chord.assign(triangulation.log_chord.begin(), triangulation.log_chord.end());
    return result;
}

}  // namespace ricci
