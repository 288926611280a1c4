#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/app/pictures/label_places.h"
#include "engine/app/pictures/laid_out_domain.h"
#include "engine/app/pictures/side_style.h"
#include "io/picture/checkerboard.h"
#include "io/picture/polygon_batch.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

constexpr Colour kFaceFill{238, 241, 246}, kEdge{120, 128, 142}, kSquare{70, 84, 110};
constexpr double kTolerance = 0.15;    // pixels by which drawn lines may be off
constexpr double kSmallFace = 0.1;     // pixels: extent below which a face is left out
constexpr double kShortEdge = 0.4;     // pixels: shorter edges are left out ...
constexpr double kShortOver = 1.3;     // ... and over colours all that would make a grey spot
constexpr std::size_t kMaxNames = 80;  // sides

/// Draws one domain; the steps of draw_domain.
class DomainDrawing {
  public:
    DomainDrawing(const StoredLayout& stored, const DomainPicture& options)
        : stored_(stored),
          options_(options),
          domain_(stored, options.model),
          frame_(make_frame(domain_.bounds(), options.pixels, options.labels ? 44.0 : 12.0,
                            options.colours.has_value())),
          picture_(frame_.width, frame_.height, frame_.view),
          outline_(domain_.outline(tolerance())) {}

    SvgPicture draw() {
        if (options_.colours || outline_.empty())
            draw_faces();
        else
            draw_ground();
        if (options_.checker > 0.0) draw_checkerboard();
        draw_edges();
        draw_frame_of_model();
        draw_sides();
        if (options_.labels) draw_names();
        if (options_.colours) draw_bar(picture_, frame_, *options_.colours);
        return std::move(picture_);
    }

  private:
    [[nodiscard]] double tolerance() const { return kTolerance / frame_.scale; }

    void draw_ground() {
        picture_.begin_group("domain");
        picture_.polygon(outline_, filled(options_.checker > 0.0 ? kWhite : kFaceFill));
        picture_.end_group();
    }

    void draw_faces() {
        picture_.begin_group("faces");
        if (!outline_.empty()) picture_.polygon(outline_, filled(kFaceFill));
        PolygonBatch batch;
        for (Index f = 0; f < domain_.face_count(); ++f) {
            const std::vector<PlanePoint> outline = domain_.face_outline(f, tolerance());
            if (outline.empty()) continue;
            const ViewBox box = box_of(outline);
            if (std::max(box.width, box.height) * frame_.scale < kSmallFace) continue;
            batch.add(options_.colours ? options_.colours->scale.colour_of(options_.colours->value[at(f)])
                                       : (options_.checker > 0.0 ? kWhite : kFaceFill),
                      simplified(outline, 0.3 * tolerance()));
        }
        batch.draw(picture_);
        picture_.end_group();
    }

    /// The plane's checkerboard, clipped to the domain.
    void draw_checkerboard() {
        const ViewBox box = outline_.empty() ? domain_.bounds() : box_of(outline_);
        const double right = box.left + box.width, top = box.bottom + box.height;
        const std::array<PlanePoint, 4> corner = {
            {{box.left, box.bottom}, {right, box.bottom}, {right, top}, {box.left, top}}};
        const std::array<TexturedTriangle, 2> halves = {
            {{{corner[0], corner[1], corner[2]}, {corner[0], corner[1], corner[2]}},
             {{corner[0], corner[2], corner[3]}, {corner[0], corner[2], corner[3]}}}};
        const PlanePolygons squares = black_squares(halves, options_.checker);
        PolygonBatch black;
        for (std::size_t i = 0; i < squares.size(); ++i) black.add(kSquare, squares.polygon(i));
        SvgPath clip;
        clip.polygon(outline_.empty() ? std::span<const PlanePoint>(corner) : outline_);
        picture_.begin_group("checkerboard", clip);
        black.draw(picture_, 0.1);
        picture_.end_group();
    }

    /// Each edge once, without the sides.
    void draw_edges() {
        const CommonRefinement& r = stored_.refinement;
        std::vector<std::uint8_t> side(at(domain_.chains().halfedge_count()), 0);
        for (const CutSide& s : stored_.cut.sides)
            for (const Index h : s.halfedges)
                if (at(h) < side.size()) side[at(h)] = 1;
        const bool over = options_.colours || options_.checker > 0.0;
        SvgPath path;
        for (Index h = 0; h < domain_.chains().halfedge_count(); ++h) {
            const std::span<const Index> chain = domain_.chains().of(h);
            if (chain.empty() || side[at(h)]) continue;
            const Index twin = r.twin[at(chain.front())];
            if (twin >= 0 && r.input_halfedge[at(twin)] >= 0 && r.input_halfedge[at(twin)] < h) continue;
            const std::vector<PlanePoint> points = domain_.edge_points(h);
            if (points.empty()) continue;
            const ViewBox box = box_of(points);
            if (std::hypot(box.width, box.height) * frame_.scale < (over ? kShortOver : kShortEdge)) continue;
            append_edge(path, points);
        }
        Paint paint = stroked(options_.colours ? kBlack : kEdge, 0.3);
        if (over) paint.opacity = options_.colours ? 0.35 : 0.6;
        picture_.begin_group("edges");
        picture_.path(path, paint);
        picture_.end_group();
    }

    /// One geodesic as it is; several, which input edges are in the image, by straight lines.
    void append_edge(SvgPath& path, const std::vector<PlanePoint>& points) const {
        if (points.size() == 2) return domain_.append_to(path, points);
        std::vector<PlanePoint> sampled;
        for (std::size_t i = 0; i + 1 < points.size(); ++i)
            domain_.geometry().append_geodesic(sampled, points[i], points[i + 1], tolerance());
        sampled.push_back(points.back());
        path.polyline(simplified(sampled, tolerance()));
    }

    void draw_frame_of_model() {
        if (domain_.geometry().disk()) picture_.circle({0.0, 0.0}, 1.0, stroked(kGrey, 1.0));
        if (domain_.geometry().half_plane())
            picture_.line({frame_.view.left, 0.0}, {frame_.view.left + frame_.view.width, 0.0},
                          stroked(kGrey, 1.0));
    }

    void draw_sides() {
        const std::vector<int> pair = pair_numbers(stored_.cut);
        picture_.begin_group("sides");
        if (!outline_.empty() && (options_.colours || options_.checker > 0.0))
            picture_.polygon(outline_, stroked(kWhite, 4.5));
        SvgPath nodes;
        for (std::size_t k = 0; k < stored_.cut.sides.size(); ++k) {
            const std::vector<PlanePoint> points = domain_.side_points(stored_.cut.sides[k]);
            if (points.size() < 2) continue;
            SvgPath path;
            domain_.append_to(path, points);
            picture_.path(path, side_paint(pair[k], 2.5), stored_.cut.sides[k].name);
            nodes.circle(points.front(), 2.2 / frame_.scale);
        }
        picture_.path(nodes, filled(kBlack));
        picture_.end_group();
    }

    void draw_names() {
        if (stored_.cut.sides.size() > kMaxNames) return;
        const std::vector<int> pair = pair_numbers(stored_.cut);
        LabelPlaces places(frame_);
        places.avoid(outline_);
        if (domain_.geometry().disk()) {
            std::vector<PlanePoint> circle;
            for (int i = 0; i <= 360; ++i)
                circle.push_back(
                    {std::cos(i * std::numbers::pi / 180), std::sin(i * std::numbers::pi / 180)});
            places.avoid(circle);
        }
        picture_.begin_group("names");
        for (std::size_t k = 0; k < stored_.cut.sides.size(); ++k) {
            const std::vector<PlanePoint> points = domain_.side_points(stored_.cut.sides[k]);
            if (points.size() > 1)
                write_name(picture_, places, points, stored_.cut.sides[k].name, side_paint(pair[k], 1.0));
        }
        picture_.end_group();
    }

    const StoredLayout& stored_;
    const DomainPicture& options_;
    LaidOutDomain domain_;
    PictureFrame frame_;
    SvgPicture picture_;
    std::vector<PlanePoint> outline_;
};

}  // namespace

SvgPicture draw_domain(const StoredLayout& stored, const DomainPicture& options) {
    return DomainDrawing(stored, options).draw();
}

}  // namespace ricci::app
