// Points and geodesics of the models that layouts are drawn in.
#pragma once

#include <array>
#include <vector>

#include "engine/app/stored_layout.h"
#include "io/picture/circular_arc.h"

namespace ricci::app {

/// A model of the hyperbolic plane, the plane or the sphere in the plane of a picture. The plane has one
/// model, and so has the sphere: the stereographic projection.
class ModelGeometry {
  public:
    ModelGeometry(LayoutModel model, int kappa) : model_(model), kappa_(kappa) {}

    /// Whether the model fills the unit disk.
    [[nodiscard]] bool disk() const { return kappa_ < 0 && model_ != LayoutModel::half_plane; }
    [[nodiscard]] bool half_plane() const { return kappa_ < 0 && model_ == LayoutModel::half_plane; }
    /// Whether a position has a place in the picture: finite, in the model, and on the sphere not next to
    /// the centre of the projection.
    [[nodiscard]] bool shows(const std::array<double, 3>& position) const;
    [[nodiscard]] PlanePoint point(const std::array<double, 3>& position) const {
        return model_point(model_, kappa_, position);
    }
    /// The geodesic between two points of the picture.
    [[nodiscard]] CircularArc geodesic(const PlanePoint& from, const PlanePoint& to) const;
    /// Appends `from` and so many points of the geodesic to `to`, without that, that straight lines between
    /// them stay within `tolerance` of it.
    void append_geodesic(std::vector<PlanePoint>& points, const PlanePoint& from, const PlanePoint& to,
                         double tolerance) const;

  private:
    LayoutModel model_;
    int kappa_;
};

}  // namespace ricci::app
