// What a file says, before anything is checked but syntax.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/mesh/checks/defect_list.h"
#include "kernels/surface_mesh.h"

namespace ricci {

/// A defect of the contents that ends the reading of this file; load_mesh turns it into a report entry.
class ContentError : public std::runtime_error {
  public:
    /// `line` counts from 1; 0 where the format has no lines.
    ContentError(std::string defect_code, std::int64_t line, const std::string& message)
        : std::runtime_error(message), code_(std::move(defect_code)), line_(line) {}
    [[nodiscard]] const std::string& code() const { return code_; }
    [[nodiscard]] std::int64_t line() const { return line_; }

  private:
    std::string code_;
    std::int64_t line_;
};

/// Points and polygons as they stand in the file. Corners are zero-based but not yet checked against the
/// points.
struct PolygonSoup {
    std::vector<Point> points;
    std::vector<std::int64_t> corners;  // of all faces, one after the other
    std::vector<std::size_t> face_first{
        0};  // F+1: face f has corners[face_first[f]] ... corners[face_first[f+1]-1]
    std::vector<std::int64_t> face_line;  // F, line in the file; empty for binary files
    std::int64_t index_base = 0;          // what the file calls its first vertex (OBJ: 1), for messages

    [[nodiscard]] std::size_t face_count() const { return face_first.size() - 1; }
    void end_face() { face_first.push_back(corners.size()); }
};

/// An intrinsic surface as it stands in a .len file: numbers in range of 32 bits, nothing else checked.
struct IntrinsicSoup {
    Index vertex_count = 0;
    std::vector<Index> tail, twin;  // 3F
    std::vector<double> length;     // 3F
};

/// One parsed file: points and polygons, or an intrinsic surface; with what was noticed on the way.
struct ParsedFile {
    PolygonSoup soup;
    std::optional<IntrinsicSoup> intrinsic;
    DefectList errors, notes;
};

}  // namespace ricci
