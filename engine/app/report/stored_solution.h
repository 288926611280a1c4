// From a stored conformal factor back to the map and the layout that it means, without solving anything.
#pragma once

#include <optional>
#include <string>

#include "engine/app/stored_settings.h"
#include "engine/quality/conformality.h"
#include "engine/structure/surface_structure.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// A stored flow as the engine knows it. Throws FileError where its names mean nothing.
FlowResult flow_result_of(const FlowRecord& flow);

/// The metric with its only cone at the factor's vertex, as a sweep stored it: scaled to area 1.
FlowResult cone_result_of(const SurfaceMesh& mesh, const KeptFactor& kept, const StoredSettings& settings);

/// The map from the surface to the metric of a flow that converged.
ConformalityReport quality_of(const SurfaceMesh& mesh, const FlowResult& flow, bool delaunay);

}  // namespace ricci::app
