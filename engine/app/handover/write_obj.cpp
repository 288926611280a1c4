#include "engine/app/console.h"
#include "engine/app/handover/handover.h"
#include "engine/app/stored_layout.h"
#include "io/mesh/save_curves.h"
#include "io/mesh/save_textured.h"

namespace ricci::app {
namespace {

/// A block of polygons without texture.
TexturedMesh plain_mesh(const GeometryBlock& block) {
    TexturedMesh mesh;
    mesh.points = block.points;
    mesh.face_start = block.first;
    for (const Index v : block.corners) mesh.corners.push_back({v, kNoTexture});
    return mesh;
}

std::vector<NamedCurve> curves_of(const GeometryBlock& block) {
    const DataArray* names = find_array(block.cell_data, "name");
    const std::vector<double>* lengths = find_doubles(block.cell_data, "length");
    std::vector<NamedCurve> curves;
    for (std::size_t i = 0; i < block.cell_count(); ++i) {
        NamedCurve& curve = curves.emplace_back();
        curve.name =
            names == nullptr ? std::to_string(i) : std::get<std::vector<std::string>>(names->values)[i];
        curve.length = lengths == nullptr ? 0.0 : (*lengths)[i];
        for (const Index v : block.cell(i)) curve.points.push_back(block.points[static_cast<std::size_t>(v)]);
    }
    return curves;
}

}  // namespace

void write_obj(const std::string& path, const ItemSource& source, const HandoverOptions& options) {
    const std::vector<std::string> names = wanted_blocks(source, options.what, {});
    if (names.size() > 1) throw UsageError("an .obj holds one thing: name one with --what");
    const std::string name = names.empty() ? "cut_surface" : names.front();
    const LayoutModel model = options.blocks.model;
    if (name == "cut_surface") {
        const StoredLayout& stored = source.layout();
        save_textured(path, textured_surface(stored.refinement, stored.layout, model), options.checker);
    } else if (name == "layout") {
        const StoredLayout& stored = source.layout();
        save_textured(path, layout_surface(stored.refinement, stored.layout, model), options.checker);
    } else {
        const GeometryBlock block = make_block(name, source);
        if (block.kind == CellKind::point)
            throw UsageError("points are not written as .obj: take .vtp or .npz");
        if (block.kind == CellKind::polygon)
            save_textured(path, plain_mesh(block));
        else
            save_curves(path, curves_of(block));
    }
}

}  // namespace ricci::app
