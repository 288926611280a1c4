// The isometry along a closed edge path of the input: what its homotopy class is measured by.
#pragma once

#include <span>

#include "engine/structure/surface_structure.h"

namespace ricci {

/// A length and how far rounding let two ways of computing it differ, relative to it.
struct PathLength {
    double length = 0.0;  // 0: the path has no closed geodesic
    double spread = 0.0;
};

/// Measures closed edge paths of a mesh in the final metric of its structure. Both must outlive it.
class PathHolonomy {
  public:
    PathHolonomy(const SurfaceStructure& structure, const Connectivity& input);

    /// The product of the moves along a closed path, in the frame at the tail of path[first]: it never leads
    /// farther away than the path itself does, while words in generators at a base point lose e^(2R) digits
    /// at distance R.
    [[nodiscard]] Isometry<double> of(std::span<const Step> path, std::size_t first = 0) const;

    /// Length of the closed geodesic in the class of the path, hyperbolic surfaces; from the products that
    /// begin at the first step and half way.
    [[nodiscard]] PathLength length_of(std::span<const Step> path) const;

  private:
    void append(Step step, Isometry<double>& product) const;

    const SurfaceStructure* structure_;
    PieceWalks walks_;
};

}  // namespace ricci
