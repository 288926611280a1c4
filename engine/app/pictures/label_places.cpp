#include "engine/app/pictures/label_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/app/pictures/side_style.h"

namespace ricci::app {
namespace {

constexpr double kTextSize = 13.0, kObstacleStep = 3.0, kShortest = 6.0;  // pixels
constexpr std::array<double, 9> kFractions = {0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.16, 0.84};
constexpr std::array<double, 5> kDistances = {5.0, 9.0, 15.0, 22.0, 32.0};  // pixels

double length_of(std::span<const PlanePoint> line) {
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
        length += std::hypot(line[i + 1][0] - line[i][0], line[i + 1][1] - line[i][1]);
    return length;
}

/// The point at a length along the line.
PlanePoint point_at(std::span<const PlanePoint> line, double along) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const double step = std::hypot(line[i + 1][0] - line[i][0], line[i + 1][1] - line[i][1]);
        if (along <= step && step > 0.0) {
            const double t = std::max(0.0, along / step);
            return {std::lerp(line[i][0], line[i + 1][0], t), std::lerp(line[i][1], line[i + 1][1], t)};
        }
        along -= step;
    }
    return line.back();
}

}  // namespace

std::vector<PlanePoint> LabelPlaces::pixels(std::span<const PlanePoint> line) const {
    std::vector<PlanePoint> result;
    for (const PlanePoint& p : line)
        result.push_back(
            {(p[0] - frame_.view.left) * frame_.scale, (p[1] - frame_.view.bottom) * frame_.scale});
    return result;
}

void LabelPlaces::avoid(std::span<const PlanePoint> line) {
    const std::vector<PlanePoint> drawn = pixels(line);
    const double length = length_of(drawn);
    if (drawn.empty()) return;
    const auto steps = static_cast<std::int64_t>(length / kObstacleStep);
    for (std::int64_t k = 0; k <= steps; ++k)
        obstacles_.push_back(point_at(drawn, static_cast<double>(k) * kObstacleStep));
}

double LabelPlaces::cost(const Box& box) const {
    constexpr double kOutside = 1000.0, kOnName = 100.0;
    double cost = 0.0;
    if (box.low[0] < 0.0 || box.low[1] < 0.0 || box.high[0] > frame_.width || box.high[1] > frame_.height)
        cost += kOutside;
    for (const Box& other : taken_)
        if (box.low[0] < other.high[0] && other.low[0] < box.high[0] && box.low[1] < other.high[1] &&
            other.low[1] < box.high[1])
            cost += kOnName;
    for (const PlanePoint& p : obstacles_)
        if (p[0] > box.low[0] && p[0] < box.high[0] && p[1] > box.low[1] && p[1] < box.high[1]) cost += 1.0;
    return cost;
}

std::optional<PlanePoint> LabelPlaces::place(std::span<const PlanePoint> line, double width, double height) {
    const std::vector<PlanePoint> drawn = pixels(line);
    const double length = length_of(drawn);
    if (length < kShortest) return std::nullopt;
    double least = std::numeric_limits<double>::infinity();
    Box best{};
    for (const double distance : kDistances)
        for (const double fraction : kFractions) {
            const double along = fraction * length, reach = std::min(12.0, 0.5 * length);
            const PlanePoint p = point_at(drawn, along), a = point_at(drawn, std::max(0.0, along - reach)),
                             b = point_at(drawn, std::min(length, along + reach));
            const double chord = std::max(std::hypot(b[0] - a[0], b[1] - a[1]), 1e-9);
            const PlanePoint normal{(b[1] - a[1]) / chord, (a[0] - b[0]) / chord};
            const double away = distance + 0.5 * (std::abs(normal[0]) * width + std::abs(normal[1]) * height);
            const PlanePoint centre{p[0] + away * normal[0], p[1] + away * normal[1]};
            const Box box{{centre[0] - 0.5 * width, centre[1] - 0.5 * height},
                          {centre[0] + 0.5 * width, centre[1] + 0.5 * height}};
            // Far places only where they are better by more than a touched line.
            const double price = cost(box) + 0.05 * distance;
            if (price >= least) continue;
            least = price;
            best = box;
        }
    taken_.push_back(best);
    return PlanePoint{frame_.view.left + 0.5 * (best.low[0] + best.high[0]) / frame_.scale,
                      frame_.view.bottom + 0.5 * (best.low[1] + best.high[1]) / frame_.scale};
}

void write_name(SvgPicture& picture, LabelPlaces& places, std::span<const PlanePoint> line,
                const std::string& name, const Paint& paint) {
    const bool inverse = name.ends_with("^-1");
    const auto letters = static_cast<double>(name.size() - (inverse ? 3 : 0));
    const double width = kTextSize * (0.64 * letters + (inverse ? 0.9 : 0.0));
    const std::optional<PlanePoint> centre = places.place(line, width, kTextSize);
    if (!centre) return;
    TextStyle style;
    style.size = kTextSize;
    style.anchor = TextAnchor::middle;
    style.colour = paint.stroke.value_or(kBlack);
    style.up = -0.36 * kTextSize;  // letters are centred, not their baseline
    style.bold = true;
    picture.text(*centre, set_name(name), style);
}

}  // namespace ricci::app
