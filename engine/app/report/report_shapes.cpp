// What a page says about length spectra and Teichmueller coordinates of surfaces.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/app/pictures/side_style.h"
#include "engine/app/report/item_report.h"
#include "engine/app/result_values.h"
#include "io/picture/line_plot.h"

namespace ricci::app {
namespace {

constexpr std::size_t kMostSeries = 14, kMostCurves = 40, kMostLengths = 400;

bool sound(const ResultGroup* group) {
    return group != nullptr && group->status == static_cast<std::uint8_t>(Status::converged);
}

void check_accuracy(const std::string& item, const ResultGroup& group, ReportContext& context) {
    const auto number = [&](const char* name) { return attribute_of<double>(group, name).value_or(NAN); };
    check_metric(context, item, group.kind, number("residual_max"), number("gauss_bonnet_error"), 1e4);
}

void add_curves(const std::vector<std::vector<Point>>& lines, const std::vector<std::string>& names,
                ItemReport& out) {
    const std::size_t shown = std::min({lines.size(), names.size(), kMostCurves});
    for (std::size_t k = 0; k < shown; ++k) {
        const Paint paint = pair_paint(k, 2.5);
        out.scene.curves.push_back(
            {names[k], "", paint.stroke.value_or(kBlack), !paint.dashes.empty(), lines[k]});
    }
    if (shown < lines.size())
        out.notes.push_back(fmt::format("The first {} of {} curves are drawn.", shown, lines.size()));
}

PageTable spectrum_table(const ResultGroup& spectrum) {
    PageTable table{"Closed geodesics",
                    {"length", "times", "power", "word", "boundary"},
                    {},
                    {true, true, true, false, false}};
    const auto length = values_of<double>(spectrum, "length");
    const auto power = values_of<Index>(spectrum, "power"), geodesic = values_of<Index>(spectrum, "geodesic"),
               boundary = values_of<Index>(spectrum, "geodesics/boundary");
    const auto words = values_of<std::string>(spectrum, "geodesics/word");
    for (std::size_t k = 0; k < std::min(length.size(), kMostLengths); ++k) {
        std::size_t times = 0;
        for (const double l : length) times += std::abs(l - length[k]) <= 1e-9 * std::max(1.0, l) ? 1 : 0;
        const auto g = k < geodesic.size() ? static_cast<std::size_t>(geodesic[k]) : words.size();
        const bool edge = g < boundary.size() && boundary[g] >= 0;
        table.rows.push_back({fmt::format("{:.10g}", length[k]), fmt::format("{}", times),
                              k < power.size() ? fmt::format("{}", power[k]) : "",
                              g < words.size() ? ReportPage::text(words[g]) : "",
                              edge ? fmt::format("{}", boundary[g]) : ""});
    }
    if (length.size() > kMostLengths)
        table.caption += fmt::format(" (the first {} of {})", kMostLengths, length.size());
    return table;
}

std::vector<PlanePoint> numbered(const std::vector<double>& values) {
    std::vector<PlanePoint> points;
    for (std::size_t k = 0; k < values.size(); ++k) points.push_back({static_cast<double>(k + 1), values[k]});
    return points;
}

/// Lines over 1, 2, 3, ...
SvgPicture draw_numbered(const std::vector<PlotSeries>& series, const PlotLabels& labels) {
    std::vector<double> x, y{0.0};
    for (const PlotSeries& s : series)
        for (const PlanePoint& p : s.points) {
            x.push_back(p[0]);
            y.push_back(p[1]);
        }
    return draw_line_plot(series, axis_around(x, ScaleKind::linear), axis_around(y, ScaleKind::linear),
                          labels);
}

/// Series of all items whose results have the same key, in sections of a few.
void plot_together(ReportPage& page, const std::string& what,
                   const std::map<std::string, std::vector<PlotSeries>>& by_type, const PlotLabels& labels,
                   const std::string& caption) {
    bool any = false;
    for (const auto& [type, series] : by_type) {
        if (series.size() < 2) continue;
        if (!any) {
            page.begin_section(what);
            page.begin_grid();
        }
        any = true;
        std::vector<PlotSeries> shown(series.begin(), series.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                           series.size(), kMostSeries)));
        PlotLabels named = labels;
        named.title += ", " + type;
        std::string words = caption;
        if (shown.size() < series.size())
            words += fmt::format(" The first {} of {} are shown.", shown.size(), series.size());
        page.figure(draw_numbered(shown, named), words);
    }
    if (!any) return;
    page.end_grid();
    page.end_section();
}

}  // namespace

void add_spectrum(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out) {
    const ResultGroup* spectrum = result_of(item, "spectrum");
    if (!sound(spectrum)) return;
    check_accuracy(item.item.name, *spectrum, context);
    const auto number = [&](const char* name) { return attribute_of<double>(*spectrum, name).value_or(NAN); };
    context.page->check(
        bounded(item.item.name, "spectrum", "relator error", number("relator_error"), 1e-9, 1e-6));
    context.page->check(
        bounded(item.item.name, "spectrum", "lengths against their words", number("word_error"), 1e-9, 1e-6));
    const auto length = values_of<double>(*spectrum, "length");
    if (!length.empty()) {
        const double complete = number("complete_up_to");
        const bool whole = complete >= length.back() * (1 - 1e-12);
        context.page->check({item.item.name, "spectrum", "complete up to", number_text(complete),
                             "at least " + fmt::format("{:.6g}", length.back()),
                             whole ? Verdict::holds : Verdict::look,
                             "every closed geodesic up to this length is listed"});
        out.figures.push_back({context.page->make_figure(
            "",
            draw_numbered({{item.item.name, numbered(length)}},
                          {"Length spectrum", "number of the closed geodesic", "length"}),
            "Closed geodesics by length, with their powers and as often as they occur.")});
    }
    if (!context.draw) return;
    out.folded.push_back(spectrum_table(*spectrum));
    if (mesh.intrinsic()) return;
    std::vector<std::string> names;
    for (const double l : values_of<double>(*spectrum, "geodesics/length"))
        names.push_back(fmt::format("g{} ({:.4g})", names.size(), l));
    add_curves(polylines_of(*spectrum, "geodesics/points"), names, out);
}

void add_coordinates(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context,
                     ItemReport& out) {
    const ResultGroup* group = result_of(item, "teichmuller");
    if (!sound(group)) return;
    check_accuracy(item.item.name, *group, context);
    const std::string marking = attribute_of<std::string>(*group, "marking").value_or("none");
    const double gap = attribute_of<double>(*group, "smallest_gap").value_or(NAN);
    if (std::isfinite(gap) && marking == "geometric")
        context.page->check({item.item.name, "teichmuller", "smallest gap of the marking", number_text(gap),
                             "0.001", gap >= 1e-3 ? Verdict::holds : Verdict::look,
                             "small: nearly another marking, and so other coordinates"});
    if (!context.draw) return;
    PageTable table{"Teichmueller coordinates", {"name", "value"}, {}, {false, true}};
    const auto names = values_of<std::string>(*group, "names");
    const auto values = values_of<double>(*group, "coordinates");
    for (std::size_t k = 0; k < std::min(names.size(), values.size()); ++k)
        table.rows.push_back({ReportPage::text(names[k]), fmt::format("{:.12g}", values[k])});
    if (!table.rows.empty()) out.tables.push_back(std::move(table));
    const auto pants = values_of<std::string>(*group, "fenchel_nielsen/name");
    const auto length = values_of<double>(*group, "fenchel_nielsen/length"),
               twist = values_of<double>(*group, "fenchel_nielsen/twist");
    PageTable fenchel{"Fenchel-Nielsen coordinates", {"curve", "length", "twist"}, {}, {false, true, true}};
    for (std::size_t k = 0; k < std::min({pants.size(), length.size(), twist.size()}); ++k)
        fenchel.rows.push_back({ReportPage::text(pants[k]), number_text(length[k]), number_text(twist[k])});
    if (!fenchel.rows.empty()) out.folded.push_back(std::move(fenchel));
    if (mesh.intrinsic()) return;
    for (const char* const path : {"curves", "loops"}) {
        const std::vector<std::vector<Point>> lines = polylines_of(*group, std::string(path) + "/points");
        add_curves(lines, values_of<std::string>(*group, std::string(path) + "/name"), out);
    }
}

void add_comparisons(ReportContext& context) {
    std::map<std::string, std::vector<PlotSeries>> spectra, coordinates;
    for (const StoredItem& item : context.run->items) {
        const std::string type =
            fmt::format("genus {}, {} boundaries", item.item.genus, item.item.boundaries);
        if (const ResultGroup* spectrum = result_of(item, "spectrum"); sound(spectrum))
            spectra[type].push_back({item.item.name, numbered(values_of<double>(*spectrum, "length"))});
        if (const ResultGroup* group = result_of(item, "teichmuller"); sound(group)) {
            const auto values = values_of<double>(*group, "coordinates");
            if (!values.empty())
                coordinates[fmt::format("{}, {} coordinates", type, values.size())].push_back(
                    {item.item.name, numbered(values)});
        }
    }
    plot_together(*context.page, "Spectra compared", spectra,
                  {"Length spectra", "number of the closed geodesic", "length"},
                  "The shape of a surface as the sequence of its closed geodesics' lengths.");
    plot_together(*context.page, "Coordinates compared", coordinates,
                  {"Teichmueller coordinates", "coordinate", "value"},
                  "Each line is a point of Teichmueller space.");
}

}  // namespace ricci::app
