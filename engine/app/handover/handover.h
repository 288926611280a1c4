// Writing items for other programs, one function per family of formats.
#pragma once

#include <string>
#include <vector>

#include "engine/app/handover/item_blocks.h"

namespace ricci::app {

struct HandoverOptions {
    std::vector<std::string> what;  // blocks; empty: what suits the format; "all": all that the item has
    std::string field = "auto";     // what colours the surface, see choose_field
    int checker = 16;               // squares of the checkerboard along a side; 0: none
    BlockOptions blocks;
};

/// Names asked for that the item has: `what`, where it says "all" every block; where it is empty, those of
/// `suited` that the item has. Throws UsageError for a block that is unknown.
std::vector<std::string> wanted_blocks(const ItemSource& source, const std::vector<std::string>& what,
                                       const std::vector<std::string>& suited);

// All throw UsageError where the item lacks what is asked for, FileError where the result file is damaged or
// writing fails.

/// .vtp, .vtu or .vtkhdf: one block, the surface by default.
void write_vtk(const std::string& path, const ItemSource& source, const HandoverOptions& options);
/// .vtm, and its blocks in the folder <stem>.blocks beside it; with several items a branch for each, under
/// the names given. With `scene` (for the script) also scene.json and checker.png in the folder.
void write_multiblock(const std::string& path, const std::vector<const ItemSource*>& sources,
                      const std::vector<std::string>& names, const HandoverOptions& options,
                      bool scene = false);

/// .glb or .gltf: the surface with its curves and cones; as a second scene its layout.
void write_gltf(const std::string& path, const ItemSource& source, const HandoverOptions& options);

/// .obj: the refined surface with the layout as texture coordinates, .mtl and .png beside it; or another
/// block by name.
void write_obj(const std::string& path, const ItemSource& source, const HandoverOptions& options);

/// .npz: blocks as arrays <block>/points, /corners, /first, /point_data/NAME, ...; `about` is JSON in UTF-8
/// with names, units, texts and colours.
void write_npz(const std::string& path, const ItemSource& source, const HandoverOptions& options);

enum class ScriptKind : std::uint8_t { blender, polyscope, paraview };
/// The kind that NAME.blender.py and the like ask for, or `wanted` ("" : none). Throws UsageError where
/// neither says, or they differ.
ScriptKind script_kind(const std::string& path, const std::string& wanted);
/// NAME.blender.py, NAME.polyscope.py: a script and NAME.npz beside it; NAME.paraview.py: with NAME.vtm.
void write_script(const std::string& path, ScriptKind kind, const ItemSource& source,
                  const HandoverOptions& options);

}  // namespace ricci::app
