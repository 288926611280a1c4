// Everything that must hold before triangles become a surface.
#pragma once

#include <span>

#include "io/mesh/checks/defect_list.h"
#include "io/mesh/checks/triangle_soup.h"

namespace ricci {

/// Reports every defect of the triangles: duplicate_face, non_manifold_edge, unoriented, non_orientable,
/// non_manifold_vertex, zero_length_edge, zero_area_face; and fills the counts and qualities of `report` as
/// far as they are defined for such triangles. `soup` is not empty. `repair`: what was done already, so that
/// no message advises it again.
void diagnose(const TriangleSoup& soup, std::span<const Point> points, const RepairOptions& repair,
              MeshReport& report, DefectList& errors);

/// Fills the counts and qualities of `report` for a valid surface, embedded or intrinsic.
void describe(const SurfaceMesh& mesh, MeshReport& report);

}  // namespace ricci
