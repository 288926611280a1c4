#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <set>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/export_item.h"
#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"

namespace ricci::app {
namespace {

struct ExportArguments {
    std::string path, output, item;
    ExportOptions options;
};

/// Names of items as parts of file names, no two alike.
std::vector<std::string> file_names(const std::vector<const StoredItem*>& items) {
    std::set<std::string> taken;
    std::vector<std::string> names;
    for (const StoredItem* item : items) {
        std::string name = item->item.name;
        std::replace_if(
            name.begin(), name.end(),
            [](char c) { return c == '/' || c == '\\' || static_cast<unsigned char>(c) <= ' '; }, '_');
        if (name == "." || name == "..") name += '_';
        std::string unique = name;
        for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}~{}", name, k);
        names.push_back(unique);
    }
    return names;
}

/// OUT.vtu for one item, OUT.<item>.vtu for several; OUT.<item>.blender.py.
std::string output_of(const std::string& output, const std::string& item) {
    const std::filesystem::path path(output);
    std::string suffix = path.extension().string();
    const std::string inner = std::filesystem::path(path).replace_extension().extension().string();
    if (suffix == ".py" && (inner == ".blender" || inner == ".polyscope" || inner == ".paraview"))
        suffix = inner + suffix;
    return output.substr(0, output.size() - suffix.size()) + "." + item + suffix;
}

void report(const std::string& item, const std::string& file, const CommonOptions& common) {
    if (common.json) {
        nlohmann::json object = {{"file", file}};
        if (!item.empty()) object["item"] = item;
        print_json(object);
    } else {
        fmt::print("wrote {}\n", file);
    }
}

/// One file for each item. What one of several lacks keeps none of the others from being written.
int export_apart(const StoredRun& run, const std::vector<const StoredItem*>& items, const ExportArguments& a,
                 const CommonOptions& common) {
    const std::vector<std::string> names = file_names(items);
    std::exception_ptr last;
    std::size_t failed = 0;
    const auto note = [&](const std::exception& error) {
        last = std::current_exception();
        ++failed;
        if (items.size() > 1) spdlog::error("{}", error.what());
    };
    for (std::size_t i = 0; i < items.size(); ++i) {
        const std::string file = items.size() > 1 ? output_of(a.output, names[i]) : a.output;
        try {
            export_item(file, ItemSource(run.info, *items[i], a.options.handover.blocks), a.options);
            report(items[i]->item.name, file, common);
        } catch (const UsageError& error) {
            note(error);
        } catch (const FileError& error) {
            note(error);
        } catch (const std::invalid_argument& error) {
            note(error);
        }
    }
    if (failed == items.size()) {
        if (items.size() > 1) throw UsageError("nothing was written");
        std::rethrow_exception(last);
    }
    return failed > 0 ? kSomeFailed : kDone;
}

/// All items under one head.
int export_together(const StoredRun& run, const std::vector<const StoredItem*>& items,
                    const ExportArguments& a, const CommonOptions& common) {
    std::vector<std::unique_ptr<ItemSource>> owned;
    std::vector<const ItemSource*> sources;
    std::vector<const StoredItem*> shown;
    for (const StoredItem* item : items) {
        auto source = std::make_unique<ItemSource>(run.info, *item, a.options.handover.blocks);
        try {
            const std::vector<std::string> there = blocks_of(*source);
            if (there.empty())
                throw UsageError(item->item.name +
                                 " is an intrinsic surface without a layout: nothing to show");
            for (const std::string& name : wanted_blocks(*source, a.options.handover.what, there))
                require_block(name, *source);
        } catch (const UsageError& error) {
            if (items.size() == 1) throw;
            spdlog::error("{}", error.what());
            continue;
        }
        sources.push_back(source.get());
        shown.push_back(item);
        owned.push_back(std::move(source));
    }
    if (sources.empty()) throw UsageError("nothing was written");
    write_multiblock(a.output, sources, file_names(shown), a.options.handover);
    report("", a.output, common);
    return shown.size() < items.size() ? kSomeFailed : kDone;
}

int export_run(ExportArguments a, const CommonOptions& common) {
    const ExportFormat format = export_format_of(a.output);
    a.options = checked_options(a.output, a.options);
    const StoredRun run = read_run(a.path);
    if (format == ExportFormat::csv) {
        export_csv(a.output, run);
        report("", a.output, common);
        return kDone;
    }
    std::vector<const StoredItem*> items;
    for (const StoredItem& item : run.items)
        if (a.item.empty() || item.item.name == a.item) items.push_back(&item);
    if (items.empty())
        throw UsageError(fmt::format("{} holds no item{}", a.path, a.item.empty() ? "" : " named " + a.item));
    if (format == ExportFormat::multiblock && items.size() > 1) return export_together(run, items, a, common);
    return export_apart(run, items, a, common);
}

}  // namespace

void add_export(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand(
        "export",
        "Hand results over to other programs: VTK, glTF, OBJ, numpy, SVG, CSV, and scripts for "
        "Blender, Polyscope and ParaView");
    auto a = std::make_shared<ExportArguments>();
    command->add_option("FILE", a->path, "Result file (HDF5)")->required();
    command
        ->add_option(
            "-o,--output", a->output,
            "File to write. .vtp, .vtu, .vtkhdf: one block; .vtm: all of them; .glb, .gltf: surface, "
            "curves, cones, layout; .obj: the refined mesh with the layout as vt, .mtl and .png; "
            ".npz: arrays for numpy; .svg: a picture of the layout; .csv: rows of a sweep; "
            ".blender.py, .polyscope.py, .paraview.py: a script with its data beside it")
        ->required();
    command->add_option("--item", a->item, "Only this item");
    command
        ->add_option("--what", a->options.handover.what,
                     "Blocks, with commas: " + fmt::format("{}", fmt::join(block_names(), ", ")) + ", all")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        ->add_option("--field", a->options.handover.field,
                     "Of .glb, .gltf and scripts: what colours the surface; auto, none, or a field's name")
        ->capture_default_str();
    command
        ->add_option("--checker", a->options.handover.checker,
                     "Squares of the checkerboard along a side; 0: none")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    command
        ->add_option("--model", a->options.model,
                     "Of the layout: auto, plane, poincare, klein, half-plane, disk, sphere")
        ->capture_default_str();
    command
        ->add_option("--max-cells", a->options.handover.blocks.max_cells,
                     "Copies of the domain up to so many polygons")
        ->capture_default_str()
        ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
    command->add_option("--picture", a->options.picture, "Of .svg: as in `ricci layout --picture`")
        ->capture_default_str();
    command->add_option("--for", a->options.program, "Of .py: blender, polyscope or paraview")
        ->check(CLI::IsMember({"blender", "polyscope", "paraview"}));
    add_common(*command, common);
    command->footer(
        "Example: ricci export eight.h5 -o eight.vtm\n"
        "         ricci export eight.h5 -o eight.blender.py && blender --python eight.blender.py");
    command->callback([&common, &action, a] { action = [&common, a] { return export_run(*a, common); }; });
}

}  // namespace ricci::app
