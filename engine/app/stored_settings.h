// How a run solved, from the configuration in its result file.
#pragma once

#include <optional>

#include "engine/flow/flow_surface.h"
#include "engine/flow/scheme.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// How a run solved, from its stored configuration.
struct StoredSettings {
    Scheme scheme = Scheme::vertex_scaling;
    Boundary boundary = Boundary::geodesic;
    bool delaunay = true, densify = false;
    double tolerance = 1e-10;
    std::optional<double> cone_curvature;
};
/// Throws FileError for a configuration that cannot be read.
StoredSettings settings_of(const StoredRun& run);

}  // namespace ricci::app
