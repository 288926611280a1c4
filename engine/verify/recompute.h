// A second opinion on stored solutions. Shares no numerical code with the solver: its own connectivity,
// flips, lengths and angles, scalar, in long double, by other formulas (law of cosines and half-angle
// tangents).
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
    double area_distortion = 0.0;  // thesis section 5.3.1.2, over the input's faces
    std::int64_t isometric_flips = 0, ptolemy_flips = 0;
    bool valid = true;  // false: some final face is no triangle, or the flips did not end
};

/// Vertex scaling: lengths of `mesh`, isometric Delaunay (where `delaunay`), Ptolemy flips to Delaunay at `u`
/// (V), angles. Boundary other than free: on the double.
Recomputed recompute_scaling(const SurfaceMesh& mesh, std::span<const double> u, Geometry geometry,
                             Boundary boundary, bool delaunay);

/// Circle packing on the input triangulation. `eta`: 3F, `eps`, `u`: V.
Recomputed recompute_packing(const SurfaceMesh& mesh, std::span<const double> eta,
                             std::span<const double> eps, std::span<const double> u, Geometry geometry);

}  // namespace ricci
