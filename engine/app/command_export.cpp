#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <set>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/handover/handover.h"
#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/records.h"
#include "engine/app/stored_layout.h"
#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"

namespace ricci::app {
namespace {

/// An array of doubles of a group; empty where there is none.
std::vector<double> doubles_of(const ResultGroup& group, const std::string& path) {
    for (const ResultArray& array : group.arrays)
        if (array.path == path && std::holds_alternative<std::vector<double>>(array.values))
            return std::get<std::vector<double>>(array.values);
    return {};
}

void export_picture(const std::string& file, const ItemSource& item_source, PictureKind kind,
                    LayoutModel model) {
    const StoredLayout& stored = item_source.layout();
    const StoredItem& item = item_source.item();
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

struct ExportArguments {
    std::string path, output, item, model = "auto", picture = "domain", program;
    HandoverOptions handover;
};

enum class Format : std::uint8_t { csv, vtk, multiblock, gltf, obj, npz, svg, script };

Format format_of(const std::string& output) {
    static const std::map<std::string, Format> formats = {
        {".csv", Format::csv},    {".vtu", Format::vtk},        {".vtp", Format::vtk},
        {".vtkhdf", Format::vtk}, {".vtm", Format::multiblock}, {".glb", Format::gltf},
        {".gltf", Format::gltf},  {".obj", Format::obj},        {".npz", Format::npz},
        {".svg", Format::svg},    {".py", Format::script}};
    const auto found = formats.find(std::filesystem::path(output).extension().string());
    if (found == formats.end())
        throw UsageError(
            fmt::format("'{}': export writes .vtu, .vtp, .vtm, .vtkhdf, .glb, .gltf, .obj, .npz, "
                        ".svg, .csv, and .blender.py, .polyscope.py, .paraview.py",
                        output));
    return found->second;
}

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

void write_item(Format format, const std::string& file, const ItemSource& source, const ExportArguments& a) {
    switch (format) {
        case Format::vtk:
            return write_vtk(file, source, a.handover);
        case Format::multiblock:
            return write_multiblock(file, {&source}, {""}, a.handover);
        case Format::gltf:
            return write_gltf(file, source, a.handover);
        case Format::obj:
            return write_obj(file, source, a.handover);
        case Format::npz:
            return write_npz(file, source, a.handover);
        case Format::script:
            return write_script(file, script_kind(a.output, a.program), source, a.handover);
        case Format::svg:
        case Format::csv:
            break;
    }
    export_picture(file, source, parse_picture_kind(a.picture), a.handover.blocks.model);
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
int export_apart(Format format, const StoredRun& run, const std::vector<const StoredItem*>& items,
                 const ExportArguments& a, const CommonOptions& common) {
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
            write_item(format, file, ItemSource(run.info, *items[i], a.handover.blocks), a);
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
        auto source = std::make_unique<ItemSource>(run.info, *item, a.handover.blocks);
        try {
            const std::vector<std::string> there = blocks_of(*source);
            if (there.empty())
                throw UsageError(item->item.name +
                                 " is an intrinsic surface without a layout: nothing to show");
            for (const std::string& name : wanted_blocks(*source, a.handover.what, there))
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
    write_multiblock(a.output, sources, file_names(shown), a.handover);
    report("", a.output, common);
    return shown.size() < items.size() ? kSomeFailed : kDone;
}

int export_run(ExportArguments a, const CommonOptions& common) {
    const Format format = format_of(a.output);
    a.handover.blocks.model = parse_layout_model(a.model);
    parse_picture_kind(a.picture);
    if (format == Format::script)
        script_kind(a.output, a.program);
    else if (!a.program.empty())
        throw UsageError("--for goes with a .py");
    for (const std::string& name : a.handover.what) require_block_name(name);
    const StoredRun run = read_run(a.path);
    if (format == Format::csv) {
        export_csv(a.output, run);
        report("", a.output, common);
        return kDone;
    }
    std::vector<const StoredItem*> items;
    for (const StoredItem& item : run.items)
        if (a.item.empty() || item.item.name == a.item) items.push_back(&item);
    if (items.empty())
        throw UsageError(fmt::format("{} holds no item{}", a.path, a.item.empty() ? "" : " named " + a.item));
    if (format == Format::multiblock && items.size() > 1) return export_together(run, items, a, common);
    return export_apart(format, run, items, a, common);
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
        ->add_option("--what", a->handover.what,
                     "Blocks, with commas: " + fmt::format("{}", fmt::join(block_names(), ", ")) + ", all")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        ->add_option("--field", a->handover.field,
                     "Of .glb, .gltf and scripts: what colours the surface; auto, none, or a field's name")
        ->capture_default_str();
    command->add_option("--checker", a->handover.checker, "Squares of the checkerboard along a side; 0: none")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    command
        ->add_option("--model", a->model,
                     "Of the layout: auto, plane, poincare, klein, half-plane, disk, sphere")
        ->capture_default_str();
    command
        ->add_option("--max-cells", a->handover.blocks.max_cells,
                     "Copies of the domain up to so many polygons")
        ->capture_default_str()
        ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
    command->add_option("--picture", a->picture, "Of .svg: as in `ricci layout --picture`")
        ->capture_default_str();
    command->add_option("--for", a->program, "Of .py: blender, polyscope or paraview")
        ->check(CLI::IsMember({"blender", "polyscope", "paraview"}));
    add_common(*command, common);
    command->footer(
        "Example: ricci export eight.h5 -o eight.vtm\n"
        "         ricci export eight.h5 -o eight.blender.py && blender --python eight.blender.py");
    command->callback([&common, &action, a] { action = [&common, a] { return export_run(*a, common); }; });
}

}  // namespace ricci::app
