// A page about the results of flows, sweeps, layouts, spectra and coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/app/records.h"
#include "engine/app/report/item_report.h"
#include "engine/app/result_values.h"

namespace ricci::app {
namespace {

/// Items of one surface, which are its resolutions.
struct SourceGroup {
    std::string source;
    std::vector<const StoredItem*> items;
};

/// "two.c0" of "two.c0@400": what the resolutions of one surface have in common.
std::string surface_name(const std::string& item) {
    return item.substr(0, item.rfind('@'));
}

std::vector<SourceGroup> grouped(const StoredRun& run) {
    std::vector<SourceGroup> groups;
    for (const StoredItem& item : run.items) {
        const std::string surface = surface_name(item.item.name);
        if (groups.empty() || groups.back().source != item.item.source ||
            surface_name(groups.back().items.front()->item.name) != surface)
            groups.push_back({item.item.source, {}});
        groups.back().items.push_back(&item);
    }
    return groups;
}

std::string facts_of(const ItemRecord& item) {
    const std::string boundary = item.boundaries == 0   ? "closed"
                                 : item.boundaries == 1 ? "1 boundary"
                                                        : fmt::format("{} boundaries", item.boundaries);
    return fmt::format("{} vertices, {} faces, genus {}, {}{}", item.vertices, item.faces, item.genus,
                       boundary, item.points.empty() ? ", intrinsic" : "");
}

void count_note(const ItemReport& out, std::vector<std::string>& notes) {
    if (out.scene.mesh.decimated)
        notes.push_back(
            fmt::format("Decimated for viewing only: {} of {} faces are shown; a vertex shows the numbers "
                        "of the nearest vertex of the surface itself.",
                        out.scene.mesh.triangles.size(), out.scene.mesh.faces));
}

/// The surface for viewing. Vertices that were swept stay at hand where they are few, the best and worst
/// always.
ViewMesh make_view(const StoredItem& item, const SurfaceMesh& mesh, Index faces) {
    ViewMesh view = make_view_mesh(mesh, faces);
    if (!item.sweep) return view;
    constexpr std::size_t kFewRows = 3000;
    std::vector<Index> vertices;
    if (item.sweep->rows.size() <= kFewRows) {
        for (const SweepRow& row : item.sweep->rows) vertices.push_back(row.vertex);
    } else {
        const SweepExtremes extremes = extremes_of(*item.sweep);
        for (const SweepRow* row : {extremes.best, extremes.worst})
            if (row != nullptr) vertices.push_back(row->vertex);
    }
    add_vertices(view, mesh, vertices);
    return view;
}

void write_item(const StoredItem& item, bool alone, ReportContext& context) {
    ReportPage& page = *context.page;
    ItemReport out;
    const SurfaceMesh mesh = surface_of(item.item);
    out.scene.title = item.item.name;
    const bool embedded = !mesh.intrinsic();
    const auto add = [&](const char* what, auto function) {
        try {
            function(item, mesh, context, out);
        } catch (const std::exception& error) {  // an odd item does not take the page with it
            page.check({item.item.name, what, "shown on this page", "no", "", Verdict::fails, error.what()});
        }
    };
    if (embedded && context.draw) out.scene.mesh = make_view(item, mesh, context.view_faces);
    if (item.sweep) add("sweep", add_sweep);
    if (item.flow) add("flow", add_flow);
    add("layout", add_structure);
    add("spectrum", add_spectrum);
    add("teichmuller", add_coordinates);
    if (!context.draw) return;
    page.begin_part(alone ? "" : item.item.name, facts_of(item.item));
    std::vector<std::string> notes = out.notes;
    count_note(out, notes);
    if (!embedded) notes.emplace_back("An intrinsic surface has no points in space: there is no view of it.");
    page.begin_grid();
    if (embedded) page.view(out.scene);
    for (const std::vector<PageFigure>& figures : out.figures) page.figures(figures);
    page.end_grid();
    for (const std::string& words : notes) page.note(words);
    for (const PageTable& table : out.tables) page.table(table);
    for (PageTable table : out.folded) {
        page.begin_details(table.caption);
        table.caption.clear();
        page.table(table);
        page.end_details();
    }
    page.end_part();
}

/// The best singularities of a surface at its resolutions.
void compare_resolutions(const SourceGroup& group, ReportContext& context) {
    PageTable table{"Resolutions side by side",
                    {"item", "faces", "rows", "not converged", "best vertex", "nearest input vertex",
                     "best distortion", "worst vertex", "worst distortion"},
                    {},
                    {false, true, true, true, true, true, true, true, true}};
    for (const StoredItem* item : group.items) {
        if (!item->sweep) continue;
        const StoredSweep& sweep = *item->sweep;
        const auto converged = std::count_if(sweep.rows.begin(), sweep.rows.end(), [](const SweepRow& r) {
            return r.status == static_cast<std::uint8_t>(Status::converged);
        });
        const SweepExtremes extremes = extremes_of(sweep);
        const auto distortion = [](const SweepRow* row) {
            return number_text(row == nullptr ? NAN : row->area_distortion);
        };
        const auto vertex = [](const SweepRow* row) {
            return row == nullptr ? std::string("\u2013") : fmt::format("{}", row->vertex);
        };
        std::string source = vertex(extremes.best);
        if (extremes.best != nullptr && !item->item.source_vertex.empty())
            source =
                fmt::format("{}", item->item.source_vertex[static_cast<std::size_t>(extremes.best->vertex)]);
        table.rows.push_back({ReportPage::text(item->item.name), fmt::format("{}", item->item.faces),
                              fmt::format("{}", sweep.rows.size()),
                              fmt::format("{}", sweep.rows.size() - static_cast<std::size_t>(converged)),
                              vertex(extremes.best), source, distortion(extremes.best),
                              vertex(extremes.worst), distortion(extremes.worst)});
    }
    if (!table.rows.empty()) context.page->table(table);
}

}  // namespace

const std::string& ReportContext::status_name(std::uint8_t status) const {
    static const std::string unknown = "unknown";
    const std::vector<std::string>& names = run->info.status.names;
    return status < names.size() ? names[status] : unknown;
}

void check_metric(ReportContext& context, const std::string& item, const std::string& result, double residual,
                  double gauss_bonnet, double curvature_sum) {
    const double tolerance = context.settings.tolerance;
    context.page->check(bounded(item, result, "residual, max |K - target|", residual, tolerance,
                                std::max(1e-6, 100 * tolerance)));
    // Sums of curvatures carry a rounding per vertex.
    const double slack = 1e-9 + 1e-13 * curvature_sum;
    context.page->check(bounded(item, result, "Gauss-Bonnet error", gauss_bonnet, slack, 1e3 * slack));
}

void report_run(const StoredRun& run, const ReportOptions& options, ReportPage& page) {
    ReportContext context;
    context.page = &page;
    context.run = &run;
    context.settings = settings_of(run);
    context.options = options;
    context.layouts_left = options.layouts;
    const auto items = static_cast<Index>(std::max<std::size_t>(1, run.items.size()));
    context.view_faces = std::clamp(options.all_faces / items, Index{400}, options.view_faces);
    for (const FailureRecord& f : run.failures) page.failure(f.item, f.stage, f.status, f.message);
    if (!run.complete)
        page.check({"", "file", "complete", "no", "yes", Verdict::fails, "not a whole result file"});
    const std::vector<SourceGroup> groups = grouped(run);
    add_comparisons(context);
    std::size_t skipped = 0;
    for (const SourceGroup& group : groups) {
        context.draw = page.size() <= options.page_bytes;
        if (!context.draw) {
            skipped += group.items.size();
            for (const StoredItem* item : group.items) write_item(*item, false, context);
            continue;
        }
        const std::string name = group.items.front()->item.name;
        page.begin_section(group.items.size() == 1 ? name : name.substr(0, name.find('@')), group.source);
        if (group.items.size() > 1) compare_resolutions(group, context);
        for (const StoredItem* item : group.items) write_item(*item, group.items.size() == 1, context);
        page.end_section();
    }
    if (skipped == 0) return;
    page.begin_section("Not shown");
    page.note(
        fmt::format("{} further items are checked but not shown, to keep the page small. `ricci report "
                    "--item NAME` makes a page "
                    "of those named.",
                    skipped));
    page.end_section();
}

}  // namespace ricci::app
