#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "engine/app/app.h"
#include "engine/app/commands.h"
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

int export_run(const std::string& path, const std::string& output, const std::string& only,
               const CommonOptions& common) {
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
    if (suffix != ".vtu" && suffix != ".vtkhdf")
        throw UsageError(fmt::format("'{}': export writes .vtu, .vtkhdf and .csv", output));
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
        if (item->item.points.empty()) {
            spdlog::warn("{} is an intrinsic surface without points: not exported", item->item.name);
            continue;
        }
        if (suffix == ".vtu")
            export_vtu(name, item->item, fields_of(*item));
        else
            export_vtkhdf(name, item->item, fields_of(*item));
        if (common.json)
            print_json({{"item", item->item.name}, {"file", name}});
        else
            fmt::print("wrote {}\n", name);
    }
    return kDone;
}

}  // namespace

void add_export(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("export", "Convert results: .vtu and .vtkhdf for ParaView, .csv for tables");
    struct Arguments {
        std::string path, output, item;
    };
    auto a = std::make_shared<Arguments>();
    command->add_option("FILE", a->path, "Result file (HDF5)")->required();
    command->add_option("-o,--output", a->output, "File to write: .vtu, .vtkhdf or .csv")->required();
    command->add_option("--item", a->item, "Only this item");
    add_common(*command, common);
    command->footer("Example: ricci export eight.h5 -o eight.vtu");
    command->callback([&common, &action, a] {
        action = [&common, a] { return export_run(a->path, a->output, a->item, common); };
    });
}

}  // namespace ricci::app
