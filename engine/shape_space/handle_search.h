// Handles of a surface: pairs of simple closed geodesics that meet once.
#pragma once

#include "engine/shape_space/marking.h"

namespace ricci {

/// a and b of a handle as closed geodesics.
struct HandleGeodesics {
    ClosedGeodesic a, b;
};

/// As many handles as the genus, by rule 1 of Marking; appends the choices that were made. Throws as
/// make_marking.
std::vector<HandleGeodesics> find_handles(const CoarseSurface& surface, const MarkingOptions& options,
                                          std::int64_t& budget, std::vector<MarkingChoice>& choices);

}  // namespace ricci
