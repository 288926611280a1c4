#include "io/exchange/geometry_block.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace ricci {
namespace {

void require(bool holds, const GeometryBlock& block, const std::string& what) {
    if (!holds) throw std::invalid_argument(block.name + ": " + what);
}

void require_arrays(const GeometryBlock& block, std::span<const DataArray> arrays, std::size_t rows,
                    bool any_length) {
    std::set<std::string> names;
    for (const DataArray& array : arrays) {
        require(!array.name.empty() && array.name.find('/') == std::string::npos &&
                    names.insert(array.name).second,
                block, "array name \"" + array.name + "\" is empty, doubled or holds a slash");
        require(array.components > 0 && array.size() % array.components == 0 &&
                    (any_length || array.rows() == rows),
                block, "array " + array.name + " has not one row per element");
    }
}

/// That `name`, unless it is empty, is point data of so many doubles each.
void require_vectors(const GeometryBlock& block, const std::string& name, std::size_t components) {
    if (name.empty()) return;
    const DataArray* array = find_array(block.point_data, name);
    require(array != nullptr && array->components == components &&
                std::holds_alternative<std::vector<double>>(array->values),
            block, "no point data of the name " + name + " with so many components");
}

}  // namespace

std::size_t DataArray::size() const {
    return std::visit([](const auto& list) { return list.size(); }, values);
}

void GeometryBlock::add_cell_of(std::span<const Point> cell) {
    for (const Point& p : cell) {
        corners.push_back(static_cast<Index>(points.size()));
        points.push_back(p);
    }
    first.push_back(static_cast<Index>(corners.size()));
}

const DataArray* find_array(std::span<const DataArray> arrays, const std::string& name) {
    const auto found =
        std::find_if(arrays.begin(), arrays.end(), [&](const DataArray& a) { return a.name == name; });
    return found == arrays.end() ? nullptr : &*found;
}

const std::vector<double>* find_doubles(std::span<const DataArray> arrays, const std::string& name) {
    const DataArray* array = find_array(arrays, name);
    return array == nullptr ? nullptr : std::get_if<std::vector<double>>(&array->values);
}

void require_valid(const GeometryBlock& block) {
    const auto points = static_cast<Index>(block.points.size());
    require(!block.first.empty() && block.first.front() == 0 &&
                static_cast<std::size_t>(block.first.back()) == block.corners.size(),
            block, "the cells do not hold all corners");
    const Index least = block.kind == CellKind::polygon ? 3 : (block.kind == CellKind::line ? 2 : 1);
    for (std::size_t i = 0; i < block.cell_count(); ++i)
        require(block.first[i + 1] - block.first[i] >= least, block,
                "cell " + std::to_string(i) + " has fewer points than its kind needs");
    require(std::all_of(block.corners.begin(), block.corners.end(),
                        [&](Index v) { return v >= 0 && v < points; }),
            block, "a cell names a point that does not exist");
    require(std::all_of(block.points.begin(), block.points.end(),
                        [](const Point& p) {
                            return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
                        }),
            block, "a point is not finite");
    require_arrays(block, block.point_data, block.points.size(), false);
    require_arrays(block, block.cell_data, block.cell_count(), false);
    require_arrays(block, block.field_data, 0, true);
    require_vectors(block, block.texture, 2);
    require_vectors(block, block.normals, 3);
}

}  // namespace ricci
