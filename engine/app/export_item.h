// One stored item as a file, or several, of another kind.
#pragma once

#include <string>

#include "engine/app/handover/handover.h"
#include "io/store/run_store.h"

namespace ricci::app {

enum class ExportFormat : std::uint8_t { csv, vtk, multiblock, gltf, obj, npz, svg, script };

/// By the suffix. Throws UsageError naming those that there are.
ExportFormat export_format_of(const std::string& path);

/// What an export shows, with names as on the command line.
struct ExportOptions {
    std::string model = "auto";      // of a layout's coordinates; decides handover.blocks.model
    std::string picture = "domain";  // of .svg
    std::string program;             // of .py: blender, polyscope, paraview; "": by the file's name
    HandoverOptions handover;
};

/// The options with their names looked up. Throws UsageError for a suffix, a model, a picture, a program or a
/// block that there is not.
ExportOptions checked_options(const std::string& path, ExportOptions options);

/// Writes everything but .csv, which has rows of a whole run; several files where the format needs it
/// (docs/handover.md). Throws UsageError where the item lacks what is to be written; FileError.
void export_item(const std::string& path, const ItemSource& source, const ExportOptions& options);

}  // namespace ricci::app
