#include "engine/app/report/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/app/pictures/picture_kinds.h"

namespace ricci::app {
namespace {

using nlohmann::json;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The box that coordinates are rounded in.
struct Box {
    Point low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    void add(const Point& p) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    [[nodiscard]] std::vector<std::uint16_t> rounded(const std::vector<Point>& points) const {
        std::vector<std::uint16_t> result;
        result.reserve(3 * points.size());
        for (const Point& p : points)
            for (std::size_t k = 0; k < 3; ++k) {
                const double extent = high[k] - low[k];
                const double t = extent > 0 ? std::clamp((p[k] - low[k]) / extent, 0.0, 1.0) : 0.5;
                result.push_back(static_cast<std::uint16_t>(std::lround(65535.0 * t)));
            }
        return result;
    }
};

template <class Rows>
json indices_json(const Rows& rows, std::size_t vertices, ByteStore& bytes) {
    if (vertices <= 65536) {
        std::vector<std::uint16_t> values;
        for (const auto& row : rows)
            for (const Index v : row) values.push_back(static_cast<std::uint16_t>(v));
        return bytes.add(std::span<const std::uint16_t>(values));
    }
    std::vector<std::uint32_t> values;
    for (const auto& row : rows)
        for (const Index v : row) values.push_back(static_cast<std::uint32_t>(v));
    return bytes.add(std::span<const std::uint32_t>(values));
}

json numbers_json(const std::vector<double>& values, NumberKind kind, ByteStore& bytes) {
    if (kind == NumberKind::doubles) return bytes.add(std::span<const double>(values));
    if (kind == NumberKind::floats) {
        const std::vector<float> narrow(values.begin(), values.end());
        return bytes.add(std::span<const float>(narrow));
    }
    std::vector<std::int32_t> whole;  // the smallest stands for none
    whole.reserve(values.size());
    for (const double v : values)
        whole.push_back(std::isfinite(v) ? static_cast<std::int32_t>(v)
                                         : std::numeric_limits<std::int32_t>::min());
    return bytes.add(std::span<const std::int32_t>(whole));
}

json field_json(const SceneField& field, const ViewMesh& mesh, ByteStore& bytes) {
    json object = {{"name", field.name}, {"unit", field.unit}};
    object["values"] = numbers_json(seen_values(mesh, field.values), field.kind, bytes);
    if (!field.words.empty()) object["words"] = field.words;
    if (field.colours) {
        const Axis& axis = field.colours->axis;
        object["low"] = axis.low();
        object["high"] = axis.high();
        object["log"] = axis.kind() == ScaleKind::logarithmic;
        object["map"] = field.colours->map == ColourMap::diverging ? "diverging" : "sequential";
        object["ticks"] = axis.ticks(5);
    }
    return object;
}

json texture_json(const SceneTexture& texture, const Box& box, ByteStore& bytes) {
    std::vector<float> uv;
    for (const auto& [u, v] : texture.uv) {
        uv.push_back(static_cast<float>(u));
        uv.push_back(static_cast<float>(v));
    }
    const std::vector<std::uint16_t> points = box.rounded(texture.points);
    return {{"name", texture.name},
            {"points", bytes.add(std::span<const std::uint16_t>(points))},
            {"uv", bytes.add(std::span<const float>(uv))},
            {"triangles", indices_json(texture.triangles, texture.points.size(), bytes)}};
}

json curve_json(const SceneCurve& curve, ByteStore& bytes) {
    std::vector<float> points;
    for (const Point& p : curve.points)
        for (const double x : p) points.push_back(static_cast<float>(x));
    return {{"name", curve.name},
            {"link", curve.link},
            {"colour", hexadecimal(curve.colour)},
            {"dashed", curve.dashed},
            {"hidden", curve.hidden},
            {"points", bytes.add(std::span<const float>(points))}};
}

json mark_json(const SceneMark& mark) {
    return {{"name", mark.name}, {"vertex", mark.vertex}, {"point", mark.point}};
}

}  // namespace

ColourScale fitting_scale(const std::vector<double>& values, std::optional<double> middle, double smallest) {
    std::vector<double> sorted;
    for (const double v : values)
        if (std::abs(v) <= 1e150) sorted.push_back(v);
    if (sorted.empty()) return {Axis(0.0, 1.0), ColourMap::sequential};
    std::sort(sorted.begin(), sorted.end());
    const auto quantile = [&](double q) {
        return sorted[static_cast<std::size_t>(std::lround(q * static_cast<double>(sorted.size() - 1)))];
    };
    double low = sorted.front(), high = sorted.back();
    if (middle) {
        const double all = std::max(high - *middle, *middle - low),
                     most = std::max(quantile(0.995) - *middle, *middle - quantile(0.005));
        // Few values that stand out (cones) would leave all others to rounding.
        const double reach = std::max(most > 1e-6 * all ? most : all, smallest);
        return {Axis(*middle - reach, *middle + reach), ColourMap::diverging};
    }
    const double inner_low = quantile(0.01), inner_high = quantile(0.99);
    if (low > 0.0 && high > 10.0 * low) {
        if (high > 10.0 * inner_high) high = inner_high;
        if (10.0 * low < inner_low) low = inner_low;
        return {Axis(low, high, ScaleKind::logarithmic), ColourMap::sequential};
    }
    const double range = inner_high - inner_low;
    if (range == 0.0) return {Axis(low, high), ColourMap::sequential};
    if (high > inner_high + range) high = inner_high;
    if (low < inner_low - range) low = inner_low;
    return {Axis(low, high), ColourMap::sequential};
}

double median_of(std::vector<double> values) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::optional<SceneTexture> layout_texture(const std::string& name, const StoredLayout& stored) {
    const CommonRefinement& r = stored.refinement;
    if (r.points.empty()) return std::nullopt;
    SceneTexture texture;
    texture.name = name;
    const double cell = checker_cell(stored);
    for (std::size_t l = 0; l < stored.layout.position.size(); ++l) {
        texture.points.push_back(r.points[at(stored.layout.refinement_vertex[l])]);
        const std::array<double, 2> uv = conformal_point(stored.layout.kappa, stored.layout.position[l]);
        texture.uv.push_back({uv[0] / cell, uv[1] / cell});
    }
    for (Index p = 0; p < r.piece_count(); ++p)
        for (Index c = r.first[at(p)] + 1; c + 1 < r.first[at(p) + 1]; ++c)
            texture.triangles.push_back({stored.layout.corner_vertex[at(r.first[at(p)])],
                                         stored.layout.corner_vertex[at(c)],
                                         stored.layout.corner_vertex[at(c) + 1]});
    return texture;
}

json scene_json(const Scene& scene, ByteStore& bytes) {
    Box box;
    for (const Point& p : scene.mesh.points) box.add(p);
    for (const SceneTexture& t : scene.textures)
        for (const Point& p : t.points) box.add(p);
    const std::vector<std::uint16_t> points = box.rounded(scene.mesh.points);
    json object = {{"title", scene.title},
                   {"low", box.low},
                   {"high", box.high},
                   {"faces", scene.mesh.faces},
                   {"decimated", scene.mesh.decimated},
                   {"shown", scene.mesh.shown},
                   {"points", bytes.add(std::span<const std::uint16_t>(points))},
                   {"triangles", indices_json(scene.mesh.triangles, scene.mesh.points.size(), bytes)},
                   {"vertex", bytes.add(std::span<const Index>(scene.mesh.vertex))},
                   {"fields", json::array()},
                   {"curves", json::array()},
                   {"marks", json::array()},
                   {"textures", json::array()}};
    for (const SceneField& f : scene.fields) object["fields"].push_back(field_json(f, scene.mesh, bytes));
    for (const SceneCurve& c : scene.curves) object["curves"].push_back(curve_json(c, bytes));
    for (const SceneMark& m : scene.marks) object["marks"].push_back(mark_json(m));
    for (const SceneTexture& t : scene.textures) object["textures"].push_back(texture_json(t, box, bytes));
    if (!scene.layout_points.empty()) {
        std::vector<float> flat;
        for (const auto& [x, y] : scene.layout_points) {
            flat.push_back(static_cast<float>(x));
            flat.push_back(static_cast<float>(y));
        }
        object["layout"] = {{"link", scene.layout_link},
                            {"points", bytes.add(std::span<const float>(flat))},
                            {"vertex", bytes.add(std::span<const Index>(scene.layout_vertex))}};
    }
    return object;
}

}  // namespace ricci::app
