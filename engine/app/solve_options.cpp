#include "engine/app/solve_options.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "engine/app/console.h"
#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/formats/text_lines.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {
namespace {

constexpr std::string_view kBlanks = " \t\v\f";

template <class T, std::size_t n>
T parse_name(const char* what, const std::string& text, const std::array<T, n>& values) {
    std::string known;
    for (const T value : values) {
        if (text == name_of(value)) return value;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", name_of(value));
    }
    throw UsageError(fmt::format("unknown {} '{}' (known: {})", what, text, known));
}

/// Calls use(line number, text) for each line that is not empty once comments are gone.
template <class Use>
void for_lines(const std::string& path, Use&& use) {
    const std::string bytes = read_file_bytes(path);
    for (TextLines lines(bytes, '#'); lines.next_filled();) {
        const std::string_view line = lines.line();
        const auto begin = line.find_first_not_of(kBlanks);
        use(lines.number(), line.substr(begin, line.find_last_not_of(kBlanks) - begin + 1));
    }
}

template <class T>
T parse_line(const std::string& path, std::int64_t number, std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        throw UsageError(fmt::format("{}:{}: {} is not a number", path, number, shown(text)));
    return value;
}

}  // namespace

Scheme parse_scheme(const std::string& text) {
    return parse_name("scheme", text,
                      std::array{Scheme::vertex_scaling, Scheme::inversive_distance, Scheme::thurston,
                                 Scheme::tangential, Scheme::virtual_radius});
}

Method parse_method(const std::string& text) {
    return parse_name("method", text, std::array{Method::newton, Method::gradient});
}

Boundary parse_boundary(const std::string& text) {
    return parse_name("boundary", text, std::array{Boundary::geodesic, Boundary::free, Boundary::curvature});
}

SphereRoute parse_sphere_route(const std::string& text) {
    return parse_name("sphere route", text, std::array{SphereRoute::robust, SphereRoute::direct});
}

std::optional<Geometry> parse_geometry(const std::string& text) {
    if (text == "auto") return std::nullopt;
    return parse_name("geometry", text,
                      std::array{Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical});
}

SweepSolverKind parse_solver(const std::string& text) {
    return parse_name("solver", text, std::array{SweepSolverKind::lanes, SweepSolverKind::newton});
}

Precision parse_precision(const std::string& text) {
    return parse_name("precision", text,
                      std::array{Precision::automatic, Precision::plain, Precision::extended});
}

bool parse_delaunay(const std::string& text) {
    if (text == "isometric") return true;
    if (text == "none") return false;
    throw UsageError(fmt::format("unknown delaunay '{}' (known: isometric, none)", text));
}

Cone parse_cone(const std::string& text) {
    const auto colon = text.find(':');
    Index vertex = -1;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + std::min(colon, text.size()), vertex);
    if (colon == std::string::npos || error != std::errc() || end != text.data() + colon || vertex < 0)
        throw UsageError(fmt::format("cone '{}' is not VERTEX:CURVATURE (like 0:-4pi)", text));
    return {vertex, parse_curvature(text.substr(colon + 1))};
}

void parse_target(const std::string& text, FlowOptions& options) {
    if (text == "flat") {
        options.target = TargetKind::flat;
    } else if (text == "uniform") {
        options.target = TargetKind::uniform;
    } else if (text == "boundary") {
        options.target = TargetKind::boundary;
    } else {
        options.target = TargetKind::values;
        for_lines(text, [&](std::int64_t number, std::string_view line) {
            const double value = parse_line<double>(text, number, line);
            if (!std::isfinite(value)) throw UsageError(fmt::format("{}:{}: not finite", text, number));
            options.target_values.push_back(value);
        });
    }
}

std::vector<Index> read_vertex_list(const std::string& path) {
    std::vector<Index> list;
    for_lines(path, [&](std::int64_t number, std::string_view line) {
        list.push_back(parse_line<Index>(path, number, line));
    });
    return list;
}

}  // namespace ricci::app
