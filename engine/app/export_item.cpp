#include "engine/app/export_item.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "engine/app/console.h"
#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/records.h"

namespace ricci::app {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Everything per vertex that an item holds; NaN where a vertex has no value.
std::vector<PointField> fields_of(const StoredItem& stored) {
    const std::size_t vertices = stored.item.points.size();
    std::vector<PointField> fields;
    if (stored.sweep) {
        PointField distortion{"area_distortion", std::vector<double>(vertices, kNone)}, steps = distortion,
                                                                                        residual = distortion;
        steps.name = "newton_iterations";
        residual.name = "residual_max";
        for (const SweepRow& row : stored.sweep->rows) {
            const auto v = static_cast<std::size_t>(row.vertex);
            distortion.values[v] = row.area_distortion;
            steps.values[v] = row.newton_iterations;
            residual.values[v] = row.residual_max;
        }
        fields.push_back(std::move(distortion));
        fields.push_back(std::move(steps));
        fields.push_back(std::move(residual));
        for (const KeptFactor& kept : stored.sweep->kept) {
            if (kept.vertex == stored.sweep->best)
                fields.push_back({"best_conformal_factor", kept.conformal_factor});
            if (kept.vertex == stored.sweep->worst)
                fields.push_back({"worst_conformal_factor", kept.conformal_factor});
        }
    }
    if (stored.flow) {
        fields.push_back({"conformal_factor", stored.flow->conformal_factor});
        fields.push_back({"curvature", stored.flow->curvature});
        fields.push_back({"target_curvature", stored.flow->target_curvature});
    }
    return fields;
}

/// An array of doubles of a group; empty where there is none.
std::vector<double> doubles_of(const ResultGroup& group, const std::string& path) {
    for (const ResultArray& array : group.arrays)
        if (array.path == path && std::holds_alternative<std::vector<double>>(array.values))
            return std::get<std::vector<double>>(array.values);
    return {};
}

void export_picture(const std::string& file, const StoredItem& item, PictureKind kind, LayoutModel model) {
    const StoredLayout stored = layout_of(item);
    const SurfaceMesh mesh = surface_of(item.item);
    PictureSource source;
    source.layout = &stored;
    source.mesh = &mesh;
    source.generators = stored.generators;
    if (const ResultGroup* quality = find_result(item, "quality")) {
        source.log_area_ratio = doubles_of(*quality, "log_area_ratio");
        if (source.log_area_ratio.size() != item.item.triangles.size()) source.log_area_ratio.clear();
        const std::vector<double> ratio = doubles_of(*quality, "angles/ratio");
        for (const ResultArray& array : quality->arrays) {
            if (array.path != "angles/kind" ||
                !std::holds_alternative<std::vector<std::uint8_t>>(array.values))
                continue;
            const auto& kinds = std::get<std::vector<std::uint8_t>>(array.values);
            for (std::size_t c = 0; c < std::min(kinds.size(), ratio.size()); ++c) {
                if (kinds[c] == static_cast<std::uint8_t>(CornerKind::regular))
                    source.angle_ratio.push_back(ratio[c]);
                if (kinds[c] == static_cast<std::uint8_t>(CornerKind::curved))
                    source.curved_angle_ratio.push_back(ratio[c]);
            }
        }
    }
    draw_picture(kind, model, source).save(file);
}

}  // namespace

const ResultGroup* find_result(const StoredItem& stored, const std::string& kind) {
    const auto found = std::find_if(stored.results.begin(), stored.results.end(),
                                    [&](const ResultGroup& group) { return group.kind == kind; });
    return found == stored.results.end() ? nullptr : &*found;
}

StoredLayout layout_of(const StoredItem& stored) {
    const ResultGroup* found = find_result(stored, "layout");
    if (found == nullptr)
        throw UsageError(
            fmt::format("{} has no layout: `ricci layout MESH -o FILE` makes one", stored.item.name));
    return read_layout_group(*found, stored.item.triangles.size());
}

void require_exportable(const std::string& path, const ExportOptions& options) {
    const auto suffix = std::filesystem::path(path).extension().string();
    if (suffix != ".vtu" && suffix != ".vtkhdf" && suffix != ".obj" && suffix != ".svg")
        throw UsageError(fmt::format("'{}': export writes .vtu, .vtkhdf, .obj, .svg and .csv", path));
    parse_picture_kind(options.picture);
    parse_layout_model(options.model);
}

void export_item(const StoredItem& stored, const std::string& path, const ExportOptions& options) {
    require_exportable(path, options);
    const auto suffix = std::filesystem::path(path).extension().string();
    const LayoutModel model = parse_layout_model(options.model);
    if (suffix == ".svg") {
        export_picture(path, stored, parse_picture_kind(options.picture), model);
    } else if (stored.item.points.empty()) {
        throw UsageError(stored.item.name + " is an intrinsic surface without points");
    } else if (suffix == ".obj") {
        const StoredLayout layout = layout_of(stored);
        save_textured(path, textured_surface(layout.refinement, layout.layout, model), options.checker);
    } else if (suffix == ".vtu") {
        export_vtu(path, stored.item, fields_of(stored));
    } else {
        export_vtkhdf(path, stored.item, fields_of(stored));
    }
}

}  // namespace ricci::app
