#include "engine/app/pictures/draw_curves.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/app/console.h"
#include "engine/app/pictures/label_places.h"
#include "engine/app/pictures/side_style.h"
#include "engine/app/pictures/surface_view.h"
#include "io/picture/polygon_batch.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

constexpr Colour kPlain{236, 233, 226};
constexpr double kDarkest = 0.55;  // of a colour's lightness, where no light falls
constexpr double kShades = 20.0;   // few colours make few elements
constexpr double kSmallest = 0.2;  // square pixels: smaller triangles between samples are left out
constexpr double kMargin = 16.0;   // pixels
constexpr double kShortest = 0.7;  // pixels: shorter segments are joined to the next

/// A point as the viewer sees it.
struct SeenPoint {
    PlanePoint place;
    double depth = 0.0;
};

/// The steps of draw_curves.
class CurveDrawing {
  public:
    CurveDrawing(const SurfaceMesh& mesh, std::span<const DrawnCurve> curves, double pixels)
        : faces_(triangles_of(mesh.connectivity)), curves_(curves) {
        std::vector<Point> front;
        for (const DrawnCurve& curve : curves)
            front.insert(front.end(), curve.points.begin(), curve.points.end());
        axes_ = view_axes(mesh.points, faces_, front);
        for (const Point& p : mesh.points) vertices_.push_back(seen(p));
        frame_ = make_frame(bounds(), pixels, kMargin, false);
    }

    SvgPicture draw() {
        double nearest = -HUGE_VAL, farthest = HUGE_VAL;
        for (const Triangle& f : faces_)
            for (const Index v : f) {
                nearest = std::max(nearest, vertices_[at(v)].depth);
                farthest = std::min(farthest, vertices_[at(v)].depth);
            }
        SvgPicture picture(frame_.width, frame_.height, frame_.view);
        DepthImage image(bounds(), std::max(16, static_cast<int>(std::max(frame_.width, frame_.height))),
                         nearest - farthest);
        for (const Triangle& f : faces_) image.add(triangle(f));
        draw_faces(picture, image);
        draw_lines(picture, image);
        return picture;
    }

  private:
    [[nodiscard]] SeenPoint seen(const Point& p) const {
        const Eigen::Vector3d x = axes_ * Eigen::Vector3d(p[0], p[1], p[2]);
        return {{x[0], x[1]}, x[2]};
    }

    [[nodiscard]] ViewBox bounds() const {
        std::vector<PlanePoint> corners;
        for (const Triangle& f : faces_)
            for (const Index v : f) corners.push_back(vertices_[at(v)].place);
        return box_of(corners);
    }

    [[nodiscard]] SeenTriangle triangle(const Triangle& f) const {
        SeenTriangle t{};
        for (std::size_t k = 0; k < 3; ++k) {
            t.corner[k] = vertices_[at(f[k])].place;
            t.depth[k] = vertices_[at(f[k])].depth;
        }
        return t;
    }

    /// Twice the area of a seen triangle long, towards the viewer.
    static Eigen::Vector3d normal(const SeenTriangle& t) {
        const auto side = [&t](std::size_t k) {
            return Eigen::Vector3d(t.corner[k][0] - t.corner[0][0], t.corner[k][1] - t.corner[0][1],
                                   t.depth[k] - t.depth[0]);
        };
        const Eigen::Vector3d n = side(1).cross(side(2));
        return n[2] < 0.0 ? Eigen::Vector3d(-n) : n;
    }

    /// The plain colour in a light from above the viewer's left shoulder.
    static Colour shade(const SeenTriangle& t) {
        const Eigen::Vector3d n = normal(t);
        const double length = n.norm();
        const double light =
            length > 0.0 ? std::max(0.0, n.dot(Eigen::Vector3d(-0.35, 0.45, 0.82).normalized()) / length)
                         : 0.0;
        LabColour lab = lab_of(kPlain);
        lab.lightness *= kDarkest + (1.0 - kDarkest) * std::round(light * kShades) / kShades;
        return colour_of(lab);
    }

    /// Faces that something hides in part from far to near, then all that nothing hides, a colour at a time.
    void draw_faces(SvgPicture& picture, const DepthImage& image) const {
        std::vector<SeenTriangle> partial;
        PolygonBatch whole;
        for (const Triangle& f : faces_) {
            const SeenTriangle t = triangle(f);
            const Visibility visibility = image.visibility(t);
            if (visibility == Visibility::whole) whole.add(shade(t), t.corner);
            if (visibility == Visibility::partial &&
                0.5 * normal(t)[2] * frame_.scale * frame_.scale > kSmallest)
                partial.push_back(t);
        }
        std::ranges::stable_sort(partial, {},
                                 [](const SeenTriangle& t) { return t.depth[0] + t.depth[1] + t.depth[2]; });
        picture.begin_group("surface");
        for (const SeenTriangle& t : partial) {
            PolygonBatch one;
            one.add(shade(t), t.corner);
            one.draw(picture, 0.5);
        }
        whole.draw(picture, 0.5);
        picture.end_group();
    }

    [[nodiscard]] Paint paint_of(std::size_t k, double width) const {
        Paint paint = pair_paint(k, width);
        if (curves_[k].colour) paint = stroked(*curves_[k].colour, width);
        return paint;
    }

    /// Points of a curve that are some way apart in the picture, its ends among them.
    [[nodiscard]] std::vector<SeenPoint> thinned(const std::vector<Point>& points) const {
        std::vector<SeenPoint> line;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const SeenPoint p = seen(points[i]);
            const bool last = i + 1 == points.size();
            if (!line.empty() && !last &&
                std::hypot(p.place[0] - line.back().place[0], p.place[1] - line.back().place[1]) *
                        frame_.scale <
                    kShortest)
                continue;
            line.push_back(p);
        }
        return line;
    }

    /// Draws a curve and leaves the longest stretch of it that is seen.
    void draw_line(SvgPicture& picture, const DepthImage& image, std::size_t k,
                   std::vector<PlanePoint>& longest) const {
        const std::vector<SeenPoint> line = thinned(curves_[k].points);
        SvgPath shown, hidden;
        std::vector<PlanePoint> stretch;
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const PlanePoint &a = line[i].place, &b = line[i + 1].place;
            const bool shows = image.shows({0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])},
                                           0.5 * (line[i].depth + line[i + 1].depth));
            (shows ? shown : hidden).arc({a, b, 0.0});
            if (shows && stretch.empty()) stretch.push_back(a);
            if (shows) stretch.push_back(b);
            if (stretch.size() > longest.size()) longest = stretch;
            if (!shows) stretch.clear();
        }
        Paint faint = paint_of(k, 1.2);
        faint.dashes = {3.0, 3.0};
        faint.opacity = 0.6;
        picture.path(hidden, faint);
        picture.path(shown, stroked(kWhite, 4.0));
        picture.path(shown, paint_of(k, 2.0));
    }

    void draw_lines(SvgPicture& picture, const DepthImage& image) const {
        picture.begin_group("curves");
        std::vector<std::vector<PlanePoint>> longest(curves_.size());
        for (std::size_t k = curves_.size(); k > 0; --k) draw_line(picture, image, k - 1, longest[k - 1]);
        LabelPlaces places(frame_);
        for (const std::vector<PlanePoint>& line : longest) places.avoid(line);
        for (std::size_t k = 0; k < curves_.size(); ++k)
            if (longest[k].size() > 1 && !curves_[k].name.empty())
                write_name(picture, places, longest[k], curves_[k].name, paint_of(k, 1.0));
        picture.end_group();
    }

    std::vector<Triangle> faces_;
    std::span<const DrawnCurve> curves_;
    Eigen::Matrix3d axes_;
    std::vector<SeenPoint> vertices_;
    PictureFrame frame_;
};

}  // namespace

SvgPicture draw_curves(const SurfaceMesh& mesh, std::span<const DrawnCurve> curves, double pixels) {
    if (mesh.intrinsic()) throw UsageError("an intrinsic surface has no points in space to draw");
    return CurveDrawing(mesh, curves, pixels).draw();
}

}  // namespace ricci::app
