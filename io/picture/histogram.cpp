#include "io/picture/histogram.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace ricci {
namespace {

constexpr double kWidth = 480.0, kHeight = 320.0;                             // pixels, also user units
constexpr double kLeft = 68.0, kRight = 462.0, kBottom = 50.0, kTop = 246.0;  // of the plot
constexpr Colour kBars{0x8f, 0xb3, 0xd9}, kOutline{0xb3, 0x4d, 0x00};

// Where values and counts lie in the picture.
struct Plot {
    Axis values, counts;

    [[nodiscard]] double x_of(double value) const {
        return std::lerp(kLeft, kRight, std::clamp(values.fraction_of(value), 0.0, 1.0));
    }
    [[nodiscard]] double x_of_edge(std::size_t edge, std::size_t bins) const {
        return std::lerp(kLeft, kRight, static_cast<double>(edge) / static_cast<double>(bins));
    }
    [[nodiscard]] double y_of(double count) const {
        return std::lerp(kBottom, kTop, std::clamp(counts.fraction_of(count), 0.0, 1.0));
    }
};

// From zero, or below one on a logarithmic scale, to a little above the largest count.
Axis count_axis(const Histogram& first, const std::optional<Histogram>& second, ScaleKind kind) {
    std::int64_t largest = 1;
    for (const std::int64_t count : first.counts) largest = std::max(largest, count);
    if (second)
        for (const std::int64_t count : second->counts) largest = std::max(largest, count);
    const auto top = static_cast<double>(largest);
    return kind == ScaleKind::linear ? Axis(0.0, 1.05 * top) : Axis(0.5, 1.5 * top, kind);
}

void draw_bars(SvgPicture& picture, const Plot& plot, const Histogram& histogram) {
    SvgPath bars;
    const std::size_t bins = histogram.counts.size();
    for (std::size_t i = 0; i < bins; ++i) {
        if (histogram.counts[i] == 0) continue;
        const double left = plot.x_of_edge(i, bins), right = plot.x_of_edge(i + 1, bins);
        const double y = plot.y_of(static_cast<double>(histogram.counts[i]));
        bars.polygon(std::array<PlanePoint, 4>{{{left, kBottom}, {right, kBottom}, {right, y}, {left, y}}});
    }
    Paint paint = filled(kBars);
    paint.stroke = kBars;
    paint.stroke_width = 0.4;
    picture.path(bars, paint);
}

void draw_outline(SvgPicture& picture, const Plot& plot, const Histogram& histogram) {
    std::vector<PlanePoint> line = {{kLeft, kBottom}};
    const std::size_t bins = histogram.counts.size();
    for (std::size_t i = 0; i < bins; ++i) {
        const double y = plot.y_of(static_cast<double>(histogram.counts[i]));
        line.push_back({plot.x_of_edge(i, bins), y});
        line.push_back({plot.x_of_edge(i + 1, bins), y});
    }
    line.push_back({kRight, kBottom});
    picture.polyline(line, stroked(kOutline, 1.5));
}

void draw_axes(SvgPicture& picture, const Plot& plot, const std::string& axis_label) {
    const Paint thin = stroked(kBlack, 0.75);
    picture.polyline(std::array<PlanePoint, 3>{{{kLeft, kTop}, {kLeft, kBottom}, {kRight, kBottom}}}, thin);
    TextStyle style;
    style.size = 11.0;
    style.anchor = TextAnchor::middle;
    for (const double tick : plot.values.ticks(7)) {
        const double x = plot.x_of(tick);
        picture.line({x, kBottom}, {x, kBottom - 4.0}, thin);
        picture.text({x, kBottom - 16.0}, tick_label(tick), style);
    }
    style.size = 12.0;
    picture.text({0.5 * (kLeft + kRight), 12.0}, axis_label, style);
    style.size = 11.0;
    style.anchor = TextAnchor::end;
    for (const double tick : plot.counts.ticks(5)) {
        if (tick < 1.0 && tick != 0.0) continue;  // there are no half values
        const double y = plot.y_of(tick);
        picture.line({kLeft - 4.0, y}, {kLeft, y}, thin);
        picture.text({kLeft - 7.0, y - 4.0}, tick_label(tick), style);
    }
}

void draw_reference(SvgPicture& picture, const Plot& plot, double reference) {
    const double fraction = plot.values.fraction_of(reference);
    if (!(fraction >= 0.0 && fraction <= 1.0)) return;
    Paint paint = stroked(kBlack, 0.75);
    paint.dashes = {4.0, 3.0};
    picture.line({plot.x_of(reference), kBottom}, {plot.x_of(reference), kTop}, paint);
}

std::string description(const std::string& name, const Histogram& histogram) {
    std::string text = fmt::format("{}{}{} values", name, name.empty() ? "" : ": ", histogram.total());
    if (histogram.below > 0) text += fmt::format(", {} below", histogram.below);
    if (histogram.above > 0) text += fmt::format(", {} above", histogram.above);
    if (histogram.not_a_number > 0) text += fmt::format(", {} not a number", histogram.not_a_number);
    return text;
}

void draw_legend(SvgPicture& picture, double y, const Paint& paint, const std::string& words) {
    picture.polygon(
        std::array<PlanePoint, 4>{{{kLeft, y}, {kLeft + 12.0, y}, {kLeft + 12.0, y + 8.0}, {kLeft, y + 8.0}}},
        paint);
    TextStyle style;
    style.size = 11.0;
    picture.text({kLeft + 18.0, y}, words, style);
}

}  // namespace

std::int64_t Histogram::total() const {
    return std::accumulate(counts.begin(), counts.end(), below + above + not_a_number);
}

Histogram count_values(std::span<const double> values, const Axis& axis, std::size_t bins) {
    if (bins == 0) throw std::invalid_argument("a histogram has bins");
    Histogram histogram{axis, std::vector<std::int64_t>(bins, 0)};
    for (const double value : values) {
        if (std::isnan(value)) {
            ++histogram.not_a_number;
        } else if (value < axis.low()) {
            ++histogram.below;
        } else if (value > axis.high()) {
            ++histogram.above;
        } else {
            const double bin = axis.fraction_of(value) * static_cast<double>(bins);
            ++histogram.counts[std::min(static_cast<std::size_t>(std::max(0.0, bin)), bins - 1)];
        }
    }
    return histogram;
}

SvgPicture draw_histogram(const Histogram& first, const std::optional<Histogram>& second,
                          const HistogramLabels& labels, ScaleKind counts, std::optional<double> reference) {
    if (first.counts.empty()) throw std::invalid_argument("a histogram has bins");
    if (second && (second->axis != first.axis || second->counts.size() != first.counts.size()))
        throw std::invalid_argument("two histograms in one picture have the same bins");
    SvgPicture picture(kWidth, kHeight, {0.0, 0.0, kWidth, kHeight});
    picture.set_title(labels.title);
    const Plot plot{first.axis, count_axis(first, second, counts)};
    draw_bars(picture, plot, first);
    if (second) draw_outline(picture, plot, *second);
    if (reference) draw_reference(picture, plot, *reference);
    draw_axes(picture, plot, labels.axis);
    TextStyle style;
    style.size = 14.0;
    style.bold = true;
    picture.text({kLeft, kHeight - 20.0}, labels.title, style);
    draw_legend(picture, kHeight - 40.0, filled(kBars), description(labels.first, first));
    if (second)
        draw_legend(picture, kHeight - 56.0, stroked(kOutline, 1.5), description(labels.second, *second));
    return picture;
}

}  // namespace ricci
