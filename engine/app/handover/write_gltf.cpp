#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/app/console.h"
#include "engine/app/handover/blocks.h"
#include "engine/app/handover/handover.h"
#include "engine/app/handover/refined_field.h"
#include "engine/app/handover/scene_description.h"
#include "io/exchange/gltf.h"
#include "io/exchange/vertex_normals.h"
#include "io/picture/checker_image.h"

namespace ricci::app {
namespace {

using nlohmann::json;

/// Materials: the surface plain and with the checkerboard, the boundary's grey, cones, then a colour each for
/// curves.
constexpr std::size_t kPlain = 0, kTextured = 1, kBoundary = 2, kMarker = 3, kPoint = 4, kFirstCurve = 5;

std::vector<GltfMaterial> all_materials() {
    std::vector<GltfMaterial> materials = {{"surface", kWhite, true, false, true},
                                           {"checkerboard", kWhite, true, true, true},
                                           {"boundary", {60, 66, 78}, false, false, false},
                                           {"cone", {30, 30, 30}, true, false, false},
                                           {"point", kWhite, false, false, false}};
    for (std::size_t k = 0; k < kCategoryColours.size(); ++k)
        materials.push_back({fmt::format("curve {}", k), kCategoryColours[k], false, false, false});
    return materials;
}

/// Leaves out materials that nothing has, and the texture with them.
void drop_unused(GltfDocument& document) {
    std::vector<std::size_t> number(document.materials.size(), document.materials.size());
    std::vector<GltfMaterial> used;
    for (GltfMesh& mesh : document.meshes)
        for (GltfPrimitive& primitive : mesh.primitives) {
            std::size_t& place = number[primitive.material];
            if (place == number.size()) {
                place = used.size();
                used.push_back(document.materials[primitive.material]);
            }
            primitive.material = place;
        }
    document.materials = std::move(used);
    if (std::none_of(document.materials.begin(), document.materials.end(),
                     [](const GltfMaterial& material) { return material.textured; }))
        document.texture_png.clear();
}

/// "area_distortion" as "_AREA_DISTORTION": what glTF wants of an application's own attributes.
std::string attribute_name(const std::string& name) {
    std::string text = "_";
    for (const char c : name) {
        if (c >= 'a' && c <= 'z')
            text += static_cast<char>(c - 'a' + 'A');
        else
            text += (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
    }
    return text;
}

bool fits_single(double value) {
    return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

/// Per-point values of a block as attributes. glTF forbids NaN: where a value is missing there is 0, and
/// a second attribute, ..._KNOWN, says 0 there and 1 elsewhere.
void add_fields(const GeometryBlock& block, GltfPrimitive& primitive, json& units) {
    constexpr std::size_t kExact = std::size_t{1} << 24U;  // numbers that single precision counts up to
    for (const DataArray& field : block.point_data) {
        const std::string name = attribute_name(field.name);
        if (const auto* numbers = std::get_if<std::vector<std::int32_t>>(&field.values)) {
            if (field.components == 1 && field.name == "vertex" && block.points.size() < kExact)
                primitive.attributes.push_back(
                    {name, "", 1, std::vector<double>(numbers->begin(), numbers->end())});
            continue;
        }
        const auto* values = std::get_if<std::vector<double>>(&field.values);
        if (values == nullptr || field.components != 1) continue;
        std::vector<double> shown(*values), known(values->size(), 1.0);
        bool all = true;
        for (std::size_t i = 0; i < shown.size(); ++i)
            if (!fits_single(shown[i])) shown[i] = known[i] = 0.0, all = false;
        primitive.attributes.push_back({name, "", 1, std::move(shown)});
        if (!all) primitive.attributes.push_back({name + "_KNOWN", "", 1, std::move(known)});
        units[name] = field.unit;
    }
}

/// The field's value at every point of the block.
std::vector<double> shown_values(const ItemSource& source, const GeometryBlock& block,
                                 const ShownField& field) {
    const DataArray* vertex = find_array(block.point_data, "vertex");
    const std::vector<double> at_vertices = values_at_vertices(source.item(), field);
    if (vertex == nullptr) return at_vertices;
    const RefinedField refined(source.layout().refinement, source.item().item.triangles,
                               vertex_count(source.item()));
    const std::vector<double> on_pieces = refined.on_refinement(at_vertices);
    std::vector<double> values;
    for (const Index v : std::get<std::vector<std::int32_t>>(vertex->values))
        values.push_back(on_pieces[static_cast<std::size_t>(v)]);
    return values;
}

void add_texture(const GeometryBlock& block, GltfPrimitive& primitive) {
    const std::vector<double>* uv = find_doubles(block.point_data, block.texture);
    if (uv == nullptr || !std::all_of(uv->begin(), uv->end(), fits_single)) return;
    for (std::size_t i = 0; i + 1 < uv->size(); i += 2) primitive.uv.push_back({(*uv)[i], (*uv)[i + 1]});
}

std::vector<Point> normals_of(const GeometryBlock& block) {
    const std::vector<double>* stored = find_doubles(block.point_data, block.normals);
    if (stored == nullptr) return vertex_normals(block, {});
    std::vector<Point> normals;
    for (std::size_t i = 0; i + 2 < stored->size(); i += 3)
        normals.push_back({(*stored)[i], (*stored)[i + 1], (*stored)[i + 2]});
    return normals;
}

GltfMesh surface_mesh(const ItemSource& source, GeometryBlock block, const std::optional<ShownField>& field,
                      bool textured) {
    GltfPrimitive primitive;
    primitive.normals = normals_of(block);
    if (textured) add_texture(block, primitive);
    primitive.material = primitive.uv.empty() ? kPlain : kTextured;
    if (field && block.name != "domains")
        for (const double value : shown_values(source, block, *field))
            primitive.colours.push_back(field->scale.colour_of(value));
    json units = json::object();
    add_fields(block, primitive, units);
    primitive.extras = {{"units", std::move(units)}};
    for (std::size_t i = 0; i < block.cell_count(); ++i) {
        const auto cell = block.cell(i);  // convex: a fan
        for (std::size_t k = 1; k + 1 < cell.size(); ++k)
            primitive.indices.insert(primitive.indices.end(), {cell[0], cell[k], cell[k + 1]});
    }
    primitive.points = std::move(block.points);
    return {block.name, {std::move(primitive)}};
}

/// Points in the colours of the field.
GltfMesh point_mesh(const GeometryBlock& block, const std::optional<ShownField>& field) {
    GltfPrimitive primitive;
    primitive.mode = GltfMode::points;
    primitive.material = kPoint;
    primitive.points = block.points;
    const std::vector<double>* values = field ? find_doubles(block.point_data, field->name) : nullptr;
    if (values != nullptr)
        for (const double value : *values) primitive.colours.push_back(field->scale.colour_of(value));
    json units = json::object();
    add_fields(block, primitive, units);
    primitive.extras = {{"units", std::move(units)}};
    return {block.name, {std::move(primitive)}};
}

/// What cell data say of one cell.
json cell_extras(const GeometryBlock& block, std::size_t cell) {
    json extras = json::object();
    for (const DataArray& array : block.cell_data) {
        json values = json::array();
        std::visit(
            [&](const auto& list) {
                for (std::size_t k = 0; k < array.components; ++k)
                    values.push_back(list[array.components * cell + k]);
            },
            array.values);
        extras[array.name] = array.components == 1 ? values[0] : values;
        if (!array.unit.empty() && array.unit != "1") extras[array.name + "_unit"] = array.unit;
    }
    return extras;
}

std::size_t curve_material(const GeometryBlock& block, std::size_t cell) {
    const DataArray* number = find_array(block.cell_data, colour_number(block.name));
    if (number == nullptr) return kBoundary;
    const std::int32_t k = std::get<std::vector<std::int32_t>>(number->values)[cell];
    return k < 0 ? kBoundary : kFirstCurve + static_cast<std::size_t>(k) % kCategoryColours.size();
}

GltfMesh curve_mesh(const GeometryBlock& block) {
    GltfMesh mesh{block.name, {}};
    for (std::size_t i = 0; i < block.cell_count(); ++i) {
        GltfPrimitive& primitive = mesh.primitives.emplace_back();
        primitive.mode = GltfMode::line_strip;
        primitive.material = curve_material(block, i);
        for (const Index v : block.cell(i))
            primitive.points.push_back(block.points[static_cast<std::size_t>(v)]);
        primitive.extras = cell_extras(block, i);
    }
    return mesh;
}

/// An octahedron, each face cut into sixteen, on the unit sphere.
GltfMesh marker_mesh() {
    GeometryBlock ball;
    ball.name = "marker";
    ball.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<Triangle> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                   {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int round = 0; round < 2; ++round) {
        std::map<std::pair<Index, Index>, Index> middle;
        std::vector<Triangle> finer;
        const auto between = [&](Index a, Index b) {
            const auto [found, fresh] =
                middle.emplace(std::minmax(a, b), static_cast<Index>(ball.points.size()));
            if (!fresh) return found->second;
            const Point &p = ball.points[static_cast<std::size_t>(a)],
                        &q = ball.points[static_cast<std::size_t>(b)];
            Point m{p[0] + q[0], p[1] + q[1], p[2] + q[2]};
            const double length = std::hypot(m[0], m[1], m[2]);
            for (double& x : m) x /= length;
            ball.points.push_back(m);
            return found->second;
        };
        for (const auto& [a, b, c] : faces) {
            const Index ab = between(a, b), bc = between(b, c), ca = between(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        faces = std::move(finer);
    }
    GltfPrimitive primitive;
    primitive.material = kMarker;
    primitive.points = primitive.normals = ball.points;
    for (const Triangle& face : faces)
        primitive.indices.insert(primitive.indices.end(), face.begin(), face.end());
    return {"marker", {std::move(primitive)}};
}

double diagonal_of(const std::vector<Point>& points) {
    if (points.empty()) return 1.0;
    Point low = points.front(), high = low;
    for (const Point& p : points)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    return std::max(std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]), 1e-30);
}

void add_cones(const ItemSource& source, const GeometryBlock& cones, GltfDocument& document,
               GltfScene& scene) {
    constexpr double kSize = 0.01;  // of the surface's diagonal
    document.meshes.push_back(marker_mesh());
    for (std::size_t i = 0; i < cones.cell_count(); ++i)
        scene.nodes.push_back({std::get<std::vector<std::string>>(cones.cell_data[0].values)[i],
                               document.meshes.size() - 1, cones.points[i],
                               kSize * diagonal_of(source.item().item.points), cell_extras(cones, i)});
}

bool in_the_plane(const std::string& block) {
    static const std::vector<std::string> names = {"layout", "domains",           "outlines",
                                                   "sides",  "layout_generators", "charts"};
    return std::find(names.begin(), names.end(), block) != names.end();
}

json document_extras(const ItemSource& source, const HandoverOptions& options,
                     const std::optional<ShownField>& field) {
    json extras = describe_scene(source, options, field);
    extras.erase("blocks");
    return extras;
}

/// What a viewer shows by itself: the surface once, with the layout as texture where there is one.
std::vector<std::string> suited_blocks(const ItemSource& source) {
    const bool mapped = source.has_layout() && !source.intrinsic();
    return {mapped ? "cut_surface" : "surface",
            "generators",
            "geodesics",
            "curves",
            "loops",
            "samples",
            "cones",
            "layout",
            "sides"};
}

}  // namespace

void write_gltf(const std::string& path, const ItemSource& source, const HandoverOptions& options) {
    constexpr std::uint8_t kSoft = 150;  // lets colours through
    const bool layout = source.has_layout();
    const std::optional<ShownField> field = choose_field(source.item(), options.field, layout);
    const std::vector<std::string> names = wanted_blocks(source, options.what, suited_blocks(source));
    if (names.empty()) throw UsageError(source.item().item.name + " holds nothing that can be shown");
    GltfDocument document;
    const bool textured = options.checker > 0 && layout;
    document.materials = all_materials();
    if (textured) document.texture_png = checker_png(options.checker, field ? kSoft : 0);
    document.generator = "ricci " + source.info().software_version;
    document.extras = document_extras(source, options, field);
    GltfScene space{"space", {}}, plane{"layout", {}};
    for (const std::string& name : names) {
        GeometryBlock block = make_block(name, source);
        GltfScene& scene = in_the_plane(name) ? plane : space;
        if (name == "cones") {
            add_cones(source, block, document, scene);
            continue;
        }
        scene.nodes.push_back({name, document.meshes.size(), std::nullopt, 1.0, nullptr});
        if (block.kind == CellKind::point)
            document.meshes.push_back(point_mesh(block, field));
        else if (block.kind == CellKind::line)
            document.meshes.push_back(curve_mesh(block));
        else
            document.meshes.push_back(surface_mesh(source, std::move(block), field, textured));
    }
    for (GltfScene* scene : {&space, &plane})
        if (!scene->nodes.empty()) document.scenes.push_back(std::move(*scene));
    drop_unused(document);
    save_gltf(path, document);
}

}  // namespace ricci::app
