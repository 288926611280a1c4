// Resolutions of one surface: decimation (by OpenMesh) and subdivision, topology kept and checked.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

struct ResampledMesh {
    SurfaceMesh mesh;  // input_vertex: identity (numbers are new)
    std::vector<Index>
        source_vertex;  // V of the new mesh: nearest vertex of the input (k-d tree, ties to the lowest)
};

/// The surface with `target_faces` faces, within 1 %: as it is when it already has so many; quadric
/// decimation (openmesh.h) when coarser; midpoint subdivision, which keeps the surface, and then decimation
/// when finer. Topological type (components, boundaries, genus) and positive face areas are checked. Unused
/// vertices are dropped wherever anything changes. Deterministic. Throws std::invalid_argument: an intrinsic
/// surface, a target below 4, or one that no sound sequence of collapses reaches (the message says how many
/// faces were left); std::runtime_error where the check fails.
ResampledMesh resample(const SurfaceMesh& mesh, Index target_faces);

/// One step of midpoint subdivision: every face into four, on the same piecewise flat surface, embedded or
/// intrinsic. New vertices follow the old ones, in order of edge number; face f becomes 4f .. 4f+2 at its
/// corners and 4f+3 in the middle. Throws std::invalid_argument where four times the faces exceed 32-bit
/// indices.
SurfaceMesh subdivide_midpoint(const SurfaceMesh& mesh);

/// One step of Loop subdivision, numbered like midpoint subdivision. Loop, Smooth subdivision surfaces based
/// on triangles (1987), with his weights; a boundary becomes a cubic spline of its own vertices. Throws
/// std::invalid_argument as above, and for an intrinsic surface.
SurfaceMesh subdivide_loop(const SurfaceMesh& mesh);

/// Throws std::invalid_argument where four times the faces exceed 32-bit indices.
void check_subdivision_size(const SurfaceMesh& mesh);

}  // namespace ricci
