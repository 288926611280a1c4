#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/records.h"
#include "engine/app/stored_layout.h"
#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"

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

std::string file_name(std::string item) {
    std::replace_if(
        item.begin(), item.end(), [](char c) { return c == '/' || c == '\\' || c == ' '; }, '_');
    return item;
}

const ResultGroup* find_result(const StoredItem& stored, const std::string& kind) {
    const auto found = std::find_if(stored.results.begin(), stored.results.end(),
                                    [&](const ResultGroup& group) { return group.kind == kind; });
    return found == stored.results.end() ? nullptr : &*found;
}

/// The layout of an item. Throws UsageError where it has none.
StoredLayout layout_of(const StoredItem& stored) {
    const ResultGroup* found = find_result(stored, "layout");
    if (found == nullptr)
        throw UsageError(
            fmt::format("{} has no layout: `ricci layout MESH -o FILE` makes one", stored.item.name));
    return read_layout_group(*found, stored.item.triangles.size());
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

int export_run(const std::string& path, const std::string& output, const std::string& only,
               const std::string& model, const std::string& picture, const CommonOptions& common) {
    const StoredRun run = read_run(path);
    const auto suffix = std::filesystem::path(output).extension().string();
    if (suffix == ".csv") {
        export_csv(output, run);
        if (common.json)
            print_json({{"file", output}});
        else
            fmt::print("wrote {}\n", output);
        return kDone;
    }
    if (suffix != ".vtu" && suffix != ".vtkhdf" && suffix != ".obj" && suffix != ".svg")
        throw UsageError(fmt::format("'{}': export writes .vtu, .vtkhdf, .obj, .svg and .csv", output));
    const PictureKind picture_kind = parse_picture_kind(picture);
    const LayoutModel layout_model = parse_layout_model(model);
    std::vector<const StoredItem*> items;
    for (const StoredItem& item : run.items)
        if (only.empty() || item.item.name == only) items.push_back(&item);
    if (items.empty())
        throw UsageError(fmt::format("{} holds no item{}", path, only.empty() ? "" : " named " + only));
    for (const StoredItem* item : items) {
        // One file per item: OUT.vtu for one, OUT.<item>.vtu for several.
        std::string name = output;
        if (items.size() > 1)
            name =
                output.substr(0, output.size() - suffix.size()) + "." + file_name(item->item.name) + suffix;
        if (item->item.points.empty() && suffix != ".svg") {
            spdlog::warn("{} is an intrinsic surface without points: not exported", item->item.name);
            continue;
        }
        if (suffix == ".svg") {
            export_picture(name, *item, picture_kind, layout_model);
        } else if (suffix == ".obj") {
            const StoredLayout stored = layout_of(*item);
            save_textured(name, textured_surface(stored.refinement, stored.layout, layout_model));
        } else if (suffix == ".vtu") {
            export_vtu(name, item->item, fields_of(*item));
        } else {
            export_vtkhdf(name, item->item, fields_of(*item));
        }
        if (common.json)
            print_json({{"item", item->item.name}, {"file", name}});
        else
            fmt::print("wrote {}\n", name);
    }
    return kDone;
}

}  // namespace

void add_export(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand(
        "export",
        "Convert results: .vtu and .vtkhdf for ParaView, .obj and .svg of a layout, .csv for tables");
    struct Arguments {
        std::string path, output, item, model = "auto", picture = "domain";
    };
    auto a = std::make_shared<Arguments>();
    command->add_option("FILE", a->path, "Result file (HDF5)")->required();
    command
        ->add_option("-o,--output", a->output,
                     "File to write: .vtu, .vtkhdf, .csv; .obj: the refined mesh with the layout as vt; "
                     ".svg: a picture of the layout")
        ->required();
    command->add_option("--item", a->item, "Only this item");
    command
        ->add_option("--model", a->model,
                     "Of .obj and .svg: auto, plane, poincare, klein, half-plane, disk, sphere")
        ->capture_default_str();
    command->add_option("--picture", a->picture, "Of .svg: as in `ricci layout --picture`")
        ->capture_default_str();
    add_common(*command, common);
    command->footer("Example: ricci export eight.h5 -o eight.vtu");
    command->callback([&common, &action, a] {
        action = [&common, a] {
            return export_run(a->path, a->output, a->item, a->model, a->picture, common);
        };
    });
}

}  // namespace ricci::app
