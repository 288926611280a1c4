// What the parts of a run's page are made from: one function for each kind of result adds what it has to say
// about an item.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/app/report/page.h"
#include "engine/app/stored_settings.h"
#include "io/store/run_store.h"

namespace ricci::app {

struct ReportOptions {
    Index view_faces = 20000;            // of one view; beyond, surfaces are decimated for viewing
    Index all_faces = 240000;            // of all views together
    std::size_t layouts = 12;            // items of a sweep whose best and worst metric are laid out
    std::size_t neighbours = 5;          // beside each shape
    std::size_t page_bytes = 9'000'000;  // beyond, textures and large pictures are left out
};

struct ReportContext {
    ReportPage* page = nullptr;
    const StoredRun* run = nullptr;
    StoredSettings settings;
    ReportOptions options;
    Index view_faces = 0;          // share of each item
    std::size_t layouts_left = 0;  // of a sweep's metrics that may still be laid out
    bool draw = true;              // false: checks only, for items that the page has no room for

    [[nodiscard]] bool has_room(std::size_t bytes) const {
        return page->size() + bytes < options.page_bytes * 3 / 4;
    }
    [[nodiscard]] const std::string& status_name(std::uint8_t status) const;
};

struct ItemReport {
    Scene scene;
    std::vector<std::vector<PageFigure>> figures;  // each list takes turns
    std::vector<PageTable> tables, folded;         // folded: behind their captions
    std::vector<std::string> notes;
};

/// The rows with the least and the most area distortion among those that converged, ties to the lowest
/// vertex; null where none did.
struct SweepExtremes {
    const SweepRow *best = nullptr, *worst = nullptr;
};
SweepExtremes extremes_of(const StoredSweep& sweep);

void add_sweep(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out);
void add_flow(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out);
void add_structure(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out);
void add_spectrum(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out);
void add_coordinates(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context,
                     ItemReport& out);

/// Plots of all items together: spectra (thesis Figures 40, 41) and coordinates.
void add_comparisons(ReportContext& context);

/// Residual, Gauss-Bonnet error and digits of a metric.
void check_metric(ReportContext& context, const std::string& item, const std::string& result, double residual,
                  double gauss_bonnet, double curvature_sum);

/// Pages of the kinds of files.
void report_run(const StoredRun& run, const ReportOptions& options, ReportPage& page);
void report_index(const std::string& path, const ReportOptions& options, ReportPage& page);
void report_distances(const std::string& path, const ReportOptions& options, ReportPage& page);
void report_paths(const std::string& path, const ReportOptions& options, ReportPage& page);

}  // namespace ricci::app
