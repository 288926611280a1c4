#include "io/mesh/formats/element_defects.h"

#include <cmath>
#include <string>

namespace ricci {
namespace {

std::string at_line(std::int64_t line) {
    return line > 0 ? "line " + std::to_string(line) + ", " : "";
}

}  // namespace

void add_point(ParsedFile& file, const Point& point, std::int64_t line) {
    const auto v = static_cast<std::int64_t>(file.soup.points.size());
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2])) {
        file.errors.add("not_finite", "vertex", v, [&] {
            return at_line(line) + "vertex " + std::to_string(v) +
                   ": a coordinate is not a finite number (nan, inf, or beyond the range of double "
                   "precision)";
        });
    }
    file.soup.points.push_back(point);
}

void end_face_of_line(ParsedFile& file, std::int64_t line) {
    PolygonSoup& soup = file.soup;
    const std::size_t corners = soup.corners.size() - soup.face_first.back();
    const auto f = static_cast<std::int64_t>(soup.face_count());
    if (corners < 3) {
        file.errors.add("too_few_corners", "face", f, [&] {
            return at_line(line) + "face " + std::to_string(f) + " has " + std::to_string(corners) +
                   " corners; a face needs three";
        });
    }
    soup.end_face();
    if (line > 0) soup.face_line.push_back(line);
}

void check_corners(ParsedFile& file) {
    const PolygonSoup& soup = file.soup;
    const auto count = static_cast<std::int64_t>(soup.points.size());
    for (std::size_t f = 0; f < soup.face_count(); ++f) {
        for (std::size_t k = soup.face_first[f]; k < soup.face_first[f + 1]; ++k) {
            const std::int64_t v = soup.corners[k];
            if ((v >= 0 && v < count) || v == kReportedCorner) continue;
            file.errors.add("index_out_of_range", "face", static_cast<std::int64_t>(f), [&] {
                return at_line(soup.face_line.empty() ? 0 : soup.face_line[f]) + "face " + std::to_string(f) +
                       ": there is no vertex number " + std::to_string(v + soup.index_base) +
                       "; the file has " + std::to_string(count) + " vertices, counted from " +
                       std::to_string(soup.index_base);
            });
        }
    }
}

void check_limits(const PolygonSoup& soup) {
    constexpr std::size_t kMaxVertices = 2'147'483'647;
    constexpr std::size_t kMaxHalfedges = 2'147'483'646;
    // A polygon of n corners becomes n - 2 triangles.
    const std::size_t triangles = soup.corners.size() - 2 * soup.face_count();
    if (soup.points.size() > kMaxVertices || triangles > kMaxHalfedges / 3) {
        throw ContentError(
            "too_large", 0,
            "the mesh has more than 2147483647 vertices or 715827882 triangles, beyond 32-bit indices");
    }
}

}  // namespace ricci
