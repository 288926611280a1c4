// Surfaces as a page shows them: light enough for a browser.
#pragma once

#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci::app {

struct ViewMesh {
    std::vector<Point> points;        // v, used vertices only
    std::vector<Triangle> triangles;  // f
    std::vector<Index> vertex;        // v: the surface's vertex, or the nearest one where decimated
    std::size_t shown = 0;            // of the v points; those after them are exact vertices in no triangle
    Index faces = 0;                  // of the surface itself
    bool decimated = false;
};

/// The surface, decimated for viewing where it has more than `budget` faces. Throws std::invalid_argument for
/// an intrinsic surface.
ViewMesh make_view_mesh(const SurfaceMesh& mesh, Index budget);

/// Adds vertices of the surface, where they are, to a decimated view: they can be picked and read.
void add_vertices(ViewMesh& view, const SurfaceMesh& mesh, const std::vector<Index>& vertices);

/// Values per vertex of the surface (or NaN for all where there are none) at the view's vertices.
std::vector<double> seen_values(const ViewMesh& view, const std::vector<double>& values);

}  // namespace ricci::app
