// What can be handed over of an item, by name.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/app/handover/item_fields.h"
#include "engine/app/stored_layout.h"

namespace ricci::app {

struct BlockOptions {
    LayoutModel model = LayoutModel::conformal;
    std::size_t max_cells = 2'000'000;  // of `domains`: copies beyond that are left out
};

/// An item with what several of its blocks need, read once. Refers to run and item.
class ItemSource {
  public:
    ItemSource(const RunInfo& info, const StoredItem& item, const BlockOptions& options);
    ItemSource(const ItemSource&) = delete;
    ItemSource& operator=(const ItemSource&) = delete;
    ~ItemSource();

    [[nodiscard]] const RunInfo& info() const { return *info_; }
    [[nodiscard]] const StoredItem& item() const { return *item_; }
    [[nodiscard]] const BlockOptions& options() const { return options_; }
    [[nodiscard]] bool intrinsic() const { return item_->item.points.empty(); }
    /// Whether there is a layout that converged.
    [[nodiscard]] bool has_layout() const;
    /// Throws UsageError saying why there is none; FileError where it is damaged.
    [[nodiscard]] const StoredLayout& layout() const;

  private:
    const RunInfo* info_;
    const StoredItem* item_;
    BlockOptions options_;
    mutable std::unique_ptr<StoredLayout> layout_;
};

/// Names of all blocks there are:
///   surface         the mesh in space, with every field
///   cut_surface     the refined mesh, cut open along the sides of the domain, with the layout as texture
///                   coordinates
///   layout          the domain in its model, or on the sphere
///   domains         copies of the domain by the tessellation
///   outlines        their outlines
///   sides           sides of the domain in the layout
///   cut             the same on the surface
///   generators      generators on the surface
///   layout_generators  the same in the layout, in runs that end at its sides
///   geodesics       of the length spectrum
///   curves, loops   behind the coordinates in Teichmueller space
///   cones           cone points, with the best and the worst of a sweep
///   samples         vertices that a sweep has rows for, with these
///   charts          of the atlas, each in its own model
const std::vector<std::string>& block_names();

/// Throws UsageError unless it is one of these, or "all".
void require_block_name(const std::string& name);
/// Throws UsageError saying why where the item has no such block.
void require_block(const std::string& name, const ItemSource& source);

/// Those that the item has, in the order above.
std::vector<std::string> blocks_of(const ItemSource& source);

/// Throws UsageError for an unknown name and where the item lacks what the block shows, saying why; FileError
/// where what is stored does not fit together.
GeometryBlock make_block(const std::string& name, const ItemSource& source);

}  // namespace ricci::app
