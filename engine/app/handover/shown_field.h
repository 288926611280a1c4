// The field that colours a surface where a file or script shows one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/app/handover/item_fields.h"
#include "io/picture/colour_map.h"

namespace ricci::app {

struct ShownField {
    std::string name, unit;
    bool of_faces = false;
    ColourScale scale;
};

/// `wanted`: a name; "none"; "auto": the area distortion of a sweep; nothing where there is a layout, whose
/// checkerboard shows more; else the conformal factor of the flow. Values around zero have the diverging
/// colours, symmetric about it; ranges leave out one per cent at each end. Throws UsageError naming the
/// fields there are.
std::optional<ShownField> choose_field(const StoredItem& item, const std::string& wanted, bool has_layout);

/// Its values at vertices; at a vertex of faces with values, the mean of these. // V
std::vector<double> values_at_vertices(const StoredItem& item, const ShownField& field);

/// `count` colours of the scale from its low end to its high one.
std::vector<Colour> sample_colours(const ColourScale& scale, std::size_t count);

}  // namespace ricci::app
