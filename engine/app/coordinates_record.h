// Coordinates in shape space as the result file, JSON, curve files and pictures keep them.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/shape_space/surface_coordinates.h"
#include "io/mesh/save_curves.h"
#include "io/store/result_group.h"

namespace ricci::app {

/// The group teichmuller/ of an item (docs/hdf5.md).
ResultGroup make_coordinates_group(const std::string& item, const SurfaceCoordinates& coordinates);

/// The interface's object of `ricci teichmuller`, without `file` and `seconds`.
nlohmann::json coordinates_json(const SurfaceCoordinates& coordinates);

/// The coordinates' curves that were drawn, by their names.
std::vector<NamedCurve> named_curves(const SurfaceCoordinates& coordinates);

}  // namespace ricci::app
