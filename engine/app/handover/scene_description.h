// What scripts need to know of an item beyond its numbers: units, texts, colours.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/app/handover/handover.h"
#include "engine/app/handover/shown_field.h"

namespace ricci::app {

/// Name of the cell data that numbers the colours of a block; empty where there is none.
std::string colour_number(const std::string& block);

/// {item, source, software, command, length_unit, kappa, checker, field {name, unit, of_faces, low, high,
/// colours}, curve_colours, boundary_colour, blocks {}}; colours are sRGB from 0 to 1, `field` null where
/// none is shown. Blocks are added by describe_block.
nlohmann::json describe_scene(const ItemSource& source, const HandoverOptions& options,
                              const std::optional<ShownField>& field);

/// {kind, texture, colour_by, units {<data>/<name>}, texts {<data>/<name>: [...]}}.
nlohmann::json describe_block(const GeometryBlock& block);

/// As text; bytes that are not UTF-8 become \xNN.
std::string json_text(const nlohmann::json& value);

}  // namespace ricci::app
