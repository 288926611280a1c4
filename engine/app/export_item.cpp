#include "engine/app/export_item.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "engine/app/console.h"
#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/records.h"
#include "engine/app/result_values.h"
#include "engine/app/stored_layout.h"

namespace ricci::app {
namespace {

void export_picture(const std::string& file, const ItemSource& item_source, const ExportOptions& options) {
    const StoredLayout& stored = item_source.layout();
    const StoredItem& item = item_source.item();
    const SurfaceMesh mesh = surface_of(item.item);
    PictureSource source;
    source.layout = &stored;
    source.mesh = &mesh;
    source.generators = stored.generators;
    if (const ResultGroup* quality = result_of(item, "quality")) {
        source.log_area_ratio = values_of<double>(*quality, "log_area_ratio");
        if (source.log_area_ratio.size() != item.item.triangles.size()) source.log_area_ratio.clear();
        take_stored_angles(*quality, source);
    }
    draw_picture(parse_picture_kind(options.picture), options.handover.blocks.model, source).save(file);
}

}  // namespace

ExportFormat export_format_of(const std::string& output) {
    static const std::map<std::string, ExportFormat> formats = {
        {".csv", ExportFormat::csv},    {".vtu", ExportFormat::vtk},        {".vtp", ExportFormat::vtk},
        {".vtkhdf", ExportFormat::vtk}, {".vtm", ExportFormat::multiblock}, {".glb", ExportFormat::gltf},
        {".gltf", ExportFormat::gltf},  {".obj", ExportFormat::obj},        {".npz", ExportFormat::npz},
        {".svg", ExportFormat::svg},    {".py", ExportFormat::script}};
    const auto found = formats.find(std::filesystem::path(output).extension().string());
    if (found == formats.end())
        throw UsageError(
            fmt::format("'{}': export writes .vtu, .vtp, .vtm, .vtkhdf, .glb, .gltf, .obj, .npz, "
                        ".svg, .csv, and .blender.py, .polyscope.py, .paraview.py",
                        output));
    return found->second;
}

ExportOptions checked_options(const std::string& path, ExportOptions options) {
    const ExportFormat format = export_format_of(path);
    options.handover.blocks.model = parse_layout_model(options.model);
    parse_picture_kind(options.picture);
    if (format == ExportFormat::script)
        script_kind(path, options.program);
    else if (!options.program.empty())
        throw UsageError("--for goes with a .py");
    for (const std::string& name : options.handover.what) require_block_name(name);
    return options;
}

void export_item(const std::string& path, const ItemSource& source, const ExportOptions& options) {
    const HandoverOptions& handover = options.handover;
    switch (export_format_of(path)) {
        case ExportFormat::vtk:
            return write_vtk(path, source, handover);
        case ExportFormat::multiblock:
            return write_multiblock(path, {&source}, {""}, handover);
        case ExportFormat::gltf:
            return write_gltf(path, source, handover);
        case ExportFormat::obj:
            return write_obj(path, source, handover);
        case ExportFormat::npz:
            return write_npz(path, source, handover);
        case ExportFormat::script:
            return write_script(path, script_kind(path, options.program), source, handover);
        case ExportFormat::csv:
            throw UsageError("'" + path + "': .csv holds the rows of a whole run, not of an item");
        case ExportFormat::svg:
            break;
    }
    export_picture(path, source, options);
}

}  // namespace ricci::app
