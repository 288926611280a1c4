// A smooth solid shaped like a row of rings, given by a function: the target of the handle surfaces.
#pragma once

#include "kernels/surface_mesh.h"

namespace ricci {

/// g circles of radius 1 in the plane z = 0, centres on the x-axis, each touching the next, together centred
/// at the origin. The field is the fourth-power mean (sum d_i^-4)^(-1/4) of the distances to them, smooth off
/// the circles; the surface is where it equals kTubeRadius: closed, genus g, symmetric under the coordinate
/// reflections.
class RingRowField {
  public:
    static constexpr double kTubeRadius = 0.42;

    explicit RingRowField(Index genus) : genus_(genus) {}

    /// The point moved along the gradient by one Newton step towards the surface, at most 0.3 far. Mirror
    /// images move to mirror images, to the last bit.
    [[nodiscard]] Point step_to_surface(const Point& p) const;

    /// The field's value at a point.
    [[nodiscard]] double value(const Point& p) const;

  private:
    struct Sample {
        double value;
        Point gradient;
    };
    [[nodiscard]] Sample sample(const Point& p) const;

    Index genus_;
};

}  // namespace ricci
