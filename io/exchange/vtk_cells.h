// Cells as VTK's formats number them.
#pragma once

#include <cstdint>
#include <vector>

#include "io/exchange/geometry_block.h"

namespace ricci {

/// Cells in the 64-bit numbers that VTK works with, so that it need not convert.
struct VtkCells {
    std::vector<std::int64_t> corners;
    std::vector<std::int64_t> ends;  // one past the last corner of each cell

    explicit VtkCells(const GeometryBlock& block)
        : corners(block.corners.begin(), block.corners.end()),
          ends(block.first.begin() + 1, block.first.end()) {}
};

/// VTK's type of every cell: vertices, polyline, triangle or polygon.
inline std::vector<std::uint8_t> vtk_types(const GeometryBlock& block) {
    constexpr std::uint8_t kPolyVertex = 2, kPolyLine = 4, kTriangle = 5, kPolygon = 7;
    std::vector<std::uint8_t> types;
    for (std::size_t i = 0; i < block.cell_count(); ++i) {
        if (block.kind == CellKind::point)
            types.push_back(kPolyVertex);
        else if (block.kind == CellKind::line)
            types.push_back(kPolyLine);
        else
            types.push_back(block.cell(i).size() == 3 ? kTriangle : kPolygon);
    }
    return types;
}

}  // namespace ricci
