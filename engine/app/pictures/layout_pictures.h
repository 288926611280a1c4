// Pictures of layouts: fundamental domains, tessellations, checkerboards, and the surface in space.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/app/stored_layout.h"
#include "io/picture/colour_map.h"
#include "io/picture/svg.h"

namespace ricci::app {

/// Values that colour faces.
struct FaceColours {
    std::vector<double> value;  // per input face
    ColourScale scale;
    std::string title;
};

/// A scale for values around a middle (diverging, symmetric about it), or from their 1 % to their 99 %
/// quantile.
FaceColours diverging_colours(std::vector<double> value, double middle, const std::string& title);
FaceColours sequential_colours(std::vector<double> value, const std::string& title);

struct DomainPicture {
    LayoutModel model = LayoutModel::conformal;
    std::optional<FaceColours> colours;
    double checker = 0.0;  // > 0: a checkerboard of this cell in the layout's own coordinates
    bool labels = true;    // names of the sides
    double pixels = 720.0;
};

/// The fundamental domain: faces, edges of the input, sides in pairs of colours with their names (thesis,
/// Figures 17 b and 33 b). Sides of the input's faces are geodesics of the model. Faces too small to see are
/// left out, and so are those near the centre of a stereographic projection. Throws std::invalid_argument
/// where nothing of the layout is finite.
SvgPicture draw_domain(const StoredLayout& stored, const DomainPicture& options);

/// Copies of the domain by the layout's tessellation (stored.copies), neighbours in different colours
/// (Figures 17 e and 33 e); in the plane those in a window of several periods. Copies below a pixel are left
/// out. Throws UsageError without copies and for a domain without sides.
SvgPicture draw_tessellation(const StoredLayout& stored, LayoutModel model, double pixels = 720.0);

struct SurfacePicture {
    std::optional<FaceColours> colours;
    double checker =
        0.0;  // > 0: a checkerboard of this cell in the layout's coordinates (Figures 17 f and 33 g)
    std::vector<std::vector<Index>> loops;  // vertex paths drawn on the surface, dashed where hidden
    std::vector<std::string> loop_names;    // one for each loop, or none
    double pixels = 720.0;
};

/// The surface seen along its least extended axis, loops in front where they can be, hidden parts left out,
/// lightly shaded. Throws UsageError for an intrinsic surface.
SvgPicture draw_surface(const StoredLayout& stored, const SurfacePicture& options);

}  // namespace ricci::app
