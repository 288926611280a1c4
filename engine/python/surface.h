// A mesh as Python holds it: one component, ready for the engine.
#pragma once

#include <memory>
#include <string>

#include "engine/app/sweep_items.h"
#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"

namespace ricci::python {

/// Read-only once made.
struct Surface {
    std::shared_ptr<const LoadedMesh> loaded;  // one component; its stem is the surface's name
    std::string source;                        // the file, or ""

    [[nodiscard]] const SurfaceMesh& mesh() const { return loaded->components.front(); }
};

/// The record of an item made of a surface, or of what it became (`mesh`); its name is <name>@<faces>.
ItemRecord item_of(const Surface& surface, const SurfaceMesh& mesh);

/// The surface of a stored item. Throws FileError where it is none.
Surface surface_of_item(const ItemRecord& item);

/// The surface as an input of a sweep.
app::SweepSource source_of(const Surface& surface);

}  // namespace ricci::python
