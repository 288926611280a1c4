// A triangulation known by its edge lengths alone, kept as logarithms: single-cone metrics span e^-48 … e^48.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "kernels/connectivity.h"
#include "kernels/surface_mesh.h"

namespace ricci {

/// Connectivity with the logarithm of every chord at u = 0. In the metric u the chord of halfedge h = i->j is
/// exp(log_chord[h] + (u_i + u_j)/2): Ptolemy flips commute with that, so log_chord never changes with u.
template <class Real>
struct IntrinsicTriangulation {
    Connectivity connectivity;
    std::vector<Real> log_chord;  // 3F, equal on twins
};

/// The surface's own triangulation; logarithms taken in long double, or in Real where that has more digits.
template <class Real>
IntrinsicTriangulation<Real> intrinsic_triangulation(const SurfaceMesh& mesh);

/// Rounds to double.
IntrinsicTriangulation<double> rounded(const IntrinsicTriangulation<long double>& triangulation);

}  // namespace ricci
