#include "engine/app/pictures/text_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ricci::app {

namespace {

double common_area(const ViewBox& a, const ViewBox& b) {
    const double width = std::min(a.left + a.width, b.left + b.width) - std::max(a.left, b.left),
                 height = std::min(a.bottom + a.height, b.bottom + b.height) - std::max(a.bottom, b.bottom);
    return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

}  // namespace

void TextPlaces::avoid(const PlanePoint& from, const PlanePoint& to) {
    const int steps = 1 + static_cast<int>(std::hypot(to[0] - from[0], to[1] - from[1]) / 3.0);
    for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        avoid({from[0] + t * (to[0] - from[0]) - 1.0, from[1] + t * (to[1] - from[1]) - 1.0, 2.0, 2.0});
    }
}

double TextPlaces::covered(const ViewBox& box) const {
    double area = box.width * box.height - common_area(box, bounds_);
    for (const ViewBox& t : taken_) area += common_area(box, t);
    return area;
}

void TextPlaces::write(SvgPicture& picture, const PlanePoint& point, const std::string& text,
                       const Colour& colour, double size, bool bold) {
    const double width = (bold ? 0.62 : 0.56) * size * static_cast<double>(text.size()), height = 0.9 * size;
    constexpr std::array<std::array<double, 2>, 8> kDirections = {
        {{0, 1}, {0, -1}, {1, 0}, {-1, 0}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
    ViewBox best;
    double least = std::numeric_limits<double>::infinity();
    for (const double away : {6.0, 14.0, 24.0}) {
        if (!bold && away > 6.0) break;
        for (const auto& d : kDirections) {
            const ViewBox box{point[0] + d[0] * (away + 0.5 * width) - 0.5 * width,
                              point[1] + d[1] * (away + 0.5 * height) - 0.5 * height, width, height};
            const double area = covered(box);
            if (area >= least) continue;
            least = area;
            best = box;
        }
    }
    if (!bold && least > 1e-6) return;
    taken_.push_back(best);
    TextStyle style;
    style.size = size;
    style.colour = colour;
    style.bold = bold;
    picture.text({best.left, best.bottom + 0.1 * size}, text, style);
}

std::vector<double> spread_out(const std::vector<double>& heights, double distance) {
    struct Cluster {
        double sum;  // of the places that its first member would like
        std::size_t count;
        [[nodiscard]] double first() const { return sum / static_cast<double>(count); }
    };
    std::vector<Cluster> clusters;
    for (const double h : heights) {
        clusters.push_back({h, 1});
        while (clusters.size() > 1) {
            const Cluster last = clusters.back();
            Cluster& before = clusters[clusters.size() - 2];
            const double size = distance * static_cast<double>(before.count);
            if (last.first() >= before.first() + size) break;
            before.sum += last.sum - size * static_cast<double>(last.count);
            before.count += last.count;
            clusters.pop_back();
        }
    }
    std::vector<double> result;
    for (const Cluster& c : clusters)
        for (std::size_t k = 0; k < c.count; ++k)
            result.push_back(c.first() + distance * static_cast<double>(k));
    return result;
}

}  // namespace ricci::app
