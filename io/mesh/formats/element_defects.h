// Defects of single elements that the parsers of all formats report alike.
#pragma once

#include <cstdint>

#include "io/mesh/formats/polygon_soup.h"

namespace ricci {

/// Stands for a corner whose index was reported already.
inline constexpr std::int64_t kReportedCorner = INT64_MIN;

/// Appends a point; reports it (not_finite) when a coordinate is not a finite number. `line` 0: none.
void add_point(ParsedFile& file, const Point& point, std::int64_t line);

/// Ends the face whose corners were appended; reports fewer than three (too_few_corners).
void end_face_of_line(ParsedFile& file, std::int64_t line);

/// Reports corners that name no vertex (index_out_of_range).
void check_corners(ParsedFile& file);

/// Throws ContentError (too_large) when vertices or faces do not fit 32-bit numbers.
void check_limits(const PolygonSoup& soup);

}  // namespace ricci
