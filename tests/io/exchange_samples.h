// A small block with every kind of array, and Python to look at files with.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>

#include "io/exchange/geometry_block.h"
#include "tests/io/store_samples.h"

namespace ricci::exchange_samples {

using store_samples::TemporaryFolder;

inline constexpr const char* kPython = "/usr/bin/python3";

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

/// Runs a script with arguments; its output, with the exit status in front when that is not 0.
inline std::string run_python(const TemporaryFolder& folder, const std::string& script,
                              const std::string& arguments) {
    const std::string path = folder.file("script.py");
    std::ofstream(path) << script;
    const std::string command = fmt::format("{} {} {} 2>&1", kPython, path, arguments);
    std::FILE* pipe = ::popen(command.c_str(), "r");
    std::string output;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
    const int status = ::pclose(pipe);
    return status == 0 ? output : fmt::format("status {}: {}", status, output);
}

inline bool has_module(const std::string& module) {
    const std::string command = fmt::format("{} -c 'import {}' 2>/dev/null", kPython, module);
    return std::system(command.c_str()) == 0;  // NOLINT(concurrency-mt-unsafe): one thread
}

}  // namespace ricci::exchange_samples
