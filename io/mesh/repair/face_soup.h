// Polygons of the input on their way to triangles: welding, repeated vertices, triangulation.
#pragma once

#include <span>
#include <vector>

#include "io/mesh/checks/defect_list.h"
#include "io/mesh/checks/triangle_soup.h"
#include "io/mesh/formats/polygon_soup.h"

namespace ricci {

/// Polygons with valid vertices, and the face of the input that each is.
struct FaceSoup {
    std::vector<Index> corners;
    std::vector<std::size_t> first{0};  // F+1
    std::vector<Index> source;          // F

    [[nodiscard]] std::size_t face_count() const { return source.size(); }
    [[nodiscard]] std::span<const Index> face(std::size_t f) const {
        return std::span(corners).subspan(first[f], first[f + 1] - first[f]);
    }
};

/// --repair weld: lets faces use the lowest used vertex at each position. The others stay in `points`,
/// unused.
void weld_vertices(PolygonSoup& soup, DefectList& notes);

/// Sorts out faces that repeat a vertex. With `drop` neighbouring repeats are merged and faces of fewer than
/// three remaining corners dropped, with a note; whatever remains is reported as repeated_vertex_in_face and
/// left out.
FaceSoup distinct_corners(const PolygonSoup& soup, bool drop, DefectList& errors, DefectList& notes);

/// Cuts polygons into triangles: quads along the diagonal with the larger smallest angle (ties: the diagonal
/// at the lowest vertex), larger ones by clipping the ear with the largest smallest angle, tested in the
/// projection along the main axis of the polygon's normal. Diagonals that already are edges of the mesh are
/// avoided, and so are triangles of zero area. Deterministic; with a note. Polygons of more than kMaxCorners
/// are reported, and so are those with which the sum of (corners)^2 over polygons of more than kFreeCorners
/// exceeds kMaxWork (polygon_too_large).
TriangleSoup triangulate(const FaceSoup& faces, std::span<const Point> points, DefectList& errors,
                         DefectList& notes);
inline constexpr std::size_t kMaxCorners = 10000, kFreeCorners = 64;
inline constexpr std::size_t kMaxWork = 1'000'000'000;

/// "3, 5, 8, ..." for messages: the first few of a list of numbers.
std::string listed(std::span<const Index> numbers);

}  // namespace ricci
