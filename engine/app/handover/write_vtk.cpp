#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "engine/app/console.h"
#include "engine/app/handover/handover.h"
#include "engine/app/handover/scene_description.h"
#include "io/exchange/staged_file.h"
#include "io/exchange/vtk_hdf.h"
#include "io/exchange/vtk_xml.h"
#include "io/picture/checker_image.h"
#include "io/store/stored_text.h"

namespace ricci::app {
namespace {

std::string only_block(const ItemSource& source, const HandoverOptions& options, const std::string& suited) {
    if (options.what.empty()) return suited;
    const std::vector<std::string> names = wanted_blocks(source, options.what, {});
    if (names.size() != 1)
        throw UsageError("this format holds one thing: name one with --what, or write a .vtm");
    return names.front();
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directory(folder, error);
    if (error) throw system_error(folder.string(), "cannot create the folder", error.value());
}

std::string checked_texture(const HandoverOptions& options, bool coloured) {
    constexpr std::uint8_t kSoft = 150;  // lets colours through
    return checker_png(options.checker, coloured ? kSoft : 0);
}

/// The blocks of one item into `folder`, which is `relative` to the head.
std::vector<VtkBlockTree> write_blocks(const ItemSource& source, const HandoverOptions& options,
                                       const std::filesystem::path& folder, const std::string& relative,
                                       bool scene) {
    make_folder(folder);
    const std::optional<ShownField> field =
        scene ? choose_field(source.item(), options.field, source.has_layout()) : std::nullopt;
    nlohmann::json description;
    if (scene) description = describe_scene(source, options, field);
    std::vector<VtkBlockTree> leaves;
    for (const std::string& name : wanted_blocks(source, options.what, block_names())) {
        const GeometryBlock block = make_block(name, source);
        save_vtk_xml((folder / (name + ".vtp")).string(), block);
        leaves.push_back({name, relative + "/" + name + ".vtp", {}});
        if (scene) description["blocks"][name] = describe_block(block);
    }
    if (leaves.empty()) throw UsageError(source.item().item.name + " holds nothing that can be shown");
    if (!scene) return leaves;
    write_text_durably((folder / "scene.json").string(), json_text(description) + "\n");
    if (options.checker > 0)
        write_text_durably((folder / "checker.png").string(), checked_texture(options, field.has_value()));
    return leaves;
}

}  // namespace

std::vector<std::string> wanted_blocks(const ItemSource& source, const std::vector<std::string>& what,
                                       const std::vector<std::string>& suited) {
    const std::vector<std::string> there = blocks_of(source);
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    if (what.empty()) {
        for (const std::string& name : suited)
            if (std::find(there.begin(), there.end(), name) != there.end()) add(name);
        return names;
    }
    for (const std::string& name : what) {
        if (name == "all")
            std::for_each(there.begin(), there.end(), add);
        else
            add(name);
    }
    return names;
}

void write_vtk(const std::string& path, const ItemSource& source, const HandoverOptions& options) {
    const GeometryBlock block = make_block(only_block(source, options, "surface"), source);
    if (std::filesystem::path(path).extension() == ".vtkhdf")
        save_vtkhdf(path, block);
    else
        save_vtk_xml(path, block);
}

void write_multiblock(const std::string& path, const std::vector<const ItemSource*>& sources,
                      const std::vector<std::string>& names, const HandoverOptions& options, bool scene) {
    std::filesystem::path folder(path);
    folder.replace_extension(".blocks");
    const std::string relative = folder.filename().string();
    std::vector<VtkBlockTree> tree;
    make_folder(folder);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (sources.size() == 1) {
            tree = write_blocks(*sources[i], options, folder, relative, scene);
            break;
        }
        tree.push_back(
            {sources[i]->item().item.name, "",
             write_blocks(*sources[i], options, folder / names[i], relative + "/" + names[i], scene)});
    }
    save_vtm(path, tree);
}

}  // namespace ricci::app
