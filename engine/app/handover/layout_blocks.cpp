// The domain in its model and on the surface, and its copies.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "engine/app/handover/blocks.h"
#include "engine/app/handover/refined_field.h"
#include "engine/app/pictures/copy_colours.h"
#include "engine/app/pictures/laid_out_domain.h"
#include "engine/app/result_values.h"
#include "engine/app/stored_arrays.h"
#include "io/exchange/vertex_normals.h"
#include "io/picture/colour.h"

namespace ricci::app::blocks {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A position as a point in space: of the sphere, or of the model's plane z = 0.
Point placed(const std::array<double, 3>& position, LayoutModel model, int kappa) {
    if (kappa > 0) return position;
    const std::array<double, 2> z = model_point(model, kappa, position);
    return {z[0], z[1], 0.0};
}

std::vector<double> texture_of(const SurfaceLayout& layout, LayoutModel model) {
    std::vector<double> uv;
    for (const auto& row : texture_coordinates(layout, model)) uv.insert(uv.end(), row.begin(), row.end());
    return uv;
}

/// What layout vertices say of themselves, and the fields of the mesh on them. // L rows
std::vector<DataArray> layout_vertex_data(const ItemSource& source) {
    const StoredLayout& stored = source.layout();
    const SurfaceLayout& layout = stored.layout;
    std::vector<double> position, conformal;
    for (const auto& p : layout.position) {
        position.insert(position.end(), p.begin(), p.end());
        const std::array<double, 2> z = conformal_point(layout.kappa, p);
        conformal.insert(conformal.end(), z.begin(), z.end());
    }
    std::vector<DataArray> data = {{"uv", "1", 2, texture_of(layout, source.options().model)},
                                   {"vertex", "", 1, layout.refinement_vertex},
                                   {"position", "1", 3, std::move(position)},
                                   {"conformal", "1", 2, std::move(conformal)}};
    const RefinedField refined(stored.refinement, source.item().item.triangles, vertex_count(source.item()));
    for (const DataArray& field : vertex_fields(source.item())) {
        const auto* values = std::get_if<std::vector<double>>(&field.values);
        if (values == nullptr) continue;  // numbers of things have no values between
        const std::vector<double> on_pieces = refined.on_refinement(*values);
        std::vector<double> on_layout;
        on_layout.reserve(layout.position.size());
        for (const Index v : layout.refinement_vertex) on_layout.push_back(on_pieces[at(v)]);
        data.push_back({field.name, field.unit, 1, std::move(on_layout)});
    }
    return data;
}

/// The pieces as cells of layout vertices.
void add_pieces(const ItemSource& source, GeometryBlock& block) {
    const StoredLayout& stored = source.layout();
    block.corners = stored.layout.corner_vertex;
    block.first = stored.refinement.first;
    block.cell_data = {{"input_face", "", 1, stored.refinement.input_face},
                       {"final_face", "", 1, stored.refinement.final_face}};
    if (const ResultGroup* quality = result_of(source.item(), "quality")) {
        const StoredArrays arrays(*quality);
        block.cell_data.push_back(
            {"distortion", "1", 1, arrays.list<double>("distortion", stored.refinement.input_face.size())});
        // One number per corner, in the order of the cells' corners.
        block.field_data.push_back(
            {"corner_angle_ratio", "1", 1, arrays.list<double>("angles/ratio", block.corners.size())});
        block.field_data.push_back(
            {"corner_angle_kind", "", 1, arrays.list<std::uint8_t>("angles/kind", block.corners.size())});
    }
    for (const DataArray& field : face_fields(source.item())) {
        const auto* values = std::get_if<std::vector<double>>(&field.values);
        if (values == nullptr || field.components != 1) continue;
        std::vector<double> on_pieces;
        for (const Index f : stored.refinement.input_face) on_pieces.push_back((*values)[at(f)]);
        block.cell_data.push_back({field.name, field.unit, 1, std::move(on_pieces)});
    }
    block.point_data = layout_vertex_data(source);
    block.texture = "uv";
}

/// Deck transformations as (Re a, Im a, Re b, Im b). // 4 each
std::vector<double> elements(std::span<const Isometry<double>> copies) {
    std::vector<double> values;
    for (const Isometry<double>& x : copies) values.insert(values.end(), {x.a.re, x.a.im, x.b.re, x.b.im});
    return values;
}

/// Class of every copy, such that neighbours differ.
std::vector<std::int32_t> classes_of(const StoredLayout& stored) {
    const auto colours =
        copy_colours(neighbours_of_copies(stored.layout, stored.copies), kCategoryColours.size());
    return {colours.begin(), colours.end()};
}

}  // namespace

GeometryBlock cut_surface(const ItemSource& source) {
    const StoredLayout& stored = source.layout();
    GeometryBlock block;
    const std::vector<Point>& points = stored.refinement.points;
    for (const Index v : stored.layout.refinement_vertex) {
        if (at(v) >= points.size())
            throw FileError(source.item().item.name + ": layout/: a vertex has no point in space");
        block.points.push_back(points[at(v)]);
    }
    add_pieces(source, block);
    add_normals(block, stored.layout.refinement_vertex);  // as if it were not cut
    return block;
}

GeometryBlock layout(const ItemSource& source) {
    const SurfaceLayout& layout = source.layout().layout;
    GeometryBlock block;
    for (const auto& p : layout.position)
        block.points.push_back(placed(p, source.options().model, layout.kappa));
    add_pieces(source, block);
    if (layout.kappa > 0) add_normals(block, layout.refinement_vertex);
    return block;
}

GeometryBlock domains(const ItemSource& source) {
    const StoredLayout& stored = source.layout();
    const SurfaceLayout& layout = stored.layout;
    const std::size_t pieces = stored.refinement.input_face.size(), vertices = layout.position.size();
    const std::size_t largest = std::max({pieces, vertices, layout.corner_vertex.size() / 3, std::size_t{1}});
    const std::size_t fitting = std::max<std::size_t>(1, source.options().max_cells / largest);
    const std::size_t count = std::min(stored.copies.size(), fitting);
    if (count < stored.copies.size())
        spdlog::warn(
            "{}: {} of {} copies of the domain, which are nearest, are written as polygons "
            "(--max-cells); `outlines` has all",
            source.item().item.name, count, stored.copies.size());
    const std::vector<std::int32_t> classes = classes_of(stored);
    GeometryBlock block;
    block.points.reserve(count * vertices);
    std::vector<std::int32_t> copy, colour, face;
    std::vector<double> uv;
    const std::vector<double> texture = texture_of(layout, source.options().model);
    for (std::size_t k = 0; k < count; ++k) {
        for (const auto& p : layout.position)
            block.points.push_back(
                placed(apply(layout.kappa, stored.copies[k], p), source.options().model, layout.kappa));
        for (const Index v : layout.corner_vertex)
            block.corners.push_back(v + static_cast<Index>(k * vertices));
        const Index start = block.first.back();
        for (std::size_t p = 0; p < pieces; ++p)
            block.first.push_back(start + stored.refinement.first[p + 1]);
        copy.insert(copy.end(), pieces, static_cast<std::int32_t>(k));
        colour.insert(colour.end(), pieces, classes[k]);
        face.insert(face.end(), stored.refinement.input_face.begin(), stored.refinement.input_face.end());
        uv.insert(uv.end(), texture.begin(), texture.end());
    }
    block.cell_data = {{"copy", "", 1, std::move(copy)},
                       {"copy_class", "", 1, std::move(colour)},
                       {"input_face", "", 1, std::move(face)}};
    block.point_data = {{"uv", "1", 2, std::move(uv)}};
    block.texture = "uv";
    block.field_data = {{"copy_element", "1", 4, elements(stored.copies)}};
    return block;
}

GeometryBlock outlines(const ItemSource& source) {
    const StoredLayout& stored = source.layout();
    const SurfaceLayout& layout = stored.layout;
    const LaidOutDomain domain(stored, source.options().model);
    std::vector<Index> outline;
    for (const CutSide& side : stored.cut.sides)
        for (const Index v : domain.side_vertices(side))
            if (outline.empty() || outline.back() != v) outline.push_back(v);
    GeometryBlock block;
    block.kind = CellKind::line;
    std::vector<Point> line(outline.size());
    std::vector<std::int32_t> copy;
    for (std::size_t k = 0; k < stored.copies.size() && outline.size() > 1; ++k) {
        for (std::size_t i = 0; i < outline.size(); ++i)
            line[i] = placed(apply(layout.kappa, stored.copies[k], layout.position[at(outline[i])]),
                             source.options().model, layout.kappa);
        block.add_cell_of(line);
        copy.push_back(static_cast<std::int32_t>(k));
    }
    std::vector<std::int32_t> classes = classes_of(stored);
    classes.resize(copy.size());
    block.cell_data = {
        {"copy", "", 1, std::move(copy)},
        {"copy_class", "", 1, std::move(classes)},
        {"copy_element", "1", 4, elements(std::span(stored.copies).first(block.cell_count()))}};
    return block;
}

}  // namespace ricci::app::blocks
