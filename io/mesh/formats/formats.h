// Parsers of the mesh formats. Each takes the whole (unpacked) file and throws ContentError at what cannot be
// read on from; defects of single elements are collected in ParsedFile::errors. Counts in headers are never
// trusted for allocation; there is no recursion; numbers do not depend on the locale.
#pragma once

#include <string_view>

#include "io/mesh/formats/polygon_soup.h"

namespace ricci {

/// Wavefront OBJ: v and f statements (relative indices, v/vt/vn corners, continued lines); the rest is
/// skipped.
ParsedFile parse_obj(std::string_view text);

/// Geomview OFF with its variants for colours, normals and texture coordinates; one vertex or face per line.
ParsedFile parse_off(std::string_view text);

/// PLY 1.0, ASCII or binary, any further elements, properties and lists.
ParsedFile parse_ply(std::string_view bytes);

/// STL, ASCII (several solids) or binary; corners with equal coordinates are merged.
ParsedFile parse_stl(std::string_view bytes);

/// Intrinsic surface: "V F", then per face "v0 v1 v2 l01 l12 l20 t0 t1 t2".
ParsedFile parse_len(std::string_view text);

}  // namespace ricci
