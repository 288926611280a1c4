#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/export_item.h"
#include "io/store/run_store.h"

namespace ricci::app {
namespace {

std::string file_name(std::string item) {
    std::replace_if(
        item.begin(), item.end(), [](char c) { return c == '/' || c == '\\' || c == ' '; }, '_');
    return item;
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
    const ExportOptions options{model, picture, 0};
    require_exportable(output, options);
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
        export_item(*item, name, options);
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
