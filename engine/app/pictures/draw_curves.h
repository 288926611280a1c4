// Pictures of curves on a surface in space.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/picture/svg.h"
#include "kernels/surface_mesh.h"

namespace ricci::app {

/// A polyline on the surface.
struct DrawnCurve {
    std::string name{};  // written beside it; "": not
    std::vector<Point> points;
    std::optional<Colour> colour{};  // none: told apart from the others by pair_paint
};

/// The surface seen as draw_surface sees it, curves in front where they can be, dashed where it hides them.
/// Of curves that lie on one another the first is on top. Throws UsageError for an intrinsic surface.
SvgPicture draw_curves(const SurfaceMesh& mesh, std::span<const DrawnCurve> curves, double pixels = 720.0);

}  // namespace ricci::app
