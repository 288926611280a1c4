// Pictures of layouts: fundamental domains, tessellations, checkerboards, and the surface in space.
#pragma once

#include <optional>
#include <span>
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
/// Figures 17 b and 33 b).
SvgPicture draw_domain(const StoredLayout& stored, const DomainPicture& options);

/// Copies of the domain by the layout's tessellation (stored.copies), each in a shade of its own (Figures 17
/// e and 33 e).
SvgPicture draw_tessellation(const StoredLayout& stored, LayoutModel model, double pixels = 720.0);

struct SurfacePicture {
    std::optional<FaceColours> colours;
    double checker =
        0.0;  // > 0: a checkerboard of this cell in the layout's coordinates (Figures 17 f and 33 g)
    std::vector<std::vector<Index>> loops;  // vertex paths drawn on the surface
    double pixels = 720.0;
};

/// The surface seen along its least extended axis, hidden parts painted over, lightly shaded.
SvgPicture draw_surface(const StoredLayout& stored, const SurfacePicture& options);

}  // namespace ricci::app
