// A surface's structure as the result file and as JSON keep it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/structure/surface_structure.h"
#include "io/mesh/save_textured.h"
#include "io/store/result_group.h"

namespace ricci::app {

/// The group layout/ of an item (docs/hdf5.md).
ResultGroup make_layout_group(const std::string& item, const SurfaceMesh& mesh,
                              const SurfaceStructure& structure);

/// The interface's object of `ricci layout`, without `file` and `seconds`.
nlohmann::json layout_json(const SurfaceStructure& structure);

/// Matrix of a generator as the interface gives it: SL(2,R) hyperbolic, 3x3 rigid motion Euclidean, 3x3
/// rotation spherical.
nlohmann::json generator_matrix(int kappa, const Isometry<double>& element);

enum class LayoutModel : std::uint8_t { conformal, klein, half_plane };
/// "poincare", "plane", "disk" and "sphere" are names of the conformal model.
LayoutModel parse_layout_model(const std::string& text);
std::array<double, 2> model_point(LayoutModel model, int kappa, const std::array<double, 3>& position);

/// The refined input with layout coordinates as texture coordinates: convex pieces, the input's vertices
/// first. Disk models are moved from [-1, 1] to [0, 1].
TexturedMesh textured_surface(const SurfaceMesh& mesh, const SurfaceStructure& structure, LayoutModel model);

/// The layout itself as a mesh in space: the sphere, or the plane z = 0. One point per layout vertex.
TexturedMesh layout_surface(const SurfaceStructure& structure, LayoutModel model);

}  // namespace ricci::app
