// What a page says about one solve: how it converged (thesis Figures 52, 53), the metric on the surface, how
// nearly conformal the map is (Figure 54).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/report/item_report.h"
#include "engine/app/report/stored_solution.h"
#include "engine/app/result_values.h"
#include "engine/app/solve_options.h"
#include "io/picture/histogram.h"
#include "io/picture/line_plot.h"

namespace ricci::app {
namespace {

void add_fields(const FlowRecord& flow, ItemReport& out) {
    const auto add = [&](const std::string& name, const std::string& unit, const std::vector<double>& values,
                         std::optional<double> middle, double smallest = 1e-12) {
        SceneField field{name, unit, values, std::nullopt, NumberKind::floats, {}};
        field.colours = fitting_scale(values, middle, smallest);
        out.scene.fields.push_back(std::move(field));
    };
    add("u, log of the scale factor", "", flow.conformal_factor, median_of(flow.conformal_factor), 1e-9);
    add("curvature of the metric", "rad", flow.curvature, 0.0, 1e-3);
    add("target curvature", "rad", flow.target_curvature, 0.0, 1e-3);
    std::vector<double> error;
    for (std::size_t v = 0; v < flow.curvature.size(); ++v)
        error.push_back(std::abs(flow.curvature[v] - flow.target_curvature[v]));
    add("|K - target|", "rad", error, std::nullopt);
}

PageTable step_table(const FlowRecord& flow) {
    PageTable table{"Step by step",
                    {"iteration", "residual", "step", "flips", "seconds"},
                    {},
                    {true, true, true, true, true}};
    constexpr std::size_t kMostRows = 500;
    const std::size_t rows = flow.log_residual_max.size();
    for (std::size_t k = 0; k < rows; ++k) {
        if (rows > kMostRows && k >= kMostRows / 2 && k + kMostRows / 2 < rows) continue;
        table.rows.push_back({fmt::format("{}", k), number_text(flow.log_residual_max[k]),
                              k < flow.log_step.size() ? number_text(flow.log_step[k]) : "",
                              k < flow.log_flips.size() ? fmt::format("{}", flow.log_flips[k]) : "",
                              k < flow.log_seconds.size() ? fmt::format("{:.4f}", flow.log_seconds[k]) : ""});
    }
    if (rows > kMostRows)
        table.caption += fmt::format(" (the first and the last {} of {})", kMostRows / 2, rows);
    return table;
}

void add_convergence(const FlowRecord& flow, const ReportContext& context, ItemReport& out) {
    const std::size_t steps = flow.log_residual_max.size();
    if (steps == 0) return;
    PlotSeries by_step{flow.method, {}}, by_time{flow.method, {}};
    std::vector<double> residuals = flow.log_residual_max, count;
    residuals.push_back(context.settings.tolerance);
    for (std::size_t k = 0; k < steps; ++k) {
        count.push_back(static_cast<double>(k));
        by_step.points.push_back({static_cast<double>(k), flow.log_residual_max[k]});
        if (k < flow.log_seconds.size())
            by_time.points.push_back({flow.log_seconds[k], flow.log_residual_max[k]});
    }
    const Axis y = axis_around(residuals, ScaleKind::logarithmic);
    const std::string caption = fmt::format(
        "Largest curvature error over the steps of the flow ({}); dashed: the tolerance.", flow.method);
    ReportPage& page = *context.page;
    std::vector<PageFigure> figures = {page.make_figure(
        "by iteration",
        draw_line_plot({by_step}, axis_around(count, ScaleKind::linear), y,
                       {"Residual against iteration", "iteration", "max |K - target|, radians"},
                       context.settings.tolerance),
        caption)};
    if (!by_time.points.empty())
        figures.push_back(
            page.make_figure("by time",
                             draw_line_plot({by_time}, axis_around(flow.log_seconds, ScaleKind::linear), y,
                                            {"Residual against time", "seconds", "max |K - target|, radians"},
                                            context.settings.tolerance),
                             caption));
    out.figures.push_back(std::move(figures));
    out.folded.push_back(step_table(flow));
}

/// Ratios of angles from the stored quality, or measured on the map that the factor means.
void add_angles(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out) {
    PictureSource source;
    if (const ResultGroup* quality = result_of(item, "quality")) {
        take_stored_angles(*quality, source);
    } else if (!context.settings.densify) {
        // Packings keep their triangulation; what is read below relies on that.
        if (parse_scheme(item.flow->scheme) != Scheme::vertex_scaling &&
            (item.flow->triangles != item.item.triangles ||
             item.flow->edge_length.size() != 3 * item.item.triangles.size()))
            throw FileError("the final triangulation of a circle packing is not that of the mesh");
        const ConformalityReport report =
            quality_of(mesh, flow_result_of(*item.flow), context.settings.delaunay);
        take_quality(report, source);
        context.page->check(none_of(item.item.name, "map", "flipped pieces", report.flipped, Verdict::fails));
    }
    if (source.angle_ratio.empty()) return;
    const auto close = std::count_if(source.angle_ratio.begin(), source.angle_ratio.end(),
                                     [](double r) { return std::abs(r - 1.0) <= 0.05; });
    const std::string caption = fmt::format(
        "Angles of the map's image over angles of the surface, at the corners of the pieces on which the map "
        "is one "
        "formula: {:.2f} % are within 5 % of 1.",
        100.0 * static_cast<double>(close) / static_cast<double>(source.angle_ratio.size()));
    out.figures.push_back({context.page->make_figure(
        "", draw_picture(PictureKind::angles, LayoutModel::conformal, source), caption)});
}

}  // namespace

void add_flow(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out) {
    const FlowRecord& flow = *item.flow;
    const std::string& name = item.item.name;
    const std::string& status = context.status_name(flow.status);
    const bool converged = flow.status == static_cast<std::uint8_t>(Status::converged);
    context.page->check(
        {name, "flow", "status", status, "converged", converged ? Verdict::holds : Verdict::fails,
         fmt::format("{}, {}, {}, boundary {}", flow.geometry, flow.scheme, flow.method, flow.boundary)});
    double sum = static_cast<double>(flow.curvature.size());
    for (const double k : flow.curvature) sum += std::abs(k);
    if (converged) check_metric(context, name, "flow", flow.residual_max, flow.gauss_bonnet_error, sum);
    context.page->check(
        {name, "flow", "digits", fmt::format("{}", flow.precision_digits), "", Verdict::told, ""});
    const bool finite = std::all_of(flow.conformal_factor.begin(), flow.conformal_factor.end(),
                                    [](double u) { return std::isfinite(u); });
    if (!finite)
        context.page->check({name, "flow", "conformal factor", "not finite", "finite", Verdict::fails, ""});
    if (!context.draw) return;
    add_fields(flow, out);
    add_convergence(flow, context, out);
    if (!converged || !finite) return;
    try {
        add_angles(item, mesh, context, out);
    } catch (const std::exception& error) {
        context.page->check({name, "map", "measured for this page", "no", "", Verdict::look, error.what()});
    }
}

}  // namespace ricci::app
