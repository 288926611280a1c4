// VTK's XML formats, for ParaView and everything else that reads them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/exchange/geometry_block.h"

namespace ricci {

/// Writes `path` by suffix: .vtp (PolyData) or .vtu (UnstructuredGrid). Arrays are appended as raw bytes, so
/// that every double and integer comes back as it is; texts are UTF-8 (bytes that are not as \xNN). Units
/// stand in the information key UNITS_LABEL of each array. Field data hold one row per tuple. Throws
/// std::invalid_argument as require_valid(), FileError for another suffix and where writing fails.
void save_vtk_xml(const std::string& path, const GeometryBlock& block);

/// A tree of files under one head. A leaf names a file relative to the head; a branch has children.
struct VtkBlockTree {
    std::string name, file;
    std::vector<VtkBlockTree> children;
};

/// Writes a .vtm (MultiBlockDataSet) that ties the files together. Throws FileError.
void save_vtm(const std::string& path, std::span<const VtkBlockTree> blocks);

}  // namespace ricci
