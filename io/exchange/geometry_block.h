// Geometry with named values, as it is handed over to other programs whatever their format.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

/// Values with a name and a unit, row after row. The unit is text as users read it ("rad", "s"); "1" for pure
/// numbers, empty where there is nothing to say (texts, numbers of things).
struct DataArray {
    std::string name, unit;
    std::size_t components = 1;
    std::variant<std::vector<double>, std::vector<std::int32_t>, std::vector<std::uint8_t>,
                 std::vector<std::string>>
        values;

    [[nodiscard]] std::size_t size() const;  // of values
    [[nodiscard]] std::size_t rows() const { return size() / components; }
};

enum class CellKind : std::uint8_t { polygon, line, point };

/// Polygons, polylines or points in space, all of one kind, with values per point, per cell and of the whole.
struct GeometryBlock {
    std::string name;
    CellKind kind = CellKind::polygon;
    std::vector<Point> points;
    std::vector<Index> corners;   // points of the cells, cell after cell
    std::vector<Index> first{0};  // cells + 1, first corner of each
    std::vector<DataArray> point_data, cell_data, field_data;
    std::string texture;  // name of the two-component point data that textures follow; empty: none
    std::string normals;  // name of the three-component point data that shading follows; empty: none

    [[nodiscard]] std::size_t cell_count() const { return first.size() - 1; }
    [[nodiscard]] std::span<const Index> cell(std::size_t i) const {
        const auto start = static_cast<std::size_t>(first[i]);
        return std::span<const Index>(corners).subspan(start, static_cast<std::size_t>(first[i + 1]) - start);
    }
    void add_cell(std::span<const Index> cell) {
        corners.insert(corners.end(), cell.begin(), cell.end());
        first.push_back(static_cast<Index>(corners.size()));
    }
    /// A cell of points of its own, which are added.
    void add_cell_of(std::span<const Point> cell);
};

/// The array of that name; null where there is none.
const DataArray* find_array(std::span<const DataArray> arrays, const std::string& name);
/// Its values where it is one of doubles; null otherwise.
const std::vector<double>* find_doubles(std::span<const DataArray> arrays, const std::string& name);

/// Throws std::invalid_argument naming block and array unless cells have points enough that exist, arrays
/// have as many rows as there are points (cells) and names that are not empty, not doubled and without a
/// slash, and points are finite.
void require_valid(const GeometryBlock& block);

}  // namespace ricci
