// What a layout may be asked for beyond itself: copies, quality of the map, an atlas.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/atlas/atlas_checks.h"
#include "engine/quality/conformality.h"
#include "engine/structure/surface_structure.h"

namespace ricci::app {

struct LayoutExtras {
    std::optional<ConformalityReport> quality;
    std::optional<Atlas> atlas;
    AtlasChecks checks;
};

struct LayoutExtrasOptions {
    bool quality = false;
    std::string atlas;  // auto, affine, hyperbolic, projective, spherical; "": none
    Index charts = 0;   // about so many; 0: by the number of faces
};

/// Nothing where the flow did not converge. Throws UsageError for an atlas that there is not.
LayoutExtras make_layout_extras(const SurfaceMesh& mesh, const SurfaceStructure& structure,
                                const LayoutExtrasOptions& options);

/// At most `copies` copies of the domain, hyperbolic ones within `distance` of the origin. Nothing where the
/// flow did not converge.
std::vector<Isometry<double>> tessellation_of(const SurfaceStructure& structure, std::int64_t copies,
                                              double distance);

}  // namespace ricci::app
