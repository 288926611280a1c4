#include "engine/app/handover/item_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>

#include "engine/app/console.h"
#include "engine/app/handover/blocks.h"
#include "engine/app/result_values.h"

namespace ricci::app {
namespace {

struct BlockKind {
    std::string name;
    bool (*has)(const ItemSource&);
    GeometryBlock (*make)(const ItemSource&);
};

bool has_points(const ItemSource& s) {
    return !s.intrinsic();
}
bool has_layout(const ItemSource& s) {
    return s.has_layout();
}
bool has_mapped_surface(const ItemSource& s) {
    return s.has_layout() && !s.intrinsic();
}
bool has_copies(const ItemSource& s) {
    return s.has_layout() && !s.layout().copies.empty();
}
bool has_outlines(const ItemSource& s) {
    return has_copies(s) && !s.layout().cut.sides.empty();
}
bool has_sides(const ItemSource& s) {
    return s.has_layout() && !s.layout().cut.sides.empty();
}
bool has_cut(const ItemSource& s) {
    return has_sides(s) && !s.intrinsic();
}
// Vertex paths do not tell the edges of an intrinsic surface apart, which may have several between two
// vertices.
bool has_generators(const ItemSource& s) {
    const auto drawn = [](const std::vector<Index>& path) { return path.size() > 1; };
    return has_mapped_surface(s) &&
           std::any_of(s.layout().generators.begin(), s.layout().generators.end(), drawn);
}

const std::vector<BlockKind>& kinds() {
    static const std::vector<BlockKind> list = {
        {"surface", has_points, blocks::surface},
        {"cut_surface", has_mapped_surface, blocks::cut_surface},
        {"layout", has_layout, blocks::layout},
        {"domains", has_copies, blocks::domains},
        {"outlines", has_outlines, blocks::outlines},
        {"sides", has_sides, blocks::sides},
        {"cut", has_cut, blocks::cut},
        {"generators", has_generators, blocks::generators},
        {"layout_generators", has_generators, blocks::layout_generators},
        {"geodesics", [](const ItemSource& s) { return blocks::has_drawn(s, "spectrum", "geodesics"); },
         blocks::geodesics},
        {"curves", [](const ItemSource& s) { return blocks::has_drawn(s, "teichmuller", "curves"); },
         blocks::curves},
        {"loops", [](const ItemSource& s) { return blocks::has_drawn(s, "teichmuller", "loops"); },
         blocks::loops},
        {"cones", [](const ItemSource& s) { return !s.intrinsic() && !blocks::find_cones(s.item()).empty(); },
         blocks::cones},
        {"samples", [](const ItemSource& s) { return !s.intrinsic() && s.item().sweep.has_value(); },
         blocks::samples},
        {"charts", [](const ItemSource& s) { return result_of(s.item(), "atlas") != nullptr; },
         blocks::charts}};
    return list;
}

const BlockKind& kind_of(const std::string& name) {
    for (const BlockKind& kind : kinds())
        if (kind.name == name) return kind;
    throw UsageError(
        fmt::format("nothing is called '{}' (known: {}, all)", name, fmt::join(block_names(), ", ")));
}

/// Why the block cannot be had.
std::string reason(const std::string& name, const ItemSource& s) {
    const auto is = [&](std::initializer_list<const char*> names) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    if (is({"layout", "sides", "domains", "outlines"}) ||
        (!s.intrinsic() && is({"cut_surface", "cut", "generators", "layout_generators"})))
        static_cast<void>(s.layout());  // throws where that is the reason
    if (name == "domains" || name == "outlines")
        return "no copies of the domain: `ricci layout MESH --copies N -o FILE` stores them";
    if (name == "sides" || name == "cut") return "the domain has no sides: it is the whole sphere";
    if (!s.intrinsic() && is({"generators", "layout_generators"}))
        return "a simply connected surface has no generators";
    if (name == "charts") return "no atlas: `ricci layout MESH --atlas auto -o FILE` makes one";
    if (s.intrinsic())
        return "an intrinsic surface has no points in space; what can be shown is its layout (--what layout)";
    if (name == "geodesics")
        return "no geodesics on the mesh: `ricci spectrum MESH --curves CURVES.vtp -o FILE` stores them";
    if (name == "curves" || name == "loops")
        return "no curves on the mesh: `ricci teichmuller MESH --curves CURVES.vtp -o FILE` stores them";
    if (name == "samples") return "no sweep: `ricci sweep MESH -o FILE` makes one";
    return "no cones";
}

}  // namespace

ItemSource::ItemSource(const RunInfo& info, const StoredItem& item, const BlockOptions& options)
    : info_(&info), item_(&item), options_(options) {}

ItemSource::~ItemSource() = default;

bool ItemSource::has_layout() const {
    const ResultGroup* group = result_of(*item_, "layout");
    return group != nullptr && group->arrays.size() > 0;
}

const StoredLayout& ItemSource::layout() const {
    if (layout_) return *layout_;
    const ResultGroup* group = result_of(*item_, "layout");
    if (group == nullptr)
        throw UsageError(
            fmt::format("{} has no layout: `ricci layout MESH -o FILE` makes one", item_->item.name));
    if (!has_layout()) {
        const auto& names = info_->status.names;
        throw UsageError(fmt::format("{} has no layout: its flow ended as {}", item_->item.name,
                                     group->status < names.size() ? names[group->status] : "unknown"));
    }
    layout_ = std::make_unique<StoredLayout>(read_layout_group(*group, item_->item.triangles.size()));
    return *layout_;
}

const std::vector<std::string>& block_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const BlockKind& kind : kinds()) list.push_back(kind.name);
        return list;
    }();
    return names;
}

std::vector<std::string> blocks_of(const ItemSource& source) {
    std::vector<std::string> names;
    for (const BlockKind& kind : kinds())
        if (kind.has(source)) names.push_back(kind.name);
    return names;
}

void require_block_name(const std::string& name) {
    if (name != "all") static_cast<void>(kind_of(name));
}

void require_block(const std::string& name, const ItemSource& source) {
    if (!kind_of(name).has(source))
        throw UsageError(fmt::format("{}: {}", source.item().item.name, reason(name, source)));
}

GeometryBlock make_block(const std::string& name, const ItemSource& source) {
    require_block(name, source);
    GeometryBlock block = kind_of(name).make(source);
    block.name = name;
    std::vector<DataArray> data = item_data(source.info(), source.item());
    block.field_data.insert(block.field_data.end(), std::make_move_iterator(data.begin()),
                            std::make_move_iterator(data.end()));
    try {
        require_valid(block);
    } catch (const std::invalid_argument& error) {
        // Numbers that are stored, not arguments.
        throw FileError(fmt::format("{}: {}", source.item().item.name, error.what()));
    }
    return block;
}

}  // namespace ricci::app
