// A length spectrum as the result file, JSON, curve files and pictures keep it.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/app/pictures/draw_curves.h"
#include "engine/shape_space/surface_spectrum.h"
#include "io/mesh/save_curves.h"
#include "io/store/result_group.h"

namespace ricci::app {

/// The group spectrum/ of an item (docs/hdf5.md).
ResultGroup make_spectrum_group(const std::string& item, const SurfaceSpectrum& spectrum);

/// The interface's object of `ricci spectrum`, without `file` and `seconds`.
nlohmann::json spectrum_json(const SurfaceSpectrum& spectrum);

/// The curves that were drawn: "g0", "g1", ... in the order of lengths.
std::vector<NamedCurve> named_curves(const SurfaceSpectrum& spectrum);
SvgPicture draw_spectrum(const SurfaceMesh& mesh, const SurfaceSpectrum& spectrum);

}  // namespace ricci::app
