#include "io/picture/polygon_batch.h"

#include <algorithm>
#include <vector>

namespace ricci {
namespace {

double twice_signed_area(std::span<const PlanePoint> corners) {
    double sum = 0.0;
    for (std::size_t i = 2; i < corners.size(); ++i)
        sum += (corners[i - 1][0] - corners[0][0]) * (corners[i][1] - corners[0][1]) -
               (corners[i - 1][1] - corners[0][1]) * (corners[i][0] - corners[0][0]);
    return sum;
}

}  // namespace

void PolygonBatch::add(const Colour& colour, std::span<const PlanePoint> corners) {
    if (corners.empty()) return;
    SvgPath& path = paths_[colour];
    // One sense for all: under the nonzero rule opposite ones cancel where they overlap.
    if (twice_signed_area(corners) < 0.0) {
        std::vector<PlanePoint> reversed(corners.rbegin(), corners.rend());
        path.polygon(reversed);
    } else {
        path.polygon(corners);
    }
}

void PolygonBatch::draw(SvgPicture& picture, double seam) const {
    for (const auto& [colour, path] : paths_) {
        Paint paint = filled(colour);
        if (seam > 0.0) {
            paint.stroke = colour;
            paint.stroke_width = seam;
        }
        picture.path(path, paint);
    }
}

}  // namespace ricci
