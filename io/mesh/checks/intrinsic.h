// Checks of an intrinsic surface.
#pragma once

#include "io/mesh/checks/defect_list.h"
#include "io/mesh/formats/polygon_soup.h"

namespace ricci {

/// Reports twin_mismatch, length_mismatch, triangle_inequality and non_manifold_vertex. Numbers are in range
/// and lengths positive (the parser saw to that).
void check_intrinsic(const IntrinsicSoup& soup, DefectList& errors);

}  // namespace ricci
