#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/app/console.h"
#include "engine/app/pictures/label_places.h"
#include "engine/app/pictures/side_style.h"
#include "engine/app/pictures/surface_view.h"
#include "io/picture/checkerboard.h"
#include "io/picture/polygon_batch.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

constexpr Colour kPlain{236, 233, 226}, kLightSquare{247, 246, 242}, kDarkSquare{58, 84, 128},
    kBlurred{150, 162, 184};           // squares too small to tell apart
constexpr double kDarkest = 0.55;      // of a colour's lightness, where no light falls
constexpr double kShades = 20.0;       // few colours make few elements
constexpr double kSmallest = 0.2;      // square pixels: smaller triangles between samples are left out
constexpr double kMaxSquares = 200.0;  // along one piece
constexpr double kMargin = 16.0;       // pixels

Colour shaded(const Colour& colour, double light) {
    LabColour lab = lab_of(colour);
    lab.lightness *= kDarkest + (1.0 - kDarkest) * std::round(light * kShades) / kShades;
    return colour_of(lab);
}

double area_of(const SeenTriangle& t) {
    return 0.5 * std::abs((t.corner[1][0] - t.corner[0][0]) * (t.corner[2][1] - t.corner[0][1]) -
                          (t.corner[1][1] - t.corner[0][1]) * (t.corner[2][0] - t.corner[0][0]));
}

/// The steps of draw_surface.
class SurfaceDrawing {
  public:
    SurfaceDrawing(const StoredLayout& stored, const SurfacePicture& options)
        : stored_(stored),
          options_(options),
          chains_(stored.refinement),
          view_(stored.refinement, chains_, options.loops),
          frame_(make_frame(view_.bounds(), options.pixels, kMargin, options.colours.has_value())),
          picture_(frame_.width, frame_.height, frame_.view),
          image_(view_.bounds(), std::max(16, static_cast<int>(options.pixels)), view_.depth_range()),
          pieces_of_(at(view_.face_count())) {
        for (Index p = 0; p < stored.refinement.piece_count(); ++p) {
            const Index face = stored.refinement.input_face[at(p)];
            if (face < view_.face_count())
                pieces_of_[at(face)].push_back(p);  // others have no edges to be seen by
        }
        for (Index f = 0; f < view_.face_count(); ++f)
            if (view_.has(f)) image_.add(view_.triangle(f));
    }

    SvgPicture draw() {
        draw_faces();
        draw_loops();
        if (options_.colours) draw_bar(picture_, frame_, *options_.colours);
        return std::move(picture_);
    }

  private:
    /// Faces that something hides in part from far to near, then all that nothing hides, a colour at a time.
    void draw_faces() {
        std::vector<Index> partial, whole;
        for (Index f = 0; f < view_.face_count(); ++f) {
            if (!view_.has(f)) continue;
            const SeenTriangle triangle = view_.triangle(f);
            const Visibility visibility = image_.visibility(triangle);
            if (visibility == Visibility::whole) whole.push_back(f);
            if (visibility == Visibility::partial &&
                area_of(triangle) * frame_.scale * frame_.scale > kSmallest)
                partial.push_back(f);
        }
        const auto depth = [&](Index f) {
            const SeenTriangle t = view_.triangle(f);
            return t.depth[0] + t.depth[1] + t.depth[2];
        };
        std::stable_sort(partial.begin(), partial.end(),
                         [&](Index a, Index b) { return depth(a) < depth(b); });
        picture_.begin_group("surface");
        for (const Index f : partial) draw_together({&f, 1});
        draw_together(whole);
        picture_.end_group();
    }

    void draw_together(std::span<const Index> faces) {
        PolygonBatch ground, squares;
        for (const Index f : faces) {
            const std::vector<TexturedTriangle> texture =
                options_.checker > 0.0 ? textured(f) : std::vector<TexturedTriangle>{};
            const bool blurred = too_fine(texture, view_.area(f) * frame_.scale * frame_.scale);
            ground.add(shaded(colour_of_face(f, blurred), view_.light(f)), view_.triangle(f).corner);
            if (!blurred) add_squares(texture, view_.light(f), squares);
        }
        ground.draw(picture_, 0.5);
        squares.draw(picture_, 0.5);
    }

    [[nodiscard]] Colour colour_of_face(Index f, bool blurred) const {
        if (options_.colours) return options_.colours->scale.colour_of(options_.colours->value[at(f)]);
        if (blurred) return kBlurred;
        return options_.checker > 0.0 ? kLightSquare : kPlain;
    }

    /// A face's pieces, texture coordinates linear on each triangle of their fans.
    [[nodiscard]] std::vector<TexturedTriangle> textured(Index face) const {
        const CommonRefinement& r = stored_.refinement;
        std::vector<TexturedTriangle> triangles;
        for (const Index p : pieces_of_[at(face)]) {
            const Index a = r.first[at(p)];
            for (Index c = a + 1; c + 1 < r.first[at(p) + 1]; ++c) {
                TexturedTriangle& t = triangles.emplace_back();
                std::size_t k = 0;
                for (const Index corner : {a, c, c + 1}) {
                    t.corners[k] = view_.seen(r.vertex[at(corner)]);
                    t.uv[k++] = texture(corner);
                }
            }
        }
        return triangles;
    }

    /// Whether a face of so many square pixels (seen from the front) has squares of less than seven, or very
    /// many along one of its pieces (next to the centre of a stereographic projection), or coordinates that
    /// are not finite.
    [[nodiscard]] bool too_fine(const std::vector<TexturedTriangle>& triangles, double pixels) const {
        double squares = 0.0;
        for (const TexturedTriangle& t : triangles) {
            const ViewBox box = box_of(t.uv);
            if (!(std::max(box.width, box.height) < kMaxSquares * options_.checker)) return true;
            squares += area_of({t.uv, {}}) / (options_.checker * options_.checker);
        }
        return squares > pixels / 7.0;
    }

    void add_squares(const std::vector<TexturedTriangle>& triangles, double light,
                     PolygonBatch& batch) const {
        if (triangles.empty()) return;
        const PlanePolygons polygons = black_squares(triangles, options_.checker);
        const Colour colour = shaded(kDarkSquare, light);
        for (std::size_t i = 0; i < polygons.size(); ++i) batch.add(colour, polygons.polygon(i));
    }

    [[nodiscard]] PlanePoint texture(Index corner) const {
        const SurfaceLayout& layout = stored_.layout;
        return model_point(LayoutModel::conformal, layout.kappa,
                           layout.position[at(layout.corner_vertex[at(corner)])]);
    }

    [[nodiscard]] bool shows_step(Index a, Index b) const {
        const PlanePoint p = view_.seen(a), q = view_.seen(b);
        return image_.shows({0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])},
                            0.5 * (view_.depth(a) + view_.depth(b)));
    }

    /// The longest stretch of a loop that is seen.
    void draw_loop(const std::vector<Index>& loop, const Paint& paint, std::vector<PlanePoint>& longest) {
        SvgPath seen, hidden;
        std::vector<PlanePoint> stretch;
        for (std::size_t i = 0; i + 1 < loop.size(); ++i) {
            const PlanePoint a = view_.seen(loop[i]), b = view_.seen(loop[i + 1]);
            const bool shows = shows_step(loop[i], loop[i + 1]);
            (shows ? seen : hidden).arc({a, b, 0.0});
            if (shows && stretch.empty()) stretch.push_back(a);
            if (shows) stretch.push_back(b);
            if (stretch.size() > longest.size()) longest = stretch;
            if (!shows) stretch.clear();
        }
        Paint faint = paint;
        faint.stroke_width = 1.2;
        faint.dashes = {3.0, 3.0};
        faint.opacity = 0.6;
        picture_.path(hidden, faint);
        picture_.path(seen, stroked(kWhite, paint.stroke_width + 2.0));
        picture_.path(seen, paint);
    }

    void draw_loops() {
        if (options_.loops.empty()) return;
        picture_.begin_group("loops");
        std::vector<std::vector<PlanePoint>> longest(options_.loops.size());
        for (std::size_t k = 0; k < options_.loops.size(); ++k)
            draw_loop(options_.loops[k], pair_paint(k, 2.4), longest[k]);
        LabelPlaces places(frame_);
        for (const std::vector<PlanePoint>& line : longest) places.avoid(line);
        for (std::size_t k = 0; k < std::min(longest.size(), options_.loop_names.size()); ++k)
            if (longest[k].size() > 1)
                write_name(picture_, places, longest[k], options_.loop_names[k], pair_paint(k, 1.0));
        picture_.end_group();
    }

    const StoredLayout& stored_;
    const SurfacePicture& options_;
    EdgeChains chains_;
    SurfaceView view_;
    PictureFrame frame_;
    SvgPicture picture_;
    DepthImage image_;
    std::vector<std::vector<Index>> pieces_of_;  // per input face
};

}  // namespace

SvgPicture draw_surface(const StoredLayout& stored, const SurfacePicture& options) {
    return SurfaceDrawing(stored, options).draw();
}

}  // namespace ricci::app
