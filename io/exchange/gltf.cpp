#include "io/exchange/gltf.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "io/exchange/gltf_buffer.h"
#include "io/exchange/staged_file.h"
#include "io/store/stored_text.h"

namespace ricci {
namespace {

using nlohmann::json;

void require(bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("glTF: " + what);
}

float single(double value) {
    const auto rounded = static_cast<float>(value);
    require(std::isfinite(rounded), "a number is not finite, or too large for single precision");
    return rounded;
}

template <std::size_t n>
std::vector<float> singles(const std::vector<std::array<double, n>>& rows) {
    std::vector<float> values;
    values.reserve(n * rows.size());
    for (const auto& row : rows)
        for (const double x : row) values.push_back(single(x));
    return values;
}

/// sRGB to linear light, which vertex colours and material factors are in (IEC 61966-2-1).
double linear_light(std::uint8_t channel) {
    const double c = channel / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

std::array<double, 4> linear_colour(const Colour& c) {
    return {linear_light(c.red), linear_light(c.green), linear_light(c.blue), 1.0};
}

std::vector<std::uint16_t> colour_fractions(const std::vector<Colour>& colours) {
    std::array<std::uint16_t, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] =
            static_cast<std::uint16_t>(std::lround(65535.0 * linear_light(static_cast<std::uint8_t>(i))));
    std::vector<std::uint16_t> values;
    values.reserve(4 * colours.size());
    for (const Colour& c : colours)
        values.insert(values.end(), {table[c.red], table[c.green], table[c.blue], 65535});
    return values;
}

json position_accessor(GltfBuffer& buffer, const GltfPrimitive& primitive) {
    require(!primitive.points.empty(), "a primitive has no points");
    return buffer.add_floats(singles(primitive.points), 3, true);
}

void add_attributes(GltfBuffer& buffer, const GltfPrimitive& p, json& attributes) {
    const std::size_t points = p.points.size();
    require((p.normals.empty() || p.normals.size() == points) && (p.uv.empty() || p.uv.size() == points) &&
                (p.colours.empty() || p.colours.size() == points),
            "an attribute has not one row per point");
    if (!p.normals.empty()) attributes["NORMAL"] = buffer.add_floats(singles(p.normals), 3, false);
    if (!p.uv.empty()) {
        // Images have their first row at the top: v runs downwards.
        std::vector<std::array<double, 2>> uv = p.uv;
        for (auto& row : uv) row[1] = 1.0 - row[1];
        attributes["TEXCOORD_0"] = buffer.add_floats(singles(uv), 2, false);
    }
    if (!p.colours.empty()) attributes["COLOR_0"] = buffer.add_fractions(colour_fractions(p.colours), 4);
    for (const DataArray& array : p.attributes) {
        const auto* values = std::get_if<std::vector<double>>(&array.values);
        require(values != nullptr && values->size() == points && array.components == 1 &&
                    array.name.starts_with("_"),
                "the attribute " + array.name + " has not one number per point, or no underscore in front");
        std::vector<float> rounded;
        for (const double x : *values) rounded.push_back(single(x));
        attributes[array.name] = buffer.add_floats(rounded, 1, false);
    }
}

json primitive_json(GltfBuffer& buffer, const GltfPrimitive& p) {
    json attributes = {{"POSITION", position_accessor(buffer, p)}};
    add_attributes(buffer, p, attributes);
    json object = {{"mode", static_cast<int>(p.mode)}, {"attributes", attributes}, {"material", p.material}};
    if (!p.indices.empty()) {
        std::vector<std::uint32_t> indices;
        indices.reserve(p.indices.size());
        for (const Index v : p.indices) {
            require(v >= 0 && static_cast<std::size_t>(v) < p.points.size(), "an index names no point");
            indices.push_back(static_cast<std::uint32_t>(v));
        }
        object["indices"] = buffer.add_indices(indices, p.points.size());
    }
    if (!p.extras.is_null()) object["extras"] = p.extras;
    return object;
}

json meshes_json(GltfBuffer& buffer, const GltfDocument& document) {
    json meshes = json::array();
    for (const GltfMesh& mesh : document.meshes) {
        json primitives = json::array();
        for (const GltfPrimitive& primitive : mesh.primitives) {
            require(primitive.material < document.materials.size(), "a primitive has no material");
            primitives.push_back(primitive_json(buffer, primitive));
        }
        meshes.push_back({{"name", mesh.name}, {"primitives", std::move(primitives)}});
    }
    return meshes;
}

json materials_json(const GltfDocument& document) {
    json materials = json::array();
    for (const GltfMaterial& material : document.materials) {
        json pbr = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.8}};
        if (!(material.colour == kWhite)) pbr["baseColorFactor"] = linear_colour(material.colour);
        if (material.textured) pbr["baseColorTexture"] = {{"index", 0}};
        json object = {{"name", material.name}, {"pbrMetallicRoughness", std::move(pbr)}};
        if (material.two_sided) object["doubleSided"] = true;
        if (!material.lit) object["extensions"] = {{"KHR_materials_unlit", json::object()}};
        materials.push_back(std::move(object));
    }
    return materials;
}

void add_scenes(const GltfDocument& document, json& root) {
    json scenes = json::array(), nodes = json::array();
    for (const GltfScene& scene : document.scenes) {
        json numbers = json::array();
        for (const GltfNode& node : scene.nodes) {
            require(node.mesh < document.meshes.size(), "a node has no mesh");
            json object = {{"name", node.name}, {"mesh", node.mesh}};
            if (node.translation) object["translation"] = singles(std::vector<Point>{*node.translation});
            if (node.scale != 1.0) object["scale"] = std::vector<float>(3, single(node.scale));
            if (!node.extras.is_null()) object["extras"] = node.extras;
            numbers.push_back(nodes.size());
            nodes.push_back(std::move(object));
        }
        scenes.push_back({{"name", scene.name}, {"nodes", std::move(numbers)}});
    }
    root["scene"] = 0;
    root["scenes"] = std::move(scenes);
    root["nodes"] = std::move(nodes);
}

/// Repeating, with sharp edges when near and smooth when far.
void add_texture(json& root, json image) {
    constexpr int kNearest = 9728, kLinearMipmapLinear = 9987, kRepeat = 10497;
    root["images"] = json::array({std::move(image)});
    root["samplers"] = json::array({{{"magFilter", kNearest},
                                     {"minFilter", kLinearMipmapLinear},
                                     {"wrapS", kRepeat},
                                     {"wrapT", kRepeat}}});
    root["textures"] = json::array({{{"sampler", 0}, {"source", 0}}});
}

/// A name as a relative URI (RFC 3986): what is not unreserved as %XX.
std::string uri_of(const std::string& name) {
    constexpr std::string_view kHex = "0123456789ABCDEF";
    std::string uri;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           std::string_view("-._~").find(c) != std::string_view::npos;
        if (plain)
            uri += c;
        else
            uri += {'%', kHex[byte / 16], kHex[byte % 16]};
    }
    return uri;
}

/// `limit` of four bytes: what sizes in a .glb may be.
std::uint32_t fitting(std::size_t size, const std::string& path) {
    if (size > std::numeric_limits<std::uint32_t>::max())
        throw FileError(path + ": glTF's binary files end at 4 GiB");
    return static_cast<std::uint32_t>(size);
}

void save_glb(const std::string& path, const json& root, std::string binary) {
    constexpr std::uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBinary = 0x004E4942;
    std::string text = root.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    StagedFile file(path);
    const std::uint32_t total = fitting(12 + 8 + text.size() + 8 + binary.size(), path);
    for (const std::uint32_t word : {kMagic, 2U, total}) file.write_value(word);
    for (const std::uint32_t word : {static_cast<std::uint32_t>(text.size()), kJson}) file.write_value(word);
    file.write(text);
    for (const std::uint32_t word : {static_cast<std::uint32_t>(binary.size()), kBinary})
        file.write_value(word);
    file.write(binary);
    file.close();
}

void save_apart(const std::string& path, const std::string& bytes) {
    StagedFile file(path);
    file.write(bytes);
    file.close();
}

/// All names and texts as valid UTF-8: JSON holds no other.
void make_valid(json& value) {
    if (value.is_string()) {
        value = hdf5::stored_text(value.get<std::string>());
    } else if (value.is_structured()) {
        for (json& inner : value) make_valid(inner);
    }
}

}  // namespace

void save_gltf(const std::string& path, const GltfDocument& document) {
    std::filesystem::path file(path);
    const bool binary = file.extension() == ".glb";
    if (!binary && file.extension() != ".gltf") throw FileError(path + ": glTF is written as .glb or .gltf");
    require(!document.scenes.empty(), "there is nothing to show");
    GltfBuffer buffer;
    json root = {{"asset", {{"version", "2.0"}, {"generator", document.generator}}}};
    if (!document.extras.is_null()) root["asset"]["extras"] = document.extras;
    root["meshes"] = meshes_json(buffer, document);
    root["materials"] = materials_json(document);
    add_scenes(document, root);
    const bool unlit = std::any_of(document.materials.begin(), document.materials.end(),
                                   [](const GltfMaterial& material) { return !material.lit; });
    if (unlit) root["extensionsUsed"] = {"KHR_materials_unlit"};
    json buffer_json;
    if (!document.texture_png.empty()) {
        json image = {{"name", "checkerboard"}};
        if (binary) {
            image["mimeType"] = "image/png";
            image["bufferView"] = buffer.add_bytes(document.texture_png);
        } else {
            const std::string name = file.replace_extension(".checker.png").string();
            save_apart(name, document.texture_png);
            image["uri"] = uri_of(std::filesystem::path(name).filename().string());
        }
        add_texture(root, std::move(image));
    }
    root["bufferViews"] = buffer.views();
    root["accessors"] = buffer.accessors();
    buffer_json["byteLength"] = buffer.bytes().size();
    if (!binary) {
        const std::string name = file.replace_extension(".bin").string();
        save_apart(name, buffer.bytes());
        buffer_json["uri"] = uri_of(std::filesystem::path(name).filename().string());
    }
    root["buffers"] = json::array({std::move(buffer_json)});
    make_valid(root);
    if (binary) return save_glb(path, root, buffer.bytes());
    save_apart(path, root.dump(1) + "\n");
}

}  // namespace ricci
