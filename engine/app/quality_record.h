// Quality reports and atlases as the result file and as JSON keep them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "engine/atlas/atlas_checks.h"
#include "engine/quality/conformality.h"
#include "io/store/result_group.h"

namespace ricci::app {

/// The groups quality/ and atlas/ of an item (docs/hdf5.md). `status`: of the flow.
ResultGroup make_quality_group(const std::string& item, std::uint8_t status,
                               const ConformalityReport& report);
ResultGroup make_atlas_group(const std::string& item, std::uint8_t status, const Atlas& atlas,
                             const AtlasChecks& checks);

nlohmann::json quality_json(const ConformalityReport& report);
nlohmann::json atlas_json(const Atlas& atlas, const AtlasChecks& checks);

/// "affine", "hyperbolic", "projective", "spherical"; "auto": by the curvature. Throws UsageError.
AtlasKind parse_atlas_kind(const std::string& text, int kappa);

}  // namespace ricci::app
