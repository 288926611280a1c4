// A surface in space as a viewer sees it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/app/pictures/depth_image.h"
#include "engine/app/pictures/laid_out_domain.h"

namespace ricci::app {

/// Rows: to the right, up, towards the viewer. The viewer looks along the axis of least extent of the
/// surface (by area), moved a little to the side so that depth shows, at the side that the points `front` are
/// on (none: the one where that axis has its largest coordinate positive). Upright is the longer or the
/// middle principal axis where the coordinate axis y (z, where y points to the viewer) appears within 15
/// degrees of it, else that coordinate axis.
Eigen::Matrix3d view_axes(const std::vector<Point>& points, const std::vector<std::array<Index, 3>>& faces,
                          const std::vector<Point>& front = {});

/// Faces of the input in a parallel projection. Refers to what it is made of.
class SurfaceView {
  public:
    /// `front`: vertices to be seen, as in view_axes. Throws UsageError where the refinement has no points.
    SurfaceView(const CommonRefinement& refinement, const EdgeChains& chains,
                const std::vector<std::vector<Index>>& front);

    [[nodiscard]] Index face_count() const { return static_cast<Index>(face_.size()); }
    /// Whether the face has its three sides in the refinement.
    [[nodiscard]] bool has(Index face) const { return face_[static_cast<std::size_t>(face)][0] >= 0; }
    [[nodiscard]] ViewBox bounds() const { return bounds_; }
    [[nodiscard]] PlanePoint seen(Index vertex) const;
    [[nodiscard]] double depth(Index vertex) const { return seen_[static_cast<std::size_t>(vertex)][2]; }
    [[nodiscard]] double depth_range() const { return nearest_ - farthest_; }
    [[nodiscard]] SeenTriangle triangle(Index face) const;
    /// In space, squared units.
    [[nodiscard]] double area(Index face) const;
    /// Light from above the viewer's left shoulder, on either side of the face: 0 (none) to 1.
    [[nodiscard]] double light(Index face) const;

  private:
    [[nodiscard]] Eigen::Vector3d normal(Index face) const;

    std::vector<std::array<Index, 3>> face_;  // vertices of the refinement, or -1
    std::vector<Eigen::Vector3d> seen_;       // per vertex of the refinement
    ViewBox bounds_;
    double nearest_ = 0.0, farthest_ = 0.0;
};

}  // namespace ricci::app
