// A layout placed in a picture's plane, by the edges and faces of the input.
#pragma once

#include <span>
#include <vector>

#include "engine/app/pictures/model_geometry.h"
#include "io/picture/svg.h"

namespace ricci::app {

/// Corners of pieces in order along each input halfedge, from its tail to its head.
class EdgeChains {
  public:
    explicit EdgeChains(const CommonRefinement& refinement);

    [[nodiscard]] Index halfedge_count() const { return static_cast<Index>(first_.size()) - 1; }
    /// Those whose sides run along h with their piece on its left; none where that face is lost, or h none.
    [[nodiscard]] std::span<const Index> of(Index h) const;

  private:
    std::vector<Index> first_;   // H+1
    std::vector<Index> corner_;  // one for every side along an input edge
};

/// Refers to the stored layout.
class LaidOutDomain {
  public:
    LaidOutDomain(const StoredLayout& stored, LayoutModel model);

    [[nodiscard]] const ModelGeometry& geometry() const { return geometry_; }
    [[nodiscard]] const EdgeChains& chains() const { return chains_; }
    [[nodiscard]] Index face_count() const { return chains_.halfedge_count() / 3; }

    /// The box around all that is shown, the unit disk, or the half plane from its edge up. Throws
    /// std::invalid_argument where nothing is shown.
    [[nodiscard]] ViewBox bounds() const;
    /// Outline of an input face, counterclockwise; empty where the face is lost or not shown.
    [[nodiscard]] std::vector<PlanePoint> face_outline(Index face, double tolerance) const;
    /// Layout vertices along an input halfedge, both ends included; none where it is lost.
    [[nodiscard]] std::vector<Index> halfedge_vertices(Index h) const;
    /// Points along an input halfedge; empty where it is lost or not shown.
    [[nodiscard]] std::vector<PlanePoint> edge_points(Index h) const;
    /// Layout vertices along a side, both ends included.
    [[nodiscard]] std::vector<Index> side_vertices(const CutSide& side) const;
    /// Points along a side; empty where one of them is not shown.
    [[nodiscard]] std::vector<PlanePoint> side_points(const CutSide& side) const;
    /// The sides' outline of the domain, counterclockwise; empty without sides or where one is not shown.
    [[nodiscard]] std::vector<PlanePoint> outline(double tolerance) const;
    /// Appends the geodesics between points.
    void append_to(SvgPath& path, std::span<const PlanePoint> points) const;

  private:
    [[nodiscard]] std::vector<PlanePoint> shown_points(const std::vector<Index>& vertices) const;

    const StoredLayout* stored_;
    ModelGeometry geometry_;
    EdgeChains chains_;
    std::vector<PlanePoint> point_;    // per layout vertex
    std::vector<std::uint8_t> shown_;  // per layout vertex
};

/// Without points that lie within `tolerance` of straight lines between those kept (Douglas and Peucker); the
/// ends stay.
std::vector<PlanePoint> simplified(std::span<const PlanePoint> points, double tolerance);

/// The box around points. Throws std::invalid_argument for none.
ViewBox box_of(std::span<const PlanePoint> points);

}  // namespace ricci::app
