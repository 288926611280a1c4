// Thesis section 5.3.1.2, step 2: finer sampling and higher valence around a singular vertex.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// What densify_around did.
struct DensifiedMesh {
    SurfaceMesh mesh;   // the same piecewise flat surface; old vertices keep their numbers, new ones follow
    Index valence = 0;  // of the vertex, afterwards
};

/// Raises the valence of `vertex` to at least `valence` by bisecting the edges opposite it, longest first,
/// then bisects all edges within `rings` rings `levels` times (red-green refinement), which leaves the new
/// vertices near it at valence 6. Interior vertex of an embedded surface. Throws std::invalid_argument for an
/// intrinsic surface.
DensifiedMesh densify_around(const SurfaceMesh& mesh, Index vertex, Index valence, int rings = 2,
                             int levels = 1);

}  // namespace ricci
