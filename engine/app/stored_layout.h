// Layouts read back, and as meshes with texture coordinates in the model of one's choice.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/structure/surface_structure.h"
#include "io/mesh/save_textured.h"
#include "io/store/result_group.h"

namespace ricci::app {

enum class LayoutModel : std::uint8_t { conformal, klein, half_plane };
/// "poincare", "plane", "disk" and "sphere" are names of the conformal model.
LayoutModel parse_layout_model(const std::string& text);
std::array<double, 2> model_point(LayoutModel model, int kappa, const std::array<double, 3>& position);

/// What pictures and exports need of a layout, from the group that make_layout_group made: positions, frames,
/// pairings, pieces and sides. `faces`: of the item's mesh. Throws FileError where an array is missing, its
/// size does not fit, or an index or coordinate is out of range: whoever draws need not look again.
struct StoredLayout {
    CommonRefinement refinement;  // without its final triangulation
    SurfaceLayout layout;
    CutGraph cut;  // sides only
    std::vector<Isometry<double>> copies;
    std::vector<std::vector<Index>> generators;  // closed vertex paths on the mesh
};
StoredLayout read_layout_group(const ResultGroup& group, std::size_t faces);
/// The same of a structure of this mesh that has not been stored; without copies.
StoredLayout stored_layout_of(const SurfaceMesh& mesh, const SurfaceStructure& structure);

/// Layout coordinates as texture coordinates: of disk models and the sphere moved from [-1, 1] to [0, 1]. A
/// vertex without an image (at the centre of the stereographic projection) has (0, 0). // L
std::vector<std::array<double, 2>> texture_coordinates(const SurfaceLayout& layout, LayoutModel model);

/// The refined input with layout coordinates as texture coordinates: convex pieces, the input's vertices
/// first. Throws UsageError for an intrinsic surface.
TexturedMesh textured_surface(const CommonRefinement& refinement, const SurfaceLayout& layout,
                              LayoutModel model);

/// The layout itself as a mesh in space: the sphere, or the plane z = 0. One point per layout vertex.
TexturedMesh layout_surface(const CommonRefinement& refinement, const SurfaceLayout& layout,
                            LayoutModel model);

}  // namespace ricci::app
