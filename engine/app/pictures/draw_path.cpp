#include "engine/app/pictures/draw_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "engine/app/pictures/text_places.h"
#include "engine/shape_space/principal_components.h"
#include "io/picture/colour.h"
#include "io/picture/colour_map.h"

namespace ricci::app {
namespace {

// User units are pixels.
constexpr double kSide = 420.0, kLeft = 62.0, kBottom = 52.0, kTop = 44.0, kText = 10.0;
constexpr double kBar = 12.0, kGap = 14.0, kNumbers = 58.0, kWide = 460.0, kNames = 24.0;
constexpr double kSecond = kLeft + kSide + kGap + kBar + kNumbers + kLeft;
constexpr std::size_t kMostLines = 12, kMostNumbers = 24;

Colour colour_of_line(std::size_t k) {
    return kCategoryColours[k % kCategoryColours.size()];
}

std::vector<double> dashes_of(std::size_t k) {
    constexpr std::array<std::array<double, 2>, 3> kDashes = {{{7, 3}, {2, 3}, {12, 4}}};
    if (k == 0) return {};
    const auto& d = kDashes[(k - 1) % kDashes.size()];
    return {d[0], d[1]};
}

/// A range that is never empty.
Axis widened(double low, double high, double by) {
    const double size = std::max(high - low, 1e-9 * std::max({1.0, std::abs(low), std::abs(high)}));
    return {low - by * size, high + by * size};
}

/// Ticks, numbers and captions around a rectangle.
struct Panel {
    ViewBox box;
    Axis x, y;
    std::string x_caption, y_caption;

    [[nodiscard]] PlanePoint at(double u, double v) const {
        return {box.left + box.width * x.fraction_of(u), box.bottom + box.height * y.fraction_of(v)};
    }
    void draw(SvgPicture& picture) const {
        picture.begin_group("axes");
        const Paint thin = stroked(kBlack, 0.75), faint = stroked({225, 225, 225}, 0.5);
        const double right = box.left + box.width, top = box.bottom + box.height;
        TextStyle style;
        style.size = kText;
        for (const double t : x.ticks(6)) {
            const double u = at(t, y.low())[0];
            picture.line({u, box.bottom}, {u, top}, faint);
            picture.line({u, box.bottom}, {u, box.bottom - 4.0}, thin);
            style.anchor = TextAnchor::middle;
            picture.text({u, box.bottom - 15.0}, tick_label(t), style);
        }
        for (const double t : y.ticks(6)) {
            const double v = at(x.low(), t)[1];
            picture.line({box.left, v}, {right, v}, faint);
            picture.line({box.left, v}, {box.left - 4.0, v}, thin);
            style.anchor = TextAnchor::end;
            picture.text({box.left - 7.0, v - 0.35 * kText}, tick_label(t), style);
        }
        const std::array<PlanePoint, 4> outline = {
            {{box.left, box.bottom}, {right, box.bottom}, {right, top}, {box.left, top}}};
        picture.polygon(outline, thin);
        style.anchor = TextAnchor::middle;
        picture.text({0.5 * (box.left + right), box.bottom - 34.0}, x_caption, style);
        style.angle = 1.5707963267948966;  // upwards
        picture.text({box.left - 46.0, 0.5 * (box.bottom + top)}, y_caption, style);
        picture.end_group();
    }
};

/// A frame that has coordinates.
struct Mark {
    std::size_t frame = 0;
    const DrawnFrame* drawn = nullptr;
    std::array<double, 2> place{};  // in the left panel's units
};

class PathDrawing {
  public:
    PathDrawing(const std::vector<DrawnSequence>& sequences, const std::vector<std::string>& names)
        : names_(names) {
        for (const DrawnSequence& s : sequences) {
            std::vector<Mark>& marks = marks_.emplace_back();
            for (std::size_t k = 0; k < s.frames.size(); ++k) {
                last_frame_ = std::max(last_frame_, k);
                const std::vector<double>& c = s.frames[k].coordinates;
                if (c.empty()) continue;
                if (c.size() != names.size()) throw std::invalid_argument("not one coordinate per name");
                marks.push_back({k, &s.frames[k], {}});
                points_.push_back(c);
            }
        }
        if (points_.empty()) throw std::invalid_argument("no frame has coordinates");
        components_ = principal_components(points_);
        for (std::vector<Mark>& marks : marks_)
            for (Mark& m : marks) m.place = place_of(m.drawn->coordinates);
    }

    SvgPicture draw(const std::string& title) const {
        std::size_t longest = 0;
        for (const std::size_t k : chosen()) longest = std::max(longest, names_[k].size());
        const double width = kSecond + kWide + kNames + 0.62 * kText * static_cast<double>(longest),
                     height = kBottom + kSide + kTop;
        SvgPicture picture(width, height, {0.0, 0.0, width, height});
        picture.set_title(title);
        TextStyle style;
        style.size = 14.0;
        style.bold = true;
        picture.text({16.0, height - 22.0}, title, style);
        draw_curves(picture);
        draw_coordinates(picture);
        return picture;
    }

  private:
    [[nodiscard]] std::array<double, 2> place_of(const std::vector<double>& c) const {
        if (c.size() <= 2) return {c[0], c.size() > 1 ? c[1] : 0.0};
        const std::vector<double> p = components_.project(c, 2);
        return {p[0], p[1]};
    }
    [[nodiscard]] std::string caption(std::size_t k) const {
        if (names_.size() <= 2) return k < names_.size() ? names_[k] : "";
        return fmt::format("principal component {} ({:.3g} % of the variance)", k + 1,
                           100.0 * components_.share(k));
    }

    /// Equal scales: both axes have the range of the longer one.
    [[nodiscard]] Panel curve_panel() const {
        std::array<std::array<double, 2>, 2> range{};
        for (std::size_t k = 0; k < 2; ++k) {
            range[k] = {INFINITY, -INFINITY};
            for (const std::vector<Mark>& marks : marks_)
                for (const Mark& m : marks)
                    range[k] = {std::min(range[k][0], m.place[k]), std::max(range[k][1], m.place[k])};
        }
        const double half = 0.5 * std::max(range[0][1] - range[0][0], range[1][1] - range[1][0]);
        const auto axis = [&](std::size_t k) {
            const double middle = 0.5 * (range[k][0] + range[k][1]);
            return widened(middle - half, middle + half, 0.14);
        };
        const Axis x = axis(0), y = axis(1);
        return {{kLeft, kBottom, kSide, kSide}, x, y, caption(0), caption(1)};
    }

    [[nodiscard]] ColourScale time() const {
        return {Axis(0.0, std::max(1.0, static_cast<double>(last_frame_))), ColourMap::sequential};
    }

    void draw_curves(SvgPicture& picture) const {
        const Panel panel = curve_panel();
        panel.draw(picture);
        TextPlaces places(panel.box);
        picture.begin_group("curves");
        for (std::size_t s = 0; s < marks_.size(); ++s) {
            const Colour colour = marks_.size() > 1 ? colour_of_line(s) : kGrey;
            for (std::size_t k = 1; k < marks_[s].size(); ++k) {
                Paint paint = stroked(colour, 1.6);
                if (marks_[s][k].drawn->anew) paint.dashes = {3.0, 3.0};
                const PlanePoint from = spot(panel, marks_[s][k - 1]), to = spot(panel, marks_[s][k]);
                picture.line(from, to, paint);
                places.avoid(from, to);
            }
            for (const Mark& m : marks_[s]) {
                const PlanePoint p = spot(panel, m);
                Paint paint = filled(time().colour_of(static_cast<double>(m.frame)));
                paint.stroke = colour;
                paint.stroke_width = 1.2;
                picture.dot(p, 4.0, paint, fmt::format("{}: {}", m.frame, m.drawn->name));
                places.avoid({p[0] - 4.0, p[1] - 4.0, 8.0, 8.0});
            }
        }
        picture.end_group();
        write_frames(picture, panel, places);
        draw_colour_bar(picture, time(), {kLeft + kSide + kGap, kBottom, kBar, kSide - 20.0}, "frame", kText);
    }

    static PlanePoint spot(const Panel& panel, const Mark& m) { return panel.at(m.place[0], m.place[1]); }

    /// Names of the first and last frames, then numbers, as many as have room.
    void write_frames(SvgPicture& picture, const Panel& panel, TextPlaces& places) const {
        picture.begin_group("frames");
        std::vector<std::string> written;
        for (std::size_t s = 0; s < marks_.size(); ++s)
            for (const bool first : {true, false}) {
                if (marks_[s].empty() || (!first && marks_[s].size() == 1)) continue;
                const Mark& m = first ? marks_[s].front() : marks_[s].back();
                const std::string text = fmt::format("{} {}", m.frame, m.drawn->name);
                if (first && std::find(written.begin(), written.end(), text) != written.end()) continue;
                written.push_back(text);
                places.write(picture, spot(panel, m), text, marks_.size() > 1 ? colour_of_line(s) : kBlack,
                             kText, true);
            }
        std::size_t count = 1;
        for (const std::vector<Mark>& marks : marks_) count = std::max(count, marks.size());
        const std::size_t every = 1 + (count - 1) / kMostNumbers;
        for (const std::vector<Mark>& marks : marks_)
            for (std::size_t k = 1; k + 1 < marks.size(); ++k)
                if (k % every == 0)
                    places.write(picture, spot(panel, marks[k]), std::to_string(marks[k].frame), {90, 90, 90},
                                 kText - 1.0, false);
        picture.end_group();
    }

    /// Numbers of the coordinates to draw, ascending.
    [[nodiscard]] std::vector<std::size_t> chosen() const {
        std::vector<std::size_t> order(names_.size());
        std::iota(order.begin(), order.end(), 0U);
        if (order.size() <= kMostLines) return order;
        const auto variance = [&](std::size_t k) {
            double sum = 0.0;
            for (const std::vector<double>& p : points_)
                sum += (p[k] - components_.mean[k]) * (p[k] - components_.mean[k]);
            return sum;
        };
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return variance(a) > variance(b); });
        order.resize(kMostLines);
        std::sort(order.begin(), order.end());
        return order;
    }

    void draw_coordinates(SvgPicture& picture) const {
        const std::vector<std::size_t> lines = chosen();
        double low = INFINITY, high = -INFINITY;
        for (const std::vector<double>& p : points_)
            for (const std::size_t k : lines) {
                low = std::min(low, p[k]);
                high = std::max(high, p[k]);
            }
        const Panel panel{
            {kSecond, kBottom, kWide, kSide},
            Axis(0.0, std::max(1.0, static_cast<double>(last_frame_))),
            widened(low, high, 0.04),
            "frame",
            lines.size() < names_.size()
                ? fmt::format("coordinates: the {} of {} that vary most", lines.size(), names_.size())
                : "coordinates"};
        panel.draw(picture);
        picture.begin_group("coordinates");
        for (std::size_t i = 0; i < lines.size(); ++i)
            for (std::size_t s = 0; s < marks_.size(); ++s) draw_line(picture, panel, lines[i], i, s);
        picture.end_group();
        name_lines(picture, panel, lines);
        if (marks_.size() > 1) explain_dashes(picture, panel);
    }

    void draw_line(SvgPicture& picture, const Panel& panel, std::size_t coordinate, std::size_t i,
                   std::size_t s) const {
        Paint paint = stroked(colour_of_line(i), 1.4);
        paint.dashes = dashes_of(s);
        std::vector<PlanePoint> piece;
        const auto end_piece = [&] {
            if (piece.size() > 1) picture.polyline(piece, paint);
            piece.clear();
        };
        for (const Mark& m : marks_[s]) {
            if (m.drawn->anew) end_piece();
            piece.push_back(panel.at(static_cast<double>(m.frame), m.drawn->coordinates[coordinate]));
            if (s == 0) picture.dot(piece.back(), 1.8, filled(colour_of_line(i)));
        }
        end_piece();
    }

    /// Names at the ends of the lines of the sequence that is longest, from below upwards, none over another.
    void name_lines(SvgPicture& picture, const Panel& panel, const std::vector<std::size_t>& lines) const {
        const std::vector<Mark>& marks = *std::max_element(
            marks_.begin(), marks_.end(), [](const auto& a, const auto& b) { return end_of(a) < end_of(b); });
        struct End {
            double height;
            std::size_t line;
        };
        std::vector<End> ends;
        const Mark& last = marks.back();
        for (std::size_t i = 0; i < lines.size(); ++i)
            ends.push_back({panel.at(0.0, last.drawn->coordinates[lines[i]])[1], i});
        std::stable_sort(ends.begin(), ends.end(),
                         [](const End& a, const End& b) { return a.height < b.height; });
        const std::vector<double> heights = [&] {
            std::vector<double> h;
            h.reserve(ends.size());
            for (const End& e : ends) h.push_back(e.height);
            return spread_out(h, kText + 1.0);
        }();
        picture.begin_group("names");
        for (std::size_t k = 0; k < ends.size(); ++k) {
            TextStyle style;
            style.size = kText;
            style.colour = colour_of_line(ends[k].line);
            const double right = panel.box.left + panel.box.width;
            picture.line({right + 2.0, ends[k].height}, {right + 12.0, heights[k]},
                         stroked(style.colour, 0.6));
            picture.text({right + 14.0, heights[k] - 0.35 * kText}, names_[lines[ends[k].line]], style);
        }
        picture.end_group();
    }
    /// Above the panel: which sequence is drawn how.
    void explain_dashes(SvgPicture& picture, const Panel& panel) const {
        picture.begin_group("sequences");
        TextStyle style;
        style.size = kText;
        const double y = panel.box.bottom + panel.box.height + 9.0,
                     room = panel.box.width / static_cast<double>(marks_.size());
        for (std::size_t s = 0; s < marks_.size(); ++s) {
            if (marks_[s].empty()) continue;
            const double x = panel.box.left + room * static_cast<double>(s);
            Paint paint = stroked(colour_of_line(s), 1.6);
            paint.dashes = dashes_of(s);
            picture.line({x, y}, {x + 30.0, y}, paint);
            style.colour = colour_of_line(s);
            picture.text({x + 35.0, y - 0.35 * kText},
                         fmt::format("{} to {}", marks_[s].front().drawn->name, marks_[s].back().drawn->name),
                         style);
        }
        picture.end_group();
    }
    static std::size_t end_of(const std::vector<Mark>& marks) {
        return marks.empty() ? 0 : marks.back().frame + 1;
    }

    const std::vector<std::string>& names_;
    std::vector<std::vector<Mark>> marks_;     // per sequence
    std::vector<std::vector<double>> points_;  // coordinates of all marks
    PrincipalComponents components_;
    std::size_t last_frame_ = 0;
};

}  // namespace

SvgPicture draw_path(const std::vector<DrawnSequence>& sequences, const std::vector<std::string>& names,
                     const std::string& title) {
    return PathDrawing(sequences, names).draw(title);
}

}  // namespace ricci::app
