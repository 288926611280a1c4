// What OpenMesh does for us; its headers are slow to compile and stay behind this one.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// Decimated to at most `target_faces` faces, or fewer by one, as far as legal collapses reach: halfedge
/// collapses in the order of quadric error (Garland, Heckbert 1997) over the fourth power of the worst new
/// triangle's quality, with quadrics of the boundary's own planes and a weak pull to even spacing where the
/// surface is flat. No collapse changes the topology, turns a face over or makes a sliver. The vertices are a
/// subset of the input's, in its order, with equal bits. Deterministic. Throws std::invalid_argument for an
/// intrinsic surface, or one that OpenMesh cannot represent.
SurfaceMesh decimate(const SurfaceMesh& mesh, Index target_faces);

}  // namespace ricci
