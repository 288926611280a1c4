// A small block with every kind of array, and Python to look at files with.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "io/exchange/geometry_block.h"
#include "tests/io/python_scripts.h"

namespace ricci::exchange_samples {

using store_samples::TemporaryFolder;

/// Two triangles and a square, with values that decimals would not keep.
inline GeometryBlock sample_block() {
    GeometryBlock block;
    block.name = "sample";
    block.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, -0.0}, {0, 1, 1.0 / 3}, {2, 0, 5e-324}, {2, 1, 1e300}};
    for (const std::vector<Index>& cell :
         {std::vector<Index>{0, 1, 2}, std::vector<Index>{0, 2, 3}, std::vector<Index>{1, 4, 5, 2}})
        block.add_cell(cell);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    block.point_data = {{"u & \"v\" <1>", "rad", 1, std::vector<double>{0.1, nan, -0.0, 1e-310, 2, 3}},
                        {"uv", "1", 2, std::vector<double>(12, 0.25)}};
    block.cell_data = {{"number", "", 1, std::vector<std::int32_t>{-1, 0, 2147483647}},
                       {"kind", "", 1, std::vector<std::uint8_t>{0, 1, 255}},
                       {"name", "", 1, std::vector<std::string>{"a", "", "\xc3\xbc \xff"}}};
    block.field_data = {{"whole", "s", 1, std::vector<double>{2.5, 1e-3}}};
    block.texture = "uv";
    return block;
}

using store_samples::has_module;
using store_samples::kPython;
using store_samples::run_python;

}  // namespace ricci::exchange_samples
