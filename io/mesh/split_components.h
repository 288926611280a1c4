// Connected components of a surface.
#pragma once

#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

/// A connected surface as it is (unused vertices included), or the components of one that is not: ordered by
/// lowest vertex, vertices and faces in ascending order without the unused ones, input_vertex telling the
/// numbers before.
std::vector<SurfaceMesh> split_components(SurfaceMesh mesh);

}  // namespace ricci
