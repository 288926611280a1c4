// Fields of a mesh on its refinement.
#pragma once

#include <span>
#include <vector>

#include "engine/refinement/common_refinement.h"

namespace ricci::app {

/// Where the vertices of a refinement lie on the edges of the mesh. The mesh's own come first; every other
/// one is the crossing of an edge of the mesh with one of the final triangulation.
class RefinedField {
  public:
    /// `triangles`, `vertices`: of the mesh. Throws FileError for a refinement that names vertices far beyond
    /// those it can have.
    RefinedField(const CommonRefinement& refinement, std::span<const Triangle> triangles,
                 std::size_t vertices);

    /// At a vertex of the mesh its value, at a crossing the linear one between the ends of its edge by length
    /// on the surface; NaN where one of them is. `values`: V. // N
    [[nodiscard]] std::vector<double> on_refinement(std::span<const double> values) const;

  private:
    struct Place {
        Index from = -1, to = -1;
        double fraction = 0.0;
    };
    std::vector<Place> place_;  // N
};

}  // namespace ricci::app
