// Changes to triangles that a user may ask for.
#pragma once

#include <cstddef>
#include <span>

#include "io/mesh/checks/defect_list.h"
#include "io/mesh/checks/triangle_soup.h"

namespace ricci {

/// --repair orient: flips the triangles that stand against the majority of their patch, with a note. Patches
/// that cannot be oriented stay as they are.
void orient_faces(TriangleSoup& soup, Index vertex_count, DefectList& notes);

/// --repair drop-degenerate for faces of zero area with three different vertices. Such a face is a segment
/// from a to c with b on it. On the boundary (edge ac has no other face) it is dropped. Inside, dropping it
/// would tear the surface, so ac is flipped into the neighbouring face: the same set of points, without the
/// flat face. Where neither works (two vertices at one position, edge ac non-manifold, or the flip would
/// double an edge) the face stays, and diagnose() reports it. So does what is left after flat_rounds()
/// rounds, each of which takes one flat face off every chain of them. Each change is noted.
void remove_flat_faces(TriangleSoup& soup, std::span<const Point> points, DefectList& notes);

/// How many rounds a mesh of so many faces gets: 1000, from 10,000 faces on as many as look at 1e7 faces, and
/// at least 20.
std::size_t flat_rounds(std::size_t faces);

}  // namespace ricci
