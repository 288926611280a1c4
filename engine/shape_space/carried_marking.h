// A marking drawn on a mesh, to be carried along where the mesh moves and its triangles stay.
#pragma once

#include <string>
#include <vector>

#include "engine/shape_space/path_holonomy.h"
#include "engine/shape_space/teichmuller.h"

namespace ricci {

/// The curves of length coordinates as closed edge paths: homotopy classes that mean the same on every mesh
/// with the same triangles, however it lies in space.
struct DrawnMarking {
    std::vector<std::string> names;
    std::vector<EdgePath> curves;
};

/// `structure`: the one whose metric `surface` was made of; `input`: its mesh. Throws std::runtime_error
/// where a curve cannot be drawn (trace_geodesic).
DrawnMarking draw_marking(const SurfaceStructure& structure, const Connectivity& input,
                          const ExactSurface& surface, const TeichmullerCoordinates& coordinates);

/// Lengths of the curves on another hyperbolic structure of a mesh with the same triangles. The largest
/// spread (path_holonomy.h) goes to `spread`. Throws std::runtime_error where a curve has no geodesic there.
std::vector<double> carried_lengths(const DrawnMarking& marking, const SurfaceStructure& structure,
                                    const Connectivity& input, double& spread);

}  // namespace ricci
