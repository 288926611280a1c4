#include "io/picture/line_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ricci {
namespace {

// User units are pixels.
constexpr double kWidth = 560.0, kPlotHeight = 280.0, kLeft = 70.0, kRight = 18.0, kTop = 40.0, kBelow = 52.0;
constexpr double kText = 11.0, kLegendRow = 17.0, kLegendColumn = 240.0;
constexpr double kLargest = 1e150;  // beyond, differences and ratios would leave the range of double
constexpr std::size_t kDots = 60;   // series with more points are drawn without

/// Colours repeat with other dashes.
Paint series_paint(std::size_t k) {
    constexpr std::array<std::array<double, 2>, 3> kDashes = {{{7, 3}, {2, 3}, {12, 4}}};
    Paint paint = stroked(kCategoryColours[k % kCategoryColours.size()], 1.8);
    const std::size_t round = k / kCategoryColours.size();
    if (round > 0) paint.dashes.assign(kDashes[(round - 1) % 3].begin(), kDashes[(round - 1) % 3].end());
    return paint;
}

struct Frame {
    Axis x, y;
    double bottom = 0.0;

    [[nodiscard]] double right() const { return kWidth - kRight; }
    [[nodiscard]] double top() const { return bottom + kPlotHeight; }
    [[nodiscard]] PlanePoint at(const PlanePoint& p) const {
        return {kLeft + (right() - kLeft) * x.fraction_of(p[0]), bottom + kPlotHeight * y.fraction_of(p[1])};
    }
    [[nodiscard]] bool shows(const PlanePoint& p) const {
        const double u = x.fraction_of(p[0]), v = y.fraction_of(p[1]);
        return std::isfinite(u) && std::isfinite(v) && u >= -1e-9 && u <= 1 + 1e-9 && v >= -1e-9 &&
               v <= 1 + 1e-9;
    }
};

bool whole(double x) {
    return x == std::round(x);
}

/// Without those between whole numbers where all that is plotted has such (steps, counts).
std::vector<double> x_ticks(const Frame& f, const std::vector<PlotSeries>& series) {
    std::vector<double> ticks = f.x.ticks(7);
    const bool steps = std::all_of(series.begin(), series.end(), [](const PlotSeries& s) {
        return std::all_of(s.points.begin(), s.points.end(), [](const PlanePoint& p) { return whole(p[0]); });
    });
    if (steps) std::erase_if(ticks, [](double t) { return !whole(t); });
    return ticks;
}

void draw_axes(SvgPicture& picture, const Frame& f, const std::vector<PlotSeries>& series,
               const PlotLabels& labels) {
    const Paint thin = stroked(kBlack, 0.75), faint = stroked({228, 228, 228}, 0.6);
    TextStyle style;
    style.size = kText;
    picture.begin_group("axes");
    for (const double t : x_ticks(f, series)) {
        const double u = f.at({t, f.y.low()})[0];
        picture.line({u, f.bottom}, {u, f.top()}, faint);
        picture.line({u, f.bottom}, {u, f.bottom - 4.0}, thin);
        style.anchor = TextAnchor::middle;
        picture.text({u, f.bottom - 17.0}, tick_label(t), style);
    }
    for (const double t : f.y.ticks(6)) {
        const double v = f.at({f.x.low(), t})[1];
        picture.line({kLeft, v}, {f.right(), v}, faint);
        picture.line({kLeft, v}, {kLeft - 4.0, v}, thin);
        style.anchor = TextAnchor::end;
        picture.text({kLeft - 7.0, v - 0.35 * kText}, tick_label(t), style);
    }
    const std::array<PlanePoint, 4> outline = {
        {{kLeft, f.bottom}, {f.right(), f.bottom}, {f.right(), f.top()}, {kLeft, f.top()}}};
    picture.polygon(outline, thin);
    style.anchor = TextAnchor::middle;
    picture.text({0.5 * (kLeft + f.right()), f.bottom - 36.0}, labels.x, style);
    style.angle = 0.5 * std::numbers::pi;
    picture.text({16.0, 0.5 * (f.bottom + f.top())}, labels.y, style);
    picture.end_group();
}

void draw_series(SvgPicture& picture, const Frame& f, const PlotSeries& series, std::size_t k) {
    const Paint paint = series_paint(k);
    SvgPath path;
    bool open = false;
    std::vector<PlanePoint> shown;
    for (const PlanePoint& p : series.points) {
        if (!f.shows(p)) {
            open = false;
            continue;
        }
        const PlanePoint q = f.at(p);
        if (open)
            path.line_to(q);
        else
            path.move_to(q);
        open = true;
        shown.push_back(p);
    }
    picture.path(path, paint, series.name);
    if (shown.size() > kDots) return;
    for (const PlanePoint& p : shown)
        picture.dot(
            f.at(p), 2.6, filled(*paint.stroke),
            (series.name.empty() ? "" : series.name + ": ") + tick_label(p[0]) + ", " + tick_label(p[1]));
}

void draw_legend(SvgPicture& picture, const std::vector<PlotSeries>& series, double top) {
    constexpr auto kColumns = static_cast<std::size_t>((kWidth - kLeft) / kLegendColumn);
    TextStyle style;
    style.size = kText;
    picture.begin_group("legend");
    for (std::size_t k = 0; k < series.size(); ++k) {
        const double x = kLeft + kLegendColumn * static_cast<double>(k % kColumns),
                     y = top - kLegendRow * static_cast<double>(k / kColumns + 1);
        picture.line({x, y + 4.0}, {x + 26.0, y + 4.0}, series_paint(k));
        std::string name = series[k].name;
        constexpr std::size_t kLongest = 34;
        if (name.size() > kLongest) name = "..." + name.substr(name.size() - kLongest + 3);
        picture.text({x + 32.0, y}, name, style);
    }
    picture.end_group();
}

}  // namespace

Axis axis_around(const std::vector<double>& values, ScaleKind kind) {
    double low = INFINITY, high = -INFINITY;
    for (const double v : values) {
        if (!(std::abs(v) <= kLargest) || (kind == ScaleKind::logarithmic && v <= 0.0)) continue;
        low = std::min(low, v);
        high = std::max(high, v);
    }
    if (!(low <= high)) return kind == ScaleKind::logarithmic ? Axis(0.1, 1.0, kind) : Axis(0.0, 1.0);
    if (kind == ScaleKind::logarithmic) {
        const double margin = std::max(1.25, std::pow(high / low, 0.04));
        return {std::max(low / margin, 1e-300), std::min(high * margin, 1e300), kind};
    }
    const double margin = 0.04 * std::max(high - low, 1e-9 * std::max({1.0, std::abs(low), std::abs(high)}));
    return {low - margin, high + margin};
}

SvgPicture draw_line_plot(const std::vector<PlotSeries>& series, const Axis& x, const Axis& y,
                          const PlotLabels& labels, std::optional<double> reference) {
    constexpr auto kColumns = static_cast<std::size_t>((kWidth - kLeft) / kLegendColumn);
    const std::size_t rows = series.size() > 1 ? (series.size() + kColumns - 1) / kColumns : 0;
    const double legend = rows > 0 ? kLegendRow * static_cast<double>(rows) + 8.0 : 0.0;
    const Frame frame{x, y, kBelow + legend};
    const double height = frame.top() + kTop;
    SvgPicture picture(kWidth, height, {0.0, 0.0, kWidth, height});
    picture.set_title(labels.title);
    draw_axes(picture, frame, series, labels);
    if (reference && frame.shows({x.low(), *reference})) {
        Paint paint = stroked(kGrey, 1.0);
        paint.dashes = {5.0, 4.0};
        picture.line(frame.at({x.low(), *reference}), frame.at({x.high(), *reference}), paint,
                     tick_label(*reference));
    }
    picture.begin_group("series");
    for (std::size_t k = 0; k < series.size(); ++k) draw_series(picture, frame, series[k], k);
    picture.end_group();
    if (rows > 0) draw_legend(picture, series, kBelow - 44.0 + legend);
    TextStyle style;
    style.size = 14.0;
    style.bold = true;
    picture.text({kLeft, height - 22.0}, labels.title, style);
    return picture;
}

}  // namespace ricci
