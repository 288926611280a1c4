// glTF 2.0 (ISO/IEC 12113): surfaces, curves and markers for browsers, game engines and modellers.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/exchange/geometry_block.h"
#include "io/picture/colour.h"

namespace ricci {

/// How a mesh looks. Without `lit` it has its colour whatever the light (KHR_materials_unlit).
struct GltfMaterial {
    std::string name;
    Colour colour = kWhite;
    bool lit = true, textured = false, two_sided = true;
};

enum class GltfMode : std::uint8_t { points = 0, lines = 1, line_loop = 2, line_strip = 3, triangles = 4 };

/// What is drawn in one go. Numbers become single precision, as glTF has it.
struct GltfPrimitive {
    GltfMode mode = GltfMode::triangles;
    std::vector<Point> points;
    std::vector<Point> normals;             // one for each point, unit vectors; or none
    std::vector<std::array<double, 2>> uv;  // one for each point, v upwards; or none
    std::vector<Colour> colours;            // one for each point, or none
    /// Values per point under names of the application ("_CURVATURE"): names in upper case after an
    /// underscore. Of doubles, one component each.
    std::vector<DataArray> attributes;
    std::vector<Index> indices;  // none: the points in their order
    std::size_t material = 0;
    nlohmann::json extras;  // null: none
};

struct GltfMesh {
    std::string name;
    std::vector<GltfPrimitive> primitives;
};

/// A mesh at a place.
struct GltfNode {
    std::string name;
    std::size_t mesh = 0;
    std::optional<Point> translation;
    double scale = 1.0;
    nlohmann::json extras;
};

struct GltfScene {
    std::string name;
    std::vector<GltfNode> nodes;
};

struct GltfDocument {
    std::vector<GltfScene> scenes;  // the first is the one to show
    std::vector<GltfMesh> meshes;
    std::vector<GltfMaterial> materials;
    std::string texture_png;  // bytes of the one texture that textured materials have
    std::string generator;
    nlohmann::json extras;
};

/// Writes .glb (all in one file) or .gltf (with <stem>.bin and, where there is a texture, <stem>.checker.png
/// beside it). Throws std::invalid_argument for arrays that do not fit together, indices out of range or
/// numbers that single precision does not hold; FileError for another suffix, beyond 4 GiB, and where writing
/// fails.
void save_gltf(const std::string& path, const GltfDocument& document);

}  // namespace ricci
