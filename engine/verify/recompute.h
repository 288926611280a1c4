// A second opinion on stored solutions. Shares no numerical code with the solver: its own connectivity,
// flips, lengths (numbers, not logarithms) and angles, scalar, in long double or 50 digits, by other formulas
// (law of cosines and half-angle tangents).
#pragma once

#include <span>
#include <vector>

#include "engine/flow/flow_surface.h"
#include "kernels/geometry.h"
#include "kernels/surface_mesh.h"

namespace ricci {

struct Recomputed {
    std::vector<double>
        curvature;  // V, radians; of the half where the surface is doubled; 0 for unused vertices
    double area_distortion = 0.0;     // thesis section 5.3.1.2, over the input's faces
    double gauss_bonnet_error = 0.0;  // |sum K + kappa A - 2 pi chi|, the area not from angles
    std::int64_t isometric_flips = 0, ptolemy_flips = 0;
    std::int64_t non_delaunay = 0;    // edges of the final triangulation that fail the test after all flips
    bool valid = true;                // false: some final face is no triangle, or the flips did not end
    std::vector<Triangle> triangles;  // scaling: corners of the final faces (of the double where doubled)
};

/// Vertex scaling: lengths of `mesh`, isometric Delaunay (where `delaunay`), Ptolemy flips to Delaunay at `u`
/// (V), angles. Boundary other than free: on the double. `digits`: up to 19, in long double; above, in 50.
Recomputed recompute_scaling(const SurfaceMesh& mesh, ConformalFactor u, Geometry geometry, Boundary boundary,
                             bool delaunay, int digits = 19);

/// Circle packing on the input triangulation. `eta`: 3F, `eps`, `u`: V.
Recomputed recompute_packing(const SurfaceMesh& mesh, std::span<const double> eta,
                             std::span<const double> eps, std::span<const double> u, Geometry geometry);

}  // namespace ricci
