#include <algorithm>
#include <array>
#include <cmath>

#include "engine/app/console.h"
#include "engine/app/pictures/copy_colours.h"
#include "engine/app/pictures/laid_out_domain.h"
#include "engine/app/pictures/picture_frame.h"
#include "engine/app/pictures/side_style.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

// Pale enough for outlines to show, different in lightness or in blue against yellow.
constexpr std::array<Colour, 6> kTints = {
    {{250, 226, 164}, {178, 209, 238}, {240, 190, 165}, {186, 226, 208}, {226, 204, 226}, {218, 218, 218}}};
constexpr Colour kFirst{255, 200, 60}, kOutline{60, 66, 78};
constexpr double kPeriods = 1.75;                    // of the domain on each side of its middle
constexpr double kSmallest = 1.0, kTolerance = 0.2;  // pixels
constexpr double kMargin = 12.0;                     // pixels
constexpr std::size_t kMaxPoints = 400'000;          // of all outlines: about 3 MB

/// Closed outline of the domain as positions; empty without sides.
std::vector<std::array<double, 3>> domain_outline(const StoredLayout& stored, const LaidOutDomain& domain) {
    std::vector<std::array<double, 3>> outline;
    for (const CutSide& side : stored.cut.sides) {
        const std::vector<Index> vertices = domain.side_vertices(side);
        for (std::size_t i = 0; i + 1 < vertices.size(); ++i)
            outline.push_back(stored.layout.position[at(vertices[i])]);
    }
    return outline;
}

/// Image of the outline in the model; empty where a point has none.
std::vector<PlanePoint> image_of(const ModelGeometry& geometry, int kappa, const Isometry<double>& copy,
                                 const std::vector<std::array<double, 3>>& outline) {
    std::vector<PlanePoint> points;
    for (const auto& position : outline) {
        const std::array<double, 3> moved = apply(kappa, copy, position);
        if (!geometry.shows(moved)) return {};
        points.push_back(geometry.point(moved));
    }
    return points;
}

bool overlap(const ViewBox& a, const ViewBox& b) {
    return a.left < b.left + b.width && b.left < a.left + a.width && a.bottom < b.bottom + b.height &&
           b.bottom < a.bottom + a.height;
}

ViewBox window_around(const ViewBox& box, double reach_x, double reach_y) {
    const double x = box.left + 0.5 * box.width, y = box.bottom + 0.5 * box.height;
    return {x - reach_x, y - reach_y, 2.0 * reach_x, 2.0 * reach_y};
}

ViewBox common_box(const ViewBox& a, const ViewBox& b) {
    const double left = std::max(a.left, b.left), bottom = std::max(a.bottom, b.bottom);
    return {left, bottom, std::min(a.left + a.width, b.left + b.width) - left,
            std::min(a.bottom + a.height, b.bottom + b.height) - bottom};
}

/// What the picture shows: the disk, the half plane about the domain, or several periods, as far as there are
/// copies.
ViewBox window_of(const ModelGeometry& geometry, const std::vector<std::vector<PlanePoint>>& images) {
    if (geometry.disk()) return {-1.0, -1.0, 2.0, 2.0};
    const ViewBox first = box_of(images.front());
    std::vector<PlanePoint> all;
    for (const std::vector<PlanePoint>& image : images) all.insert(all.end(), image.begin(), image.end());
    if (geometry.half_plane()) {
        const double top = first.bottom + first.height;
        return {first.left + 0.5 * first.width - 2.0 * top, 0.0, 4.0 * top, 1.25 * top};
    }
    const double reach = kPeriods * std::max(first.width, first.height);
    return common_box(window_around(first, reach, reach), box_of(all));
}

SvgPath outline_of_window(const ModelGeometry& geometry, const ViewBox& window) {
    SvgPath path;
    if (geometry.disk()) return path.circle({0.0, 0.0}, 1.0);
    const double right = window.left + window.width, top = window.bottom + window.height;
    return path.polygon(std::array<PlanePoint, 4>{
        {{window.left, window.bottom}, {right, window.bottom}, {right, top}, {window.left, top}}});
}

/// The outline with geodesics bent, as few points as the picture needs; empty where it is too small or out of
/// the window.
std::vector<PlanePoint> drawn_outline(const ModelGeometry& geometry, const std::vector<PlanePoint>& image,
                                      const PictureFrame& frame, const ViewBox& window) {
    if (image.size() < 3) return {};
    const ViewBox box = box_of(image);
    if (std::max(box.width, box.height) * frame.scale < kSmallest || !overlap(box, window)) return {};
    const double tolerance = kTolerance / frame.scale;
    std::vector<PlanePoint> points;
    for (std::size_t i = 0; i < image.size(); ++i)
        geometry.append_geodesic(points, image[i], image[(i + 1) % image.size()], tolerance);
    points.push_back(points.front());
    points = simplified(points, tolerance);
    points.pop_back();
    return points.size() < 3 ? std::vector<PlanePoint>{} : points;
}

void draw_copies(SvgPicture& picture, const std::vector<std::vector<PlanePoint>>& outlines,
                 const std::vector<std::size_t>& colour) {
    std::array<SvgPath, kTints.size()> paths;
    for (std::size_t i = 1; i < outlines.size(); ++i)
        if (!outlines[i].empty()) paths[colour[i]].polygon(outlines[i]);
    for (std::size_t k = 0; k < paths.size(); ++k) {
        Paint paint = filled(kTints[k]);
        paint.stroke = kOutline;
        paint.stroke_width = 0.4;
        picture.path(paths[k], paint);
    }
    if (!outlines.front().empty()) picture.polygon(outlines.front(), filled(kFirst), "domain");
}

/// The sides of the first copy, which is the domain itself.
void draw_first_sides(SvgPicture& picture, const StoredLayout& stored, const LaidOutDomain& domain) {
    const std::vector<int> pair = pair_numbers(stored.cut);
    for (std::size_t k = 0; k < stored.cut.sides.size(); ++k) {
        const std::vector<PlanePoint> points = domain.side_points(stored.cut.sides[k]);
        if (points.size() < 2) continue;
        SvgPath path;
        domain.append_to(path, points);
        picture.path(path, side_paint(pair[k], 2.2), stored.cut.sides[k].name);
    }
}

}  // namespace

SvgPicture draw_tessellation(const StoredLayout& stored, LayoutModel model, double pixels) {
    if (stored.copies.empty()) throw UsageError("no copies of the domain: give --copies");
    const LaidOutDomain domain(stored, model);
    const ModelGeometry& geometry = domain.geometry();
    const std::vector<std::array<double, 3>> outline = domain_outline(stored, domain);
    if (outline.size() < 3) throw UsageError("the domain has no sides: the surface is simply connected");
    std::vector<std::vector<PlanePoint>> images;
    for (const Isometry<double>& copy : stored.copies)
        images.push_back(image_of(geometry, stored.layout.kappa, copy, outline));
    if (images.front().empty()) throw UsageError("the domain does not fit into the model");
    const ViewBox window = window_of(geometry, images);
    const PictureFrame frame = make_frame(window, pixels, kMargin, false);
    std::size_t points = 0;
    for (std::vector<PlanePoint>& image : images) {
        image = drawn_outline(geometry, image, frame, window);
        points += image.size();
        if (points > kMaxPoints) image.clear();
    }
    SvgPicture picture(frame.width, frame.height, frame.view);
    const SvgPath edge = outline_of_window(geometry, window);
    picture.begin_group("copies", edge);
    draw_copies(picture, images,
                copy_colours(neighbours_of_copies(stored.layout, stored.copies), kTints.size()));
    draw_first_sides(picture, stored, domain);
    picture.end_group();
    picture.path(edge, stroked(kGrey, 1.0));
    return picture;
}

}  // namespace ricci::app
