#include "engine/app/handover/shown_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/app/console.h"
#include "engine/app/pictures/layout_pictures.h"

namespace ricci::app {
namespace {

bool is_scalar(const DataArray& field) {
    return field.components == 1 && std::holds_alternative<std::vector<double>>(field.values);
}

bool around_zero(const std::string& name) {
    return name.find("conformal_factor") != std::string::npos ||
           name.find("curvature") != std::string::npos || name == "log_area_ratio";
}

ColourScale scale_of(const std::string& name, const std::vector<double>& values) {
    std::vector<double> finite;
    std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
                 [](double v) { return std::isfinite(v); });
    if (finite.empty()) finite = {0.0};
    const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
    const double least = *low, greatest = *high, width = greatest - least;
    FaceColours colours =
        around_zero(name) ? diverging_colours(finite, 0.0, name) : sequential_colours(finite, name);
    // A few values that stand out (cones) are all there is to see.
    if (colours.scale.axis.high() - colours.scale.axis.low() < 1e-6 * width) {
        const double most = std::max(std::abs(least), std::abs(greatest));
        colours.scale.axis = around_zero(name) ? Axis(-most, most) : Axis(least, greatest);
    }
    return colours.scale;
}

std::optional<ShownField> find_field(const StoredItem& item, const std::string& name, bool of_faces) {
    for (const DataArray& field : of_faces ? face_fields(item) : vertex_fields(item))
        if (field.name == name && is_scalar(field))
            return ShownField{name, field.unit, of_faces,
                              scale_of(name, std::get<std::vector<double>>(field.values))};
    return std::nullopt;
}

}  // namespace

std::optional<ShownField> choose_field(const StoredItem& item, const std::string& wanted, bool has_layout) {
    if (wanted == "none") return std::nullopt;
    if (wanted == "auto") {
        if (item.sweep) return find_field(item, "area_distortion", false);
        return has_layout ? std::nullopt : find_field(item, "conformal_factor", false);
    }
    for (const bool of_faces : {false, true})
        if (std::optional<ShownField> found = find_field(item, wanted, of_faces)) return found;
    std::string known = "auto, none";
    for (const bool of_faces : {false, true})
        for (const DataArray& field : of_faces ? face_fields(item) : vertex_fields(item))
            if (is_scalar(field)) known += ", " + field.name;
    throw UsageError(fmt::format("{} has no field '{}' (known: {})", item.item.name, wanted, known));
}

std::vector<double> values_at_vertices(const StoredItem& item, const ShownField& shown) {
    for (const DataArray& field : shown.of_faces ? face_fields(item) : vertex_fields(item)) {
        if (field.name != shown.name) continue;
        const auto& values = std::get<std::vector<double>>(field.values);
        if (!shown.of_faces) return values;
        std::vector<double> sum(vertex_count(item), 0.0);
        std::vector<int> count(sum.size(), 0);
        for (std::size_t f = 0; f < values.size(); ++f)
            for (const Index v : item.item.triangles[f])
                if (std::isfinite(values[f])) {
                    sum[static_cast<std::size_t>(v)] += values[f];
                    ++count[static_cast<std::size_t>(v)];
                }
        for (std::size_t v = 0; v < sum.size(); ++v)
            sum[v] = count[v] > 0 ? sum[v] / count[v] : std::numeric_limits<double>::quiet_NaN();
        return sum;
    }
    return std::vector<double>(vertex_count(item), std::numeric_limits<double>::quiet_NaN());
}

std::vector<Colour> sample_colours(const ColourScale& scale, std::size_t count) {
    std::vector<Colour> colours;
    for (std::size_t i = 0; i < count; ++i)
        colours.push_back(colour_at(scale.map, static_cast<double>(i) / static_cast<double>(count - 1)));
    return colours;
}

}  // namespace ricci::app
