// A surface's structure as the result file and as JSON keep it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/structure/surface_structure.h"
#include "io/store/result_group.h"

namespace ricci::app {

/// The group layout/ of an item (docs/hdf5.md). `copies`: deck transformations of a tessellation, or none.
ResultGroup make_layout_group(const std::string& item, const SurfaceMesh& mesh,
                              const SurfaceStructure& structure, const std::vector<Isometry<double>>& copies);

/// The interface's object of `ricci layout`, without `file` and `seconds`.
nlohmann::json layout_json(const SurfaceStructure& structure);

/// Matrix of a generator as the interface gives it: SL(2,R) hyperbolic, 3x3 rigid motion Euclidean, 3x3
/// rotation spherical.
nlohmann::json generator_matrix(int kappa, const Isometry<double>& element);

}  // namespace ricci::app
