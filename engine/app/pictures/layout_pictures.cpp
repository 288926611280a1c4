#include "engine/app/pictures/layout_pictures.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "engine/app/console.h"
#include "io/picture/checkerboard.h"
#include "io/picture/circular_arc.h"
#include "io/picture/polygon_batch.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

// Okabe and Ito's colours: told apart with any of the usual colour deficiencies.
constexpr std::array<Colour, 7> kPairColours = {{{213, 94, 0},
                                                 {0, 114, 178},
                                                 {0, 158, 115},
                                                 {204, 121, 167},
                                                 {230, 159, 0},
                                                 {86, 180, 233},
                                                 {90, 60, 30}}};
constexpr Colour kFaceFill{238, 240, 244}, kEdge{150, 156, 166}, kDark{60, 66, 78};

PlanePoint point_of(const StoredLayout& s, LayoutModel model, const std::array<double, 3>& position) {
    return model_point(model, s.layout.kappa, position);
}

PlanePoint corner_point(const StoredLayout& s, LayoutModel model, Index corner) {
    return point_of(s, model, s.layout.position[at(s.layout.corner_vertex[at(corner)])]);
}

bool draws_disk(const StoredLayout& s, LayoutModel model) {
    return s.layout.kappa < 0 && model != LayoutModel::half_plane;
}

/// A geodesic of the model between two of its points, appended to a path: an arc in the Poincare disk,
/// straight lines elsewhere (sides are short).
void append_side(SvgPath& path, const StoredLayout& s, LayoutModel model, const PlanePoint& a,
                 const PlanePoint& b) {
    if (s.layout.kappa < 0 && model == LayoutModel::conformal &&
        std::hypot(b[0] - a[0], b[1] - a[1]) > 0.01) {
        path.arc(poincare_geodesic(a, b));
    } else {
        path.polyline(std::array<PlanePoint, 2>{a, b});
    }
}

/// The box around points with a margin, or the disk.
ViewBox box_around(const std::vector<PlanePoint>& points, bool disk, double right_margin) {
    if (disk) return {-1.04, -1.04, 2.08 + right_margin, 2.08};
    double left = 0, right = 1, bottom = 0, top = 1;
    bool first = true;
    for (const PlanePoint& p : points) {
        if (!std::isfinite(p[0]) || !std::isfinite(p[1])) continue;
        left = first ? p[0] : std::min(left, p[0]);
        right = first ? p[0] : std::max(right, p[0]);
        bottom = first ? p[1] : std::min(bottom, p[1]);
        top = first ? p[1] : std::max(top, p[1]);
        first = false;
    }
    const double size = std::max({right - left, top - bottom, 1e-300}), margin = 0.04 * size;
    return {left - margin, bottom - margin, right - left + 2 * margin + right_margin * size / 2,
            top - bottom + 2 * margin};
}

/// Piece sides along an input halfedge, from its tail to its head.
std::vector<std::vector<Index>> sides_by_halfedge(const CommonRefinement& r, std::size_t halfedges) {
    std::vector<std::vector<Index>> result(halfedges);
    for (Index c = 0; c < r.corner_count(); ++c)
        if (r.input_halfedge[at(c)] >= 0) result[at(r.input_halfedge[at(c)])].push_back(c);
    for (std::vector<Index>& chain : result) {
        std::map<Index, Index> by_start;
        for (const Index c : chain) by_start[r.vertex[at(c)]] = c;
        for (const Index c : chain) {
            // The first one starts where no other ends.
            const bool first = std::none_of(chain.begin(), chain.end(), [&](Index d) {
                return d != c && r.vertex[at(r.next(d))] == r.vertex[at(c)];
            });
            if (!first) continue;
            std::vector<Index> ordered{c};
            while (ordered.size() < chain.size()) {
                const auto next = by_start.find(r.vertex[at(r.next(ordered.back()))]);
                if (next == by_start.end()) break;
                ordered.push_back(next->second);
            }
            if (ordered.size() == chain.size()) chain = std::move(ordered);
            break;
        }
    }
    return result;
}

std::size_t halfedge_count(const CommonRefinement& r) {
    Index last = -1;
    for (const Index h : r.input_halfedge) last = std::max(last, h);
    return at(last + 1);
}

/// The outline of a side as points; every vertex of the refinement on it.
std::vector<PlanePoint> outline_of(const StoredLayout& s, LayoutModel model,
                                   const std::vector<std::vector<Index>>& along, const CutSide& side) {
    std::vector<PlanePoint> points;
    Index last = -1;
    for (const Index h : side.halfedges)
        for (const Index c : along[at(h)]) {
            points.push_back(corner_point(s, model, c));
            last = c;
        }
    if (last >= 0) points.push_back(corner_point(s, model, s.refinement.next(last)));
    return points;
}

/// Pair number of every side: partners share one.
std::vector<std::size_t> pair_numbers(const CutGraph& cut) {
    std::vector<std::size_t> number(cut.sides.size(), 0);
    std::size_t pairs = 0;
    for (std::size_t k = 0; k < cut.sides.size(); ++k) {
        const Index partner = cut.sides[k].partner;
        number[k] = partner >= 0 && at(partner) < k ? number[at(partner)] : pairs++;
    }
    return number;
}

void draw_sides(SvgPicture& picture, const StoredLayout& s, const DomainPicture& options) {
    const auto along = sides_by_halfedge(s.refinement, halfedge_count(s.refinement));
    const std::vector<std::size_t> pair = pair_numbers(s.cut);
    picture.begin_group("sides");
    for (std::size_t k = 0; k < s.cut.sides.size(); ++k) {
        const CutSide& side = s.cut.sides[k];
        const std::vector<PlanePoint> points = outline_of(s, options.model, along, side);
        if (points.size() < 2) continue;
        SvgPath path;
        for (std::size_t i = 0; i + 1 < points.size(); ++i)
            append_side(path, s, options.model, points[i], points[i + 1]);
        const Colour colour = side.partner < 0 ? kDark : kPairColours[pair[k] % kPairColours.size()];
        picture.path(path, stroked(colour, 2.5), side.name);
    }
    picture.end_group();
    if (!options.labels || s.cut.sides.size() > 64) return;
    picture.begin_group("names");
    for (std::size_t k = 0; k < s.cut.sides.size(); ++k) {
        const std::vector<PlanePoint> points = outline_of(s, options.model, along, s.cut.sides[k]);
        if (points.size() < 2) continue;
        double extent = 0;
        for (const PlanePoint& q : points)
            extent = std::max(extent, std::hypot(q[0] - points[0][0], q[1] - points[0][1]));
        if (extent * picture.scale() < 18) continue;  // no room for a name
        // Beside the middle, outside the domain (which lies on the left).
        const PlanePoint &a = points[points.size() / 2 - 1], &b = points[points.size() / 2];
        const double length = std::max(std::hypot(b[0] - a[0], b[1] - a[1]), 1e-300);
        TextStyle style;
        style.anchor = TextAnchor::middle;
        style.size = 13;
        style.colour = s.cut.sides[k].partner < 0 ? kDark : kPairColours[pair[k] % kPairColours.size()];
        style.right = 14 * (b[1] - a[1]) / length;
        style.up = -14 * (b[0] - a[0]) / length - 4;
        picture.text({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2}, s.cut.sides[k].name, style);
    }
    picture.end_group();
}

Colour shaded(const Colour& colour, double factor) {
    const auto channel = [&](std::uint8_t c) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(static_cast<double>(c) * factor), 0L, 255L));
    };
    return {channel(colour.red), channel(colour.green), channel(colour.blue)};
}

double quantile(std::vector<double> values, double q) {
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
                 values.end());
    if (values.empty()) return 0.0;
    const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<std::size_t>(k)];
}

std::vector<TexturedTriangle> fan_triangles(const StoredLayout& s, Index piece,
                                            const std::vector<PlanePoint>& drawn) {
    const CommonRefinement& r = s.refinement;
    std::vector<TexturedTriangle> triangles;
    const Index a = r.first[at(piece)];
    const auto uv = [&](Index c) { return corner_point(s, LayoutModel::conformal, c); };
    for (Index c = a + 1; c + 1 < r.first[at(piece) + 1]; ++c)
        triangles.push_back({{drawn[0], drawn[at(c - a)], drawn[at(c + 1 - a)]}, {uv(a), uv(c), uv(c + 1)}});
    return triangles;
}

}  // namespace

FaceColours diverging_colours(std::vector<double> value, double middle, const std::string& title) {
    const double spread =
        std::max({std::abs(quantile(value, 0.01) - middle), std::abs(quantile(value, 0.99) - middle), 1e-12});
    return {std::move(value),
            {Axis(middle - spread, middle + spread, ScaleKind::linear), ColourMap::diverging},
            title};
}

FaceColours sequential_colours(std::vector<double> value, const std::string& title) {
    const double low = quantile(value, 0.01), high = std::max(quantile(value, 0.99), low + 1e-12);
    return {std::move(value), {Axis(low, high, ScaleKind::linear), ColourMap::sequential}, title};
}

SvgPicture draw_domain(const StoredLayout& s, const DomainPicture& options) {
    const CommonRefinement& r = s.refinement;
    std::vector<PlanePoint> all;
    all.reserve(s.layout.position.size());
    for (const auto& p : s.layout.position) all.push_back(point_of(s, options.model, p));
    const bool disk = draws_disk(s, options.model) || (s.layout.kappa > 0 && !s.cut.sides.empty());
    const ViewBox view = box_around(all, disk, options.colours ? 0.36 : 0.0);
    SvgPicture picture(options.pixels * std::min(1.6, view.width / std::min(view.width, view.height)),
                       options.pixels * std::min(1.6, view.height / std::min(view.width, view.height)), view);
    if (disk) picture.circle({0, 0}, 1, {kWhite, kGrey, 1.0, 1.0, {}});
    PolygonBatch faces;
    std::vector<TexturedTriangle> triangles;
    for (Index p = 0; p < r.piece_count(); ++p) {
        std::vector<PlanePoint> corners;
        for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c)
            corners.push_back(corner_point(s, options.model, c));
        const bool finite = std::all_of(corners.begin(), corners.end(), [](const PlanePoint& q) {
            return std::isfinite(q[0]) && std::isfinite(q[1]);
        });
        if (!finite) continue;
        faces.add(options.colours
                      ? options.colours->scale.colour_of(options.colours->value[at(r.input_face[at(p)])])
                      : (options.checker > 0 ? kWhite : kFaceFill),
                  corners);
        if (options.checker <= 0) continue;
        const auto fan = fan_triangles(s, p, corners);
        triangles.insert(triangles.end(), fan.begin(), fan.end());
    }
    picture.begin_group("faces");
    faces.draw(picture);
    picture.end_group();
    if (options.checker > 0) {
        const PlanePolygons squares = black_squares(triangles, options.checker);
        PolygonBatch black;
        for (std::size_t k = 0; k < squares.size(); ++k) black.add(kDark, squares.polygon(k));
        picture.begin_group("checkerboard");
        black.draw(picture);
        picture.end_group();
    } else if (r.piece_count() <= 40000) {
        SvgPath edges;
        for (Index c = 0; c < r.corner_count(); ++c)
            if (r.input_halfedge[at(c)] >= 0 && c > r.twin[at(c)])
                append_side(edges, s, options.model, corner_point(s, options.model, c),
                            corner_point(s, options.model, r.next(c)));
        picture.begin_group("edges");
        picture.path(edges, {std::nullopt, kEdge, r.piece_count() > 8000 ? 0.15 : 0.3, 1.0, {}});
        picture.end_group();
    }
    draw_sides(picture, s, options);
    if (options.colours) {
        const double x = view.left + view.width - (disk ? 0.3 : 0.13 * view.width);
        draw_colour_bar(picture, options.colours->scale,
                        {x, view.bottom + 0.25 * view.height, 0.025 * view.height, 0.5 * view.height},
                        options.colours->title);
    }
    return picture;
}

SvgPicture draw_tessellation(const StoredLayout& s, LayoutModel model, double pixels) {
    if (s.copies.empty()) throw UsageError("no copies of the domain: give --copies");
    const auto along = sides_by_halfedge(s.refinement, halfedge_count(s.refinement));
    std::vector<std::array<double, 3>> outline;
    for (const CutSide& side : s.cut.sides)
        for (const Index h : side.halfedges)
            for (const Index c : along[at(h)])
                outline.push_back(s.layout.position[at(s.layout.corner_vertex[at(c)])]);
    if (outline.size() < 3) throw UsageError("the domain has no sides: the surface is simply connected");
    const bool disk = draws_disk(s, model);
    std::vector<std::vector<PlanePoint>> shapes;
    std::vector<PlanePoint> all;
    for (const Isometry<double>& g : s.copies) {
        std::vector<PlanePoint> shape;
        for (const auto& p : outline) {
            const PlanePoint q = point_of(s, model, apply(s.layout.kappa, g, p));
            // Points that would fall on the one before in the picture are left out.
            const double least = disk ? 2.0 / pixels : 0.0;
            if (shape.empty() || std::hypot(q[0] - shape.back()[0], q[1] - shape.back()[1]) > least)
                shape.push_back(q);
        }
        if (shape.size() < 3) continue;
        if (all.empty() || s.layout.kappa == 0) all.insert(all.end(), shape.begin(), shape.end());
        shapes.push_back(std::move(shape));
    }
    const ViewBox view = box_around(all, disk, 0.0);
    SvgPicture picture(pixels, pixels * std::min(1.6, view.height / view.width), view);
    SvgPath clip;
    if (disk) {
        picture.circle({0, 0}, 1, {kWhite, kGrey, 1.0, 1.0, {}});
        clip.circle({0, 0}, 1);
        picture.begin_group("copies", clip);
    } else {
        picture.begin_group("copies");
    }
    for (std::size_t k = shapes.size(); k > 0; --k) {
        const Colour base = kPairColours[(k - 1) % kPairColours.size()];
        const auto pale = [](std::uint8_t c) { return static_cast<std::uint8_t>(255 - (255 - c) / 3); };
        const Colour fill =
            k == 1 ? Colour{255, 214, 102} : Colour{pale(base.red), pale(base.green), pale(base.blue)};
        picture.polygon(shapes[k - 1], {fill, kDark, k == 1 ? 1.2 : 0.4, 1.0, {}});
    }
    picture.end_group();
    return picture;
}

SvgPicture draw_surface(const StoredLayout& s, const SurfacePicture& options) {
    const CommonRefinement& r = s.refinement;
    if (r.points.empty()) throw UsageError("an intrinsic surface has no points in space to draw");
    // Axes: the least extended one points to the viewer.
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    std::vector<Index> used(r.vertex);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const Index v : used)
        centre += Eigen::Vector3d(r.points[at(v)].data()) / static_cast<double>(used.size());
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const Index v : used) {
        const Eigen::Vector3d d = Eigen::Vector3d(r.points[at(v)].data()) - centre;
        moments += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
    Eigen::Matrix3d axes;
    axes.col(0) = solver.eigenvectors().col(2);
    axes.col(1) = solver.eigenvectors().col(1);
    for (int k = 0; k < 2; ++k) {  // deterministic: the largest entry is positive
        Eigen::Index largest = 0;
        axes.col(k).cwiseAbs().maxCoeff(&largest);
        if (axes(largest, k) < 0) axes.col(k) = -axes.col(k);
    }
    axes.col(2) = axes.col(0).cross(axes.col(1));
    // Tilted a little, so that depth shows.
    const Eigen::Matrix3d tilt = (Eigen::AngleAxisd(0.45, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(-0.35, Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix();
    std::vector<Eigen::Vector3d> seen(r.points.size());
    for (std::size_t v = 0; v < seen.size(); ++v)
        seen[v] = tilt * (axes.transpose() * (Eigen::Vector3d(r.points[v].data()) - centre));
    std::vector<PlanePoint> all;
    all.reserve(used.size());
    for (const Index v : used) all.push_back({seen[at(v)][0], seen[at(v)][1]});
    const ViewBox view = box_around(all, false, options.colours ? 0.3 : 0.0);
    const double narrow = std::min(view.width, view.height);
    SvgPicture picture(options.pixels * std::min(1.6, view.width / narrow),
                       options.pixels * std::min(1.6, view.height / narrow), view);
    struct Drawn {
        double depth;
        Index piece;
        double light;
    };
    std::vector<Drawn> order;
    for (Index p = 0; p < r.piece_count(); ++p) {
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double depth = 0;
        const Index a = r.first[at(p)], end = r.first[at(p) + 1];
        for (Index c = a; c < end; ++c) {
            const Eigen::Vector3d &x = seen[at(r.vertex[at(c)])], &y = seen[at(r.vertex[at(r.next(c))])];
            normal += (x - seen[at(r.vertex[at(a)])]).cross(y - seen[at(r.vertex[at(a)])]);
            depth += x[2] / static_cast<double>(end - a);
        }
        const double length = normal.norm();
        if (!(length > 0)) continue;
        order.push_back({depth, p, std::abs(normal.dot(Eigen::Vector3d(0.3, 0.4, 0.87))) / length});
    }
    std::stable_sort(order.begin(), order.end(),
                     [](const Drawn& x, const Drawn& y) { return x.depth < y.depth; });
    picture.begin_group("surface");
    for (const Drawn& drawn : order) {
        std::vector<PlanePoint> corners;
        for (Index c = r.first[at(drawn.piece)]; c < r.first[at(drawn.piece) + 1]; ++c)
            corners.push_back({seen[at(r.vertex[at(c)])][0], seen[at(r.vertex[at(c)])][1]});
        const double light = 0.55 + 0.45 * drawn.light;
        const Colour base =
            options.colours
                ? options.colours->scale.colour_of(options.colours->value[at(r.input_face[at(drawn.piece)])])
                : Colour{236, 232, 224};
        const Colour fill = shaded(base, light);
        picture.polygon(corners, {fill, fill, 0.3, 1.0, {}});
        if (options.checker <= 0) continue;
        const PlanePolygons squares = black_squares(fan_triangles(s, drawn.piece, corners), options.checker);
        for (std::size_t k = 0; k < squares.size(); ++k)
            picture.polygon(squares.polygon(k), filled(shaded({70, 90, 120}, light)));
    }
    picture.end_group();
    picture.begin_group("loops");
    for (std::size_t k = 0; k < options.loops.size(); ++k) {
        std::vector<PlanePoint> points;
        for (const Index v : options.loops[k]) points.push_back({seen[at(v)][0], seen[at(v)][1]});
        if (points.size() > 1) picture.polyline(points, stroked(kPairColours[k % kPairColours.size()], 2.2));
    }
    picture.end_group();
    if (options.colours)
        draw_colour_bar(picture, options.colours->scale,
                        {view.left + 0.87 * view.width, view.bottom + 0.25 * view.height, 0.025 * view.height,
                         0.5 * view.height},
                        options.colours->title);
    return picture;
}

}  // namespace ricci::app
