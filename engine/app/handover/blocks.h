// The makers of single blocks; see item_blocks.h. Each throws as make_block does.
#pragma once

#include "engine/app/handover/item_blocks.h"

namespace ricci::app::blocks {

GeometryBlock surface(const ItemSource& source);
GeometryBlock cones(const ItemSource& source);
GeometryBlock samples(const ItemSource& source);

GeometryBlock cut_surface(const ItemSource& source);
GeometryBlock layout(const ItemSource& source);
GeometryBlock domains(const ItemSource& source);
GeometryBlock outlines(const ItemSource& source);

GeometryBlock sides(const ItemSource& source);
GeometryBlock cut(const ItemSource& source);
GeometryBlock generators(const ItemSource& source);
GeometryBlock layout_generators(const ItemSource& source);
GeometryBlock geodesics(const ItemSource& source);
GeometryBlock curves(const ItemSource& source);
GeometryBlock loops(const ItemSource& source);

GeometryBlock charts(const ItemSource& source);

/// Whether any geodesic (curve, loop) was drawn on the mesh.
bool has_drawn(const ItemSource& source, const std::string& kind, const std::string& subgroup);
/// Cones of the flow's target, and the vertices that a sweep ranks first and last.
struct Cone {
    std::string name;
    Index vertex = 0;
    double curvature = 0.0;  // radians
};
std::vector<Cone> find_cones(const StoredItem& item);

}  // namespace ricci::app::blocks
