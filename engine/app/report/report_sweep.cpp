// What a page says about a sweep: area distortion at every vertex, the best and the worst singularity and
// their layouts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/app/pictures/layout_pictures.h"
#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/report/item_report.h"
#include "engine/app/report/stored_solution.h"
#include "io/picture/histogram.h"

namespace ricci::app {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr Index kMostLaidOut = 60000;  // faces of a surface whose metrics are laid out for the page

bool converged(const SweepRow& row) {
    return row.status == static_cast<std::uint8_t>(Status::converged);
}

/// A column of the rows at their vertices.
template <class Value>
SceneField column(const std::string& name, const std::string& unit, const StoredSweep& sweep,
                  std::size_t vertices, NumberKind kind, Value value) {
    SceneField field{name, unit, std::vector<double>(vertices, kNone), std::nullopt, kind, {}};
    for (const SweepRow& row : sweep.rows)
        field.values[static_cast<std::size_t>(row.vertex)] = static_cast<double>(value(row));
    return field;
}

void add_fields(const StoredItem& item, std::size_t vertices, const ReportContext& context, ItemReport& out) {
    const StoredSweep& sweep = *item.sweep;
    const auto add = [&](SceneField field, bool coloured) {
        if (coloured) field.colours = fitting_scale(field.values);
        out.scene.fields.push_back(std::move(field));
    };
    add(column("area distortion", "mean squared log ratio", sweep, vertices, NumberKind::doubles,
               [](const SweepRow& r) { return r.area_distortion; }),
        true);
    SceneField status = column("status", "", sweep, vertices, NumberKind::integers,
                               [](const SweepRow& r) { return r.status; });
    status.words = context.run->info.status.names;
    out.scene.fields.push_back(std::move(status));
    add(column("Newton iterations", "", sweep, vertices, NumberKind::integers,
               [](const SweepRow& r) { return r.newton_iterations; }),
        true);
    add(column("residual", "rad", sweep, vertices, NumberKind::floats,
               [](const SweepRow& r) { return r.residual_max; }),
        true);
    add(column("Gauss-Bonnet error", "rad", sweep, vertices, NumberKind::floats,
               [](const SweepRow& r) { return r.gauss_bonnet_error; }),
        false);
    add(column("flips", "", sweep, vertices, NumberKind::integers, [](const SweepRow& r) { return r.flips; }),
        true);
    add(column("seconds", "s", sweep, vertices, NumberKind::floats,
               [](const SweepRow& r) { return r.seconds; }),
        true);
    add(column("digits", "", sweep, vertices, NumberKind::integers,
               [](const SweepRow& r) { return r.precision_digits; }),
        false);
}

void check_rows(const StoredItem& item, ReportContext& context) {
    const std::vector<SweepRow>& rows = item.sweep->rows;
    double residual = 0.0, gauss_bonnet = kNone;
    std::int64_t failed = 0, extended = 0;
    for (const SweepRow& row : rows) {
        if (!converged(row)) {
            ++failed;
            continue;
        }
        // What is no number fails the check.
        residual = std::max(residual, std::isnan(row.residual_max) ? INFINITY : row.residual_max);
        gauss_bonnet = std::fmax(gauss_bonnet, row.gauss_bonnet_error);
        extended += row.precision_digits > 16 ? 1 : 0;
    }
    const std::string& name = item.item.name;
    Invariant all = none_of(name, "sweep", "rows that did not converge", failed, Verdict::fails);
    all.note = fmt::format("of {}", rows.size());
    context.page->check(all);
    if (failed < static_cast<std::int64_t>(rows.size()))
        check_metric(context, name, "sweep, largest of all rows", residual, gauss_bonnet,
                     40.0 * std::abs(item.item.euler_characteristic) + item.item.vertices);
    if (extended > 0)
        context.page->check({name, "sweep", "rows solved in more than 16 digits", fmt::format("{}", extended),
                             "", Verdict::told, "double was too coarse there"});
}

void add_histogram(const StoredSweep& sweep, ItemReport& out, ReportPage& page) {
    std::vector<double> values;
    for (const SweepRow& row : sweep.rows)
        if (converged(row) && std::isfinite(row.area_distortion)) values.push_back(row.area_distortion);
    if (values.empty()) return;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const bool logarithmic = *low > 0.0 && *high > 10.0 * *low;
    const Axis axis(*low, *high, logarithmic ? ScaleKind::logarithmic : ScaleKind::linear);
    const SvgPicture picture = draw_histogram(
        count_values(values, axis, 60), std::nullopt,
        {"Area distortion over the cones tried", "area distortion (mean squared log ratio)", "vertices", ""});
    out.figures.push_back(
        {page.make_figure("", picture, "How many vertices are how good as the only cone.")});
}

/// Adds the checkerboard of one metric, in the plane and on the surface.
void lay_out(const std::string& name, const StoredItem& item, const KeptFactor& kept, const SurfaceMesh& mesh,
             ReportContext& context, ItemReport& out, std::vector<PageFigure>& figures) {
    StructureOptions options;
    options.flow.delaunay = context.settings.delaunay;
    const SurfaceStructure s =
        make_surface_structure(mesh, cone_result_of(mesh, kept, context.settings), options);
    const StoredLayout stored = stored_layout_of(mesh, s);
    const std::string what = fmt::format("layout of {}", name);
    const std::string& item_name = item.item.name;
    context.page->check(none_of(item_name, what, "flipped pieces", s.layout.flipped, Verdict::fails));
    context.page->check(bounded(item_name, what, "closing error", s.layout.closing_error, 1e-8, 1e-5));
    DomainPicture picture;
    picture.checker = checker_cell(stored);
    picture.labels = false;
    picture.pixels = 560.0;
    figures.push_back(context.page->make_figure(
        fmt::format("{} (vertex {})", name, kept.vertex), draw_domain(stored, picture),
        fmt::format("The flat metric with its only cone at vertex {}, cut open and laid out. The view shows "
                    "the same squares "
                    "on the surface: how much their sizes vary there is the area distortion, {:.6g}.",
                    kept.vertex, kept.area_distortion)));
    if (std::optional<SceneTexture> texture =
            layout_texture(fmt::format("checkerboard of {} (vertex {})", name, kept.vertex), stored);
        texture && context.has_room(26 * texture->triangles.size()))
        out.scene.textures.push_back(std::move(*texture));
}

void add_layouts(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out) {
    const StoredSweep& sweep = *item.sweep;
    if (!sweep.best && !sweep.worst) {
        out.notes.emplace_back("No conformal factors are stored (--keep none): there is no layout to show.");
        return;
    }
    if (context.settings.scheme != Scheme::vertex_scaling || context.settings.densify) {
        out.notes.emplace_back("Layouts of a sweep are shown for vertex scaling without --densify only.");
        return;
    }
    if (context.layouts_left == 0 || item.item.faces > kMostLaidOut) {
        out.notes.emplace_back(
            fmt::format("The best and worst metrics are laid out for the first {} items of at most {} faces "
                        "only (--layouts).",
                        context.options.layouts, kMostLaidOut));
        return;
    }
    --context.layouts_left;
    std::vector<PageFigure> figures;
    for (const KeptFactor& kept : sweep.kept) {
        const bool best = kept.vertex == sweep.best, worst = kept.vertex == sweep.worst;
        if (!best && !worst) continue;
        const std::string name = best ? "best" : "worst";
        try {
            lay_out(name, item, kept, mesh, context, out, figures);
        } catch (const std::exception& error) {
            context.page->check({item.item.name, "layout of " + name, "made for this page", "no", "",
                                 Verdict::look, error.what()});
        }
    }
    out.figures.push_back(std::move(figures));
}

}  // namespace

SweepExtremes extremes_of(const StoredSweep& sweep) {
    SweepExtremes e;
    for (const SweepRow& row : sweep.rows) {
        if (!converged(row) || !std::isfinite(row.area_distortion)) continue;
        if (e.best == nullptr || row.area_distortion < e.best->area_distortion) e.best = &row;
        if (e.worst == nullptr || row.area_distortion > e.worst->area_distortion) e.worst = &row;
    }
    return e;
}

void add_sweep(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out) {
    const StoredSweep& sweep = *item.sweep;
    const auto vertices = static_cast<std::size_t>(mesh.connectivity.vertex_count);
    check_rows(item, context);
    if (!context.draw) return;
    add_fields(item, vertices, context, out);
    const SweepExtremes extremes = extremes_of(sweep);
    for (const auto& [name, row] : {std::pair("best", extremes.best), std::pair("worst", extremes.worst)})
        if (row != nullptr && !mesh.intrinsic())
            out.scene.marks.push_back(
                {name, row->vertex, mesh.points[static_cast<std::size_t>(row->vertex)]});
    for (const KeptFactor& kept : sweep.kept) {
        const bool best = kept.vertex == sweep.best, worst = kept.vertex == sweep.worst;
        if (!best && !worst) continue;
        SceneField factor{fmt::format("u of {}, log of the scale factor", best ? "best" : "worst"),
                          "",
                          kept.conformal_factor,
                          std::nullopt,
                          NumberKind::floats,
                          {}};
        factor.colours = fitting_scale(factor.values, median_of(factor.values));
        out.scene.fields.push_back(std::move(factor));
    }
    add_histogram(sweep, out, *context.page);
    add_layouts(item, mesh, context, out);
}

}  // namespace ricci::app
