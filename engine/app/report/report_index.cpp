// What pages say about shape space: distances as a heat map and a tree (thesis Table 6), neighbours with
// pictures (Tables 7, 8), spectra (Figures 40, 41) and deformation paths (Figure 35).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "engine/app/console.h"
#include "engine/app/index_config.h"
#include "engine/app/index_vectors.h"
#include "engine/app/pictures/distance_pictures.h"
#include "engine/app/pictures/draw_path.h"
#include "engine/app/report/item_report.h"
#include "engine/app/type_distances.h"
#include "io/mesh/mesh_file.h"
#include "io/picture/line_plot.h"
#include "io/store/distance_file.h"
#include "io/store/path_file.h"

namespace ricci::app {
namespace {

constexpr std::size_t kMostRows = 120, kMostSeries = 14, kMostPictures = 400;
constexpr Index kThumbnailFaces = 500;
constexpr std::uintmax_t kLargestPictured = 64U << 20U;  // bytes of a mesh file read for a thumbnail

/// Small pictures of shapes, from their files where these are still there.
class Thumbnails {
  public:
    explicit Thumbnails(ReportPage& page) : page_(&page) {}

    /// HTML of a picture of "FILE" or "FILE#c1"; empty where the file cannot be read.
    std::string of(const std::string& shape) {
        if (const auto found = made_.find(shape); found != made_.end()) return found->second;
        std::string html;
        if (made_.size() < kMostPictures) html = make(shape);
        if (html.empty()) ++missing_;
        return made_[shape] = html;
    }
    [[nodiscard]] std::size_t missing() const { return missing_; }

  private:
    [[nodiscard]] std::string make(const std::string& shape) const {
        std::string file = shape;
        std::size_t component = 0;
        std::error_code gone;
        if (const std::size_t mark = shape.rfind("#c");
            mark != std::string::npos && !std::filesystem::exists(shape, gone)) {
            file = shape.substr(0, mark);
            component = static_cast<std::size_t>(std::strtoul(shape.c_str() + mark + 2, nullptr, 10));
        }
        if (std::filesystem::file_size(file, gone) > kLargestPictured || gone) return "";
        try {
            const LoadedMesh loaded = load_mesh(file);
            if (component >= loaded.components.size() || loaded.components[component].intrinsic()) return "";
            return page_->thumbnail(make_view_mesh(loaded.components[component], kThumbnailFaces), shape);
        } catch (const std::exception&) {
            return "";  // what is not there any more, or has changed, has no picture
        }
    }

    ReportPage* page_;
    std::map<std::string, std::string> made_;
    std::size_t missing_ = 0;
};

PageTable neighbour_table(const TypeDistances& d, std::size_t neighbours, Thumbnails& thumbnails) {
    const std::vector<std::string> names = short_names(d.names);
    PageTable table{"Nearest shapes, from each to its neighbours", {"shape", "cluster"}, {}, {}};
    for (std::size_t k = 0; k < neighbours; ++k) table.head.push_back(fmt::format("nearest {}", k + 1));
    for (std::size_t r = 0; r < std::min(d.order.size(), kMostRows); ++r) {
        const std::size_t i = d.order[r];
        std::vector<std::size_t> others;
        for (std::size_t j = 0; j < names.size(); ++j)
            if (j != i) others.push_back(j);
        const std::size_t shown = std::min(others.size(), neighbours);
        std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(shown), others.end(),
                          [&](std::size_t x, std::size_t y) {
                              return std::pair(d.matrix(i, x), x) < std::pair(d.matrix(i, y), y);
                          });
        std::vector<std::string> row = {
            fmt::format("{}<br>{}", thumbnails.of(d.names[i]), ReportPage::text(names[i])),
            fmt::format("{}", d.clusters[i])};
        for (std::size_t k = 0; k < shown; ++k)
            row.push_back(fmt::format("{}<span class=\"distance\">{}</span><br>{}",
                                      thumbnails.of(d.names[others[k]]), number_text(d.matrix(i, others[k])),
                                      ReportPage::text(names[others[k]])));
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// What any table of distances keeps.
void check_distances(const TypeDistances& d, ReportPage& page) {
    double asymmetry = 0.0, diagonal = 0.0, scale = 0.0;
    std::int64_t none = 0;
    for (std::size_t i = 0; i < d.matrix.size; ++i) {
        diagonal = std::max(diagonal, std::abs(d.matrix(i, i)));
        for (std::size_t j = 0; j < i; ++j) {
            asymmetry = std::max(asymmetry, std::abs(d.matrix(i, j) - d.matrix(j, i)));
            scale = std::max(scale, std::abs(d.matrix(i, j)));
            none += std::isfinite(d.matrix(i, j)) && d.matrix(i, j) >= 0.0 ? 0 : 1;
        }
    }
    const std::string what = fmt::format("{} shapes of type {}", d.names.size(), d.type);
    page.check(bounded(what, "distances", "largest on the diagonal", diagonal, 1e-12 * scale, 1e-9 * scale));
    page.check(bounded(what, "distances", "largest difference of d(x, y) and d(y, x)", asymmetry,
                       1e-12 * scale, 1e-9 * scale));
    page.check(none_of(what, "distances", "negative or not finite", none, Verdict::fails));
}

void write_distances(const TypeDistances& d, const std::string& metric, const std::string& linkage,
                     const ReportOptions& options, Thumbnails& thumbnails, ReportPage& page) {
    const std::vector<std::string> names = short_names(d.names);
    const std::string title = fmt::format("{}: distances ({}) of {} shapes", d.type, metric, names.size());
    check_distances(d, page);
    page.begin_grid();
    page.figure(draw_distances(d.matrix, d.order, names, title),
                "Rows and columns are in the order of the tree, so that near shapes lie together.");
    if (names.size() > 1)
        page.figure(draw_dendrogram(d.tree, d.clusters, names, fmt::format("{}, {} linkage", title, linkage)),
                    "Where two branches meet is how far apart their shapes are.");
    page.end_grid();
    page.table(neighbour_table(d, options.neighbours, thumbnails));
    if (d.order.size() > kMostRows)
        page.note(
            fmt::format("The first {} of {} shapes in the order of the tree.", kMostRows, d.order.size()));
}

/// So many clusters that the largest gap between heights of the tree is cut, at most eight.
std::size_t natural_clusters(const Dendrogram& tree) {
    std::size_t best = 1;
    double widest = 0.0;
    const std::size_t merges = tree.merges.size();
    for (std::size_t k = 1; k < std::min<std::size_t>(merges, 8); ++k) {
        const double gap = tree.merges[merges - k].height - tree.merges[merges - k - 1].height;
        if (gap > widest) {
            widest = gap;
            best = k + 1;
        }
    }
    return best;
}

/// Spectra of shapes spread evenly over the tree.
void plot_spectra(const ShapeIndex& index, const TypeDistances& d, ReportPage& page) {
    std::map<std::string, const ShapeRecord*> by_name;
    for (const IndexEntry& e : index.entries)
        by_name[shape_name(e.file, e.shape.component, e.shape.components)] = &e.shape;
    const std::vector<std::string> names = short_names(d.names);
    const std::size_t shown = std::min(d.order.size(), kMostSeries);
    std::vector<PlotSeries> series;
    std::vector<double> x, y{0.0};
    for (std::size_t k = 0; k < shown; ++k) {
        const std::size_t i = d.order[k * d.order.size() / shown];
        const auto found = by_name.find(d.names[i]);
        if (found == by_name.end() || found->second->lengths.empty()) continue;
        PlotSeries& s = series.emplace_back(PlotSeries{names[i], {}});
        for (const double length : found->second->lengths) {
            s.points.push_back({static_cast<double>(s.points.size() + 1), length});
            x.push_back(s.points.back()[0]);
            y.push_back(length);
        }
    }
    if (series.empty()) return;
    std::string caption = "Lengths of closed geodesics, ascending, with multiplicity.";
    if (shown < d.order.size())
        caption += fmt::format(" {} of {} shapes, spread evenly over the tree.", shown, d.order.size());
    page.figure(draw_line_plot(series, axis_around(x, ScaleKind::linear), axis_around(y, ScaleKind::linear),
                               {"Length spectra, " + d.type, "number of the closed geodesic", "length"}),
                caption);
}

/// That the index was built with.
double tolerance_of(const ShapeIndex& index) {
    try {
        return index_config_from_toml(index.info.fingerprint).tolerance;
    } catch (const UsageError&) {
        return IndexConfig{}.tolerance;
    }
}

void check_shapes(const ShapeIndex& index, ReportPage& page) {
    const double tolerance = tolerance_of(index);
    for (const IndexEntry& e : index.entries) {
        const std::string name = shape_name(e.file, e.shape.component, e.shape.components);
        page.check(bounded(name, "shape", "residual, max |K - target|", e.shape.residual_max, tolerance,
                           std::max(1e-6, 100 * tolerance)));
        page.check(bounded(name, "shape", "Gauss-Bonnet error", e.shape.gauss_bonnet_error, 1e-8, 1e-5));
        if (!e.shape.message.empty())
            page.check({name, "shape", "note", "", "", Verdict::look, e.shape.message});
    }
}

void note_missing(const Thumbnails& thumbnails, ReportPage& page) {
    if (thumbnails.missing() > 0)
        page.note(fmt::format(
            "{} shapes have no picture: their files are not where they were described (paths are as "
            "given then, from the folder of that time), or they have no points.",
            thumbnails.missing()));
}

/// Shapes of a record as a tree. Throws FileError.
TypeDistances type_distances_of(const DistanceRecord& r) {
    TypeDistances d;
    d.type = r.type;
    d.names = r.shapes;
    d.matrix = {r.shapes.size(), r.distances};
    d.tree.leaves = r.shapes.size();
    std::vector<std::size_t> members(r.shapes.size(), 1);
    for (std::size_t k = 0; k < r.merge_first.size(); ++k) {
        const auto first = static_cast<std::size_t>(r.merge_first[k]),
                   second = static_cast<std::size_t>(r.merge_second[k]);
        members.push_back(members[first] + members[second]);
        d.tree.merges.push_back({first, second, r.merge_height[k], members.back()});
    }
    d.order.assign(r.leaf_order.begin(), r.leaf_order.end());
    d.clusters.assign(r.cluster.begin(), r.cluster.end());
    return d;
}

std::vector<DrawnSequence> drawn_of(const std::vector<PathRecord>& records) {
    std::vector<std::string> all;
    for (const PathRecord& r : records) all.insert(all.end(), r.files.begin(), r.files.end());
    const std::vector<std::string> names = short_names(all);
    std::vector<DrawnSequence> drawn;
    std::size_t next = 0;
    for (const PathRecord& r : records) {
        DrawnSequence& sequence = drawn.emplace_back();
        Index marking = -1;
        for (std::size_t k = 0; k < r.files.size(); ++k, ++next) {
            const auto begin = r.coordinates.begin() + static_cast<std::ptrdiff_t>(k * r.names.size());
            std::vector<double> c(begin, begin + static_cast<std::ptrdiff_t>(r.names.size()));
            if (r.status[k] != static_cast<std::uint8_t>(Status::converged) ||
                !std::all_of(c.begin(), c.end(), [](double x) { return std::isfinite(x); }))
                c.clear();
            const bool anew = marking >= 0 && r.marking_number[k] >= 0 && r.marking_number[k] != marking;
            if (r.marking_number[k] >= 0) marking = r.marking_number[k];
            sequence.frames.push_back({names[next], std::move(c), anew});
        }
    }
    return drawn;
}

PageTable frame_table(const PathRecord& r, const StatusNames& status, Thumbnails& thumbnails) {
    PageTable table{
        "Frames",
        {"frame", "", "file", "status", "marking", "step", "without marking", "length", "message"},
        {},
        {true, false, false, false, false, true, true, true, false}};
    for (std::size_t k = 0; k < std::min(r.files.size(), kMostRows); ++k)
        table.rows.push_back(
            {fmt::format("{}", k), thumbnails.of(r.files[k]), ReportPage::text(r.files[k]),
             r.status[k] < status.names.size() ? ReportPage::text(status.names[r.status[k]]) : "?",
             ReportPage::text(r.marking[k]), number_text(r.step[k]), number_text(r.free_step[k]),
             number_text(r.length[k]), ReportPage::text(r.message[k])});
    if (r.files.size() > kMostRows)
        table.caption += fmt::format(" (the first {} of {})", kMostRows, r.files.size());
    return table;
}

}  // namespace

void report_index(const std::string& path, const ReportOptions& options, ReportPage& page) {
    const ShapeIndex index = read_shape_index(path);
    const IndexReader reader(path);
    for (const FailureRecord& f : index.failures) page.failure(f.item, f.stage, f.status, f.message);
    check_shapes(index, page);
    Thumbnails thumbnails(page);
    for (const auto& [genus, boundaries] : reader.types()) {
        const IndexBucket bucket = reader.bucket(genus, boundaries).value();
        page.begin_section(fmt::format("Genus {}, {} boundaries", genus, boundaries),
                           fmt::format("{} shape{} of this topological type.", bucket.files.size(),
                                       bucket.files.size() == 1 ? "" : "s"));
        TypeDistances d = measure_distances(bucket, ShapeMetric::spectrum, Linkage::average, 1);
        if (d.names.size() > 1) {
            d.clusters = flat_clusters(d.tree, natural_clusters(d.tree));
            write_distances(d, "spectrum", "average", options, thumbnails, page);
        }
        plot_spectra(index, d, page);
        page.end_section();
    }
    note_missing(thumbnails, page);
}

void report_distances(const std::string& path, const ReportOptions& options, ReportPage& page) {
    const DistanceFile file = read_distance_file(path);
    Thumbnails thumbnails(page);
    for (const DistanceRecord& record : file.records) {
        page.begin_section(record.type,
                           fmt::format("{} shapes, {} linkage.", record.shapes.size(), record.linkage));
        write_distances(type_distances_of(record), record.metric, record.linkage, options, thumbnails, page);
        page.end_section();
    }
    note_missing(thumbnails, page);
}

void report_paths(const std::string& path, const ReportOptions& /*options*/, ReportPage& page) {
    const PathFile file = read_path_file(path);
    Thumbnails thumbnails(page);
    for (std::size_t s = 0; s < file.records.size(); ++s) {
        const PathRecord& r = file.records[s];
        for (std::size_t k = 0; k < r.files.size(); ++k)
            if (r.status[k] != static_cast<std::uint8_t>(Status::converged))
                page.failure(
                    r.files[k], fmt::format("sequence {}, frame {}", s + 1, k),
                    r.status[k] < file.info.status.names.size() ? file.info.status.names[r.status[k]] : "?",
                    r.message[k]);
            else if (!r.message[k].empty())
                page.check({r.files[k], fmt::format("sequence {}, frame {}", s + 1, k), "note", "", "",
                            Verdict::look, r.message[k]});
    }
    const std::vector<DrawnSequence> drawn = drawn_of(file.records);
    const bool any = std::any_of(drawn.begin(), drawn.end(), [](const DrawnSequence& s) {
        return std::any_of(s.frames.begin(), s.frames.end(),
                           [](const DrawnFrame& f) { return !f.coordinates.empty(); });
    });
    page.begin_section("The curve in shape space",
                       fmt::format("{} sequences of surfaces, type {}.", file.records.size(),
                                   file.records.empty() ? "" : file.records.front().type));
    if (any)
        page.figure(
            draw_path(drawn, file.records.front().names, "Path in shape space, " + file.records.front().type),
            "Left: the curve by its principal components. Right: its coordinates over the frames. Dashed: "
            "the "
            "coordinates are of other curves than before.");
    else
        page.note("No frame has coordinates.");
    page.end_section();
    for (std::size_t s = 0; s < file.records.size(); ++s) {
        page.begin_section(fmt::format("Sequence {}", s + 1));
        page.table(frame_table(file.records[s], file.info.status, thumbnails));
        page.end_section();
    }
    note_missing(thumbnails, page);
}

}  // namespace ricci::app
