// Size of a picture, and the column of a colour bar beside it.
#pragma once

#include "engine/app/pictures/layout_pictures.h"

namespace ricci::app {

struct PictureFrame {
    double width = 0.0, height = 0.0;  // pixels
    ViewBox view, bar;                 // user units
    double scale = 1.0;                // pixels per user unit
};

/// A frame whose longer side without the colour bar is `pixels`, `margin` pixels of it left free on every
/// side. Boxes longer than four times their width get wider margins.
PictureFrame make_frame(ViewBox box, double pixels, double margin, bool colour_bar);

/// Draws the colour bar into the column that the frame has for it.
void draw_bar(SvgPicture& picture, const PictureFrame& frame, const FaceColours& colours);

}  // namespace ricci::app
