#include "engine/app/pictures/picture_frame.h"

#include <algorithm>

namespace ricci::app {
namespace {

constexpr double kBarColumn = 96.0, kBarWidth = 18.0;  // pixels

void widen(double& low, double& extent, double least) {
    if (extent >= least) return;
    low -= 0.5 * (least - extent);
    extent = least;
}

}  // namespace

PictureFrame make_frame(ViewBox box, double pixels, double margin, bool colour_bar) {
    const double longest = std::max({box.width, box.height, 1e-300});
    widen(box.left, box.width, 0.25 * longest);
    widen(box.bottom, box.height, 0.25 * longest);
    PictureFrame frame;
    frame.scale = (pixels - 2.0 * margin) / longest;
    const double unit = 1.0 / frame.scale;
    frame.width = box.width * frame.scale + 2.0 * margin;
    frame.height = box.height * frame.scale + 2.0 * margin;
    const double right = box.left + box.width + margin * unit;
    if (colour_bar) {
        frame.width += kBarColumn;
        frame.bar = {right, box.bottom + 0.2 * box.height, kBarWidth * unit, 0.6 * box.height};
    }
    frame.view = {box.left - margin * unit, box.bottom - margin * unit, frame.width * unit,
                  frame.height * unit};
    return frame;
}

void draw_bar(SvgPicture& picture, const PictureFrame& frame, const FaceColours& colours) {
    draw_colour_bar(picture, colours.scale, frame.bar, colours.title);
}

}  // namespace ricci::app
