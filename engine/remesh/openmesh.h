// What OpenMesh does for us; its headers are slow to compile and stay behind this one.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// Decimated to at most `target_faces` faces, or fewer by one, as far as legal collapses reach: halfedge
/// collapses in the order of quadric error (Garland, Heckbert 1997) over the fourth power of the worst new
/// triangle's quality, with quadrics of the boundary's own planes and a weak pull to even spacing where the
/// surface is flat. In the end every vertex goes where the quadrics it gathered are least: on a curved
/// surface that halves the error of a subset of the input's vertices, which would all lie on one side of the
/// faces' mean. Nothing changes the topology, turns a face over or makes a sliver. The vertices stand in the
/// order of those they come from. Deterministic. Throws std::invalid_argument for an intrinsic surface, or
/// one that OpenMesh cannot represent.
SurfaceMesh decimate(const SurfaceMesh& mesh, Index target_faces);

}  // namespace ricci
