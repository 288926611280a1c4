// What one interactive view of a page shows: a surface with values at its vertices, curves, marks, and the
// same surface with a checkerboard of a layout.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/app/report/byte_store.h"
#include "engine/app/report/view_mesh.h"
#include "engine/app/stored_layout.h"
#include "io/picture/colour_map.h"

namespace ricci::app {

/// How exactly a column of numbers is kept.
enum class NumberKind : std::uint8_t { doubles, floats, integers };

/// Values at the vertices of a surface, to colour it by and to be read at a vertex.
struct SceneField {
    std::string name, unit;
    std::vector<double> values;          // V of the surface; NaN: none
    std::optional<ColourScale> colours;  // none: can only be read
    NumberKind kind = NumberKind::floats;
    std::vector<std::string> words{};  // where values are numbers of words (status)
};

/// A scale that fits the values: logarithmic where they are positive and span more than a factor of 10, its
/// ends at the 1 % and 99 % quantiles where few values lie far beyond; `middle`: diverging and symmetric
/// about it, and at least `smallest` to either side, so that rounding is not given all colours.
ColourScale fitting_scale(const std::vector<double>& values, std::optional<double> middle = std::nullopt,
                          double smallest = 1e-12);
/// Of the finite values; 0 without any.
double median_of(std::vector<double> values);

/// A polyline on the surface. Curves and pictures of the page that have the same link are shown together.
struct SceneCurve {
    std::string name, link;
    Colour colour;
    bool dashed = false;
    std::vector<Point> points;
    bool hidden = false;  // until it is asked for
};

struct SceneMark {
    std::string name;
    Index vertex = 0;  // of the surface
    Point point{};
};

/// The surface cut open and textured: vertices of a layout.
struct SceneTexture {
    std::string name;
    std::vector<Point> points;              // n
    std::vector<std::array<double, 2>> uv;  // n, in squares
    std::vector<std::array<Index, 3>> triangles;
};

/// The pieces of a layout with its coordinates in squares of a checkerboard that has about twenty-four across
/// the domain. None where the surface has no points.
std::optional<SceneTexture> layout_texture(const std::string& name, const StoredLayout& stored);

struct Scene {
    std::string title;
    ViewMesh mesh;
    std::vector<SceneField> fields;
    std::vector<SceneCurve> curves;
    std::vector<SceneMark> marks;
    std::vector<SceneTexture> textures;
    std::string layout_link{};                         // the picture of a layout whose points are vertices
    std::vector<std::array<double, 2>> layout_points;  // in the picture's units
    std::vector<Index> layout_vertex;                  // vertex of the surface at each
};

/// As JSON with its arrays in the store. Points are rounded to 1/65535 of the box around the surface.
nlohmann::json scene_json(const Scene& scene, ByteStore& bytes);

}  // namespace ricci::app
