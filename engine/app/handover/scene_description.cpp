#include "engine/app/handover/scene_description.h"

#include <utility>

#include "io/store/stored_text.h"

namespace ricci::app {
namespace {

using nlohmann::json;

json colour_json(const Colour& c) {
    return {c.red / 255.0, c.green / 255.0, c.blue / 255.0};
}

template <class Colours>
json colours_json(const Colours& colours) {
    json list = json::array();
    for (const Colour& c : colours) list.push_back(colour_json(c));
    return list;
}

constexpr std::size_t kSamples = 33;

json field_json(const std::optional<ShownField>& field) {
    if (!field) return nullptr;
    return {{"name", field->name},
            {"unit", field->unit},
            {"of_faces", field->of_faces},
            {"low", field->scale.axis.low()},
            {"high", field->scale.axis.high()},
            {"colours", colours_json(sample_colours(field->scale, kSamples))}};
}

void describe_arrays(const char* where, const std::vector<DataArray>& arrays, json& block) {
    for (const DataArray& array : arrays) {
        const std::string name = std::string(where) + "/" + array.name;
        if (!array.unit.empty()) block["units"][name] = array.unit;
        if (const auto* texts = std::get_if<std::vector<std::string>>(&array.values))
            block["texts"][name] = *texts;
    }
}

json with_valid_texts(json value) {
    if (value.is_string()) return hdf5::stored_text(value.get<std::string>());
    if (value.is_structured())
        for (json& inner : value) inner = with_valid_texts(std::move(inner));
    return value;
}

}  // namespace

std::string json_text(const nlohmann::json& value) {
    return with_valid_texts(value).dump();
}

std::string colour_number(const std::string& block) {
    if (block == "sides" || block == "cut") return "pair";
    if (block == "generators" || block == "layout_generators") return "generator";
    if (block == "geodesics") return "geodesic";
    if (block == "curves") return "curve";
    if (block == "loops") return "loop";
    if (block == "domains") return "copy_class";
    return "";
}

nlohmann::json describe_scene(const ItemSource& source, const HandoverOptions& options,
                              const std::optional<ShownField>& field) {
    constexpr Colour kBoundary{60, 66, 78};
    const ItemRecord& item = source.item().item;
    json scene = {{"item", item.name},
                  {"source", item.source},
                  {"software", "ricci " + source.info().software_version},
                  {"command", source.info().command},
                  {"length_unit", length_unit(source.item())},
                  {"checker", options.checker},
                  {"field", field_json(field)},
                  {"curve_colours", colours_json(kCategoryColours)},
                  {"boundary_colour", colour_json(kBoundary)},
                  {"blocks", json::object()}};
    scene["kappa"] = source.has_layout() ? json(source.layout().layout.kappa) : json(nullptr);
    return scene;
}

nlohmann::json describe_block(const GeometryBlock& block) {
    constexpr const char* kKinds[] = {"polygon", "line", "point"};
    json object = {{"kind", kKinds[static_cast<std::size_t>(block.kind)]},
                   {"texture", block.texture},
                   {"colour_by", colour_number(block.name)},
                   {"units", json::object()},
                   {"texts", json::object()}};
    describe_arrays("point_data", block.point_data, object);
    describe_arrays("cell_data", block.cell_data, object);
    describe_arrays("field_data", block.field_data, object);
    return object;
}

}  // namespace ricci::app
