// One stored item as a file of another kind.
#pragma once

#include <string>

#include "engine/app/stored_layout.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// The result group of a kind; null where the item has none.
const ResultGroup* find_result(const StoredItem& stored, const std::string& kind);

/// The layout of an item. Throws UsageError where it has none.
StoredLayout layout_of(const StoredItem& stored);

/// What an export of a layout shows: the model of its coordinates, the picture (.svg), a checkerboard of so
/// many squares (.obj; 0: none). Names as on the command line.
struct ExportOptions {
    std::string model = "auto", picture = "domain";
    int checker = 0;
};

/// Complains about options that there are not, and about suffixes other than .vtu, .vtkhdf, .obj and .svg.
/// Throws UsageError.
void require_exportable(const std::string& path, const ExportOptions& options);

/// Writes .vtu or .vtkhdf with all that the item holds per vertex, .obj of its layout with texture
/// coordinates, or a picture as .svg. Throws UsageError where the item lacks what is to be written;
/// FileError.
void export_item(const StoredItem& stored, const std::string& path, const ExportOptions& options);

}  // namespace ricci::app
