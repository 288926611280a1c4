#include "engine/app/pictures/depth_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricci::app {
namespace {

constexpr double kNothing = -std::numeric_limits<double>::infinity();
constexpr double kEqual = 1e-6;  // of the range: depths of one point from two triangles that share it

double cross(const PlanePoint& o, const PlanePoint& p, const PlanePoint& q) {
    return (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
}

}  // namespace

DepthImage::DepthImage(const ViewBox& box, int samples, double range) : box_(box), range_(range) {
    step_ = std::max({box.width, box.height, 1e-300}) / samples;
    columns_ = static_cast<int>(std::ceil(box.width / step_)) + 1;
    rows_ = static_cast<int>(std::ceil(box.height / step_)) + 1;
    depth_.assign(sample_at(0, rows_), kNothing);
}

template <class Visit>
void DepthImage::for_samples(const SeenTriangle& t, Visit visit) const {
    const double area = cross(t.corner[0], t.corner[1], t.corner[2]);
    if (area == 0.0 || !std::isfinite(area)) return;
    const auto [left, right] = std::minmax({t.corner[0][0], t.corner[1][0], t.corner[2][0]});
    const auto [bottom, top] = std::minmax({t.corner[0][1], t.corner[1][1], t.corner[2][1]});
    const int first = std::max(0, static_cast<int>(std::ceil((left - box_.left) / step_)));
    const int last = std::min(columns_ - 1, static_cast<int>(std::floor((right - box_.left) / step_)));
    const int lowest = std::max(0, static_cast<int>(std::ceil((bottom - box_.bottom) / step_)));
    const int highest = std::min(rows_ - 1, static_cast<int>(std::floor((top - box_.bottom) / step_)));
    for (int row = lowest; row <= highest; ++row)
        for (int column = first; column <= last; ++column) {
            const PlanePoint p{box_.left + column * step_, box_.bottom + row * step_};
            const double w0 = cross(t.corner[1], t.corner[2], p) / area,
                         w1 = cross(t.corner[2], t.corner[0], p) / area, w2 = 1.0 - w0 - w1;
            if (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) continue;
            visit(sample_at(column, row), w0 * t.depth[0] + w1 * t.depth[1] + w2 * t.depth[2]);
        }
}

void DepthImage::add(const SeenTriangle& triangle) {
    // The grid changes while it is visited, but not where the visit goes.
    for_samples(triangle,
                [&](std::size_t sample, double depth) { depth_[sample] = std::max(depth_[sample], depth); });
}

Visibility DepthImage::visibility(const SeenTriangle& t) const {
    bool seen = false, covered = false;
    for_samples(t, [&](std::size_t sample, double depth) {
        (depth_[sample] <= depth + kEqual * range_ ? seen : covered) = true;
    });
    if (seen) return covered ? Visibility::partial : Visibility::whole;
    if (covered) return Visibility::hidden;
    const PlanePoint middle{(t.corner[0][0] + t.corner[1][0] + t.corner[2][0]) / 3.0,
                            (t.corner[0][1] + t.corner[1][1] + t.corner[2][1]) / 3.0};
    return shows(middle, (t.depth[0] + t.depth[1] + t.depth[2]) / 3.0) ? Visibility::partial
                                                                       : Visibility::hidden;
}

bool DepthImage::shows(const PlanePoint& point, double depth, double slack) const {
    const int column = static_cast<int>(std::lround((point[0] - box_.left) / step_));
    const int row = static_cast<int>(std::lround((point[1] - box_.bottom) / step_));
    double farthest = std::numeric_limits<double>::infinity();
    for (int j = std::max(0, row - 1); j <= std::min(rows_ - 1, row + 1); ++j)
        for (int i = std::max(0, column - 1); i <= std::min(columns_ - 1, column + 1); ++i)
            farthest = std::min(farthest, depth_[sample_at(i, j)]);
    return depth >= farthest - slack * range_;
}

}  // namespace ricci::app
