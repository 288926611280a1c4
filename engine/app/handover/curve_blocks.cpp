// Sides, generators, geodesics and marking curves as polylines.
#include <algorithm>
#include <map>
#include <utility>

#include "engine/app/handover/blocks.h"
#include "engine/app/pictures/laid_out_domain.h"
#include "engine/app/pictures/side_style.h"
#include "engine/app/result_values.h"
#include "engine/app/stored_arrays.h"

namespace ricci::app::blocks {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

GeometryBlock lines() {
    GeometryBlock block;
    block.kind = CellKind::line;
    return block;
}

Point layout_point(const ItemSource& source, Index layout_vertex) {
    const SurfaceLayout& layout = source.layout().layout;
    const auto& position = layout.position[at(layout_vertex)];
    if (layout.kappa > 0) return position;
    const auto z = model_point(source.options().model, layout.kappa, position);
    return {z[0], z[1], 0.0};
}

/// Points of the mesh by number.
std::vector<Point> mesh_points(const ItemSource& source, const std::vector<Index>& vertices) {
    const std::vector<Point>& points = source.item().item.points;
    std::vector<Point> line;
    for (const Index v : vertices) {
        if (at(v) >= points.size())
            throw FileError(source.item().item.name + ": layout/: a path runs through no vertex of the mesh");
        line.push_back(points[at(v)]);
    }
    return line;
}

/// Name, partner, component and colour of sides: cell data.
struct SideData {
    std::vector<std::string> name;
    std::vector<std::int32_t> side, partner, boundary, pair;

    void add(const CutGraph& graph, const std::vector<int>& pairs, std::size_t s) {
        name.push_back(graph.sides[s].name);
        side.push_back(static_cast<std::int32_t>(s));
        partner.push_back(graph.sides[s].partner);
        boundary.push_back(graph.sides[s].boundary);
        pair.push_back(pairs[s]);
    }
    [[nodiscard]] std::vector<DataArray> arrays() && {
        return {{"name", "", 1, std::move(name)},
                {"side", "", 1, std::move(side)},
                {"partner", "", 1, std::move(partner)},
                {"boundary", "", 1, std::move(boundary)},
                {"pair", "", 1, std::move(pair)}};
    }
};

/// A row of `columns` numbers for every generator, where they are stored.
void add_generator_rows(const StoredArrays& arrays, const std::string& path, const char* name,
                        std::size_t columns, const std::vector<std::size_t>& which, std::size_t count,
                        std::vector<DataArray>& data) {
    if (!arrays.has(path)) return;
    const auto& values = arrays.list<double>(path, columns * count);
    std::vector<double> rows;
    for (const std::size_t k : which)
        rows.insert(rows.end(), values.begin() + static_cast<std::ptrdiff_t>(columns * k),
                    values.begin() + static_cast<std::ptrdiff_t>(columns * (k + 1)));
    data.push_back({name, "1", columns, std::move(rows)});
}

/// Cell data of generators, by the number of the generator of each cell.
std::vector<DataArray> generator_data(const ItemSource& source, const std::vector<std::size_t>& which) {
    const StoredArrays arrays(*result_of(source.item(), "layout"));
    const std::size_t count = source.layout().generators.size();
    const auto& names = arrays.list<std::string>("generators/name", count);
    const auto& words = arrays.list<std::string>("generators/word", count);
    std::vector<std::string> name, word;
    std::vector<std::int32_t> number;
    for (const std::size_t k : which) {
        name.push_back(names[k]);
        word.push_back(words[k]);
        number.push_back(static_cast<std::int32_t>(k));
    }
    std::vector<DataArray> data = {{"name", "", 1, std::move(name)},
                                   {"word", "", 1, std::move(word)},
                                   {"generator", "", 1, std::move(number)}};
    add_generator_rows(arrays, "generators/element", "element", 4, which, count, data);
    add_generator_rows(arrays, "generators/half_plane", "half_plane", 4, which, count, data);
    add_generator_rows(arrays, "generators/matrix", "matrix", 9, which, count, data);
    return data;
}

/// Halfedges of a mesh by the vertices they run between; of several the lowest.
class HalfedgeTable {
  public:
    explicit HalfedgeTable(std::span<const Triangle> triangles) {
        for (std::size_t f = 0; f < triangles.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k)
                table_.emplace(std::pair(triangles[f][k], triangles[f][(k + 1) % 3]),
                               static_cast<Index>(3 * f + k));
    }
    [[nodiscard]] Index find(Index from, Index to) const {
        const auto found = table_.find({from, to});
        return found == table_.end() ? -1 : found->second;
    }

  private:
    std::map<std::pair<Index, Index>, Index> table_;
};

/// Curves of a group that were drawn on the mesh, with their numbers, lengths and words.
GeometryBlock drawn_curves(const ItemSource& source, const std::string& kind, const std::string& subgroup,
                           const char* number) {
    const StoredArrays arrays(*result_of(source.item(), kind));
    const auto& lengths = arrays.list<double>(subgroup + "/length");
    const auto& words = arrays.list<std::string>(subgroup + "/word", lengths.size());
    const auto points = arrays.polylines(subgroup + "/points", lengths.size());
    std::vector<std::string> name, word;
    std::vector<double> length;
    std::vector<std::int32_t> which, boundary;
    GeometryBlock block = lines();
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (points[k].size() < 2) continue;
        block.add_cell_of(points[k]);
        name.push_back(arrays.has(subgroup + "/name")
                           ? arrays.list<std::string>(subgroup + "/name", lengths.size())[k]
                           : "g" + std::to_string(k));
        word.push_back(words[k]);
        length.push_back(lengths[k]);
        which.push_back(static_cast<std::int32_t>(k));
        if (arrays.has(subgroup + "/boundary"))
            boundary.push_back(arrays.list<Index>(subgroup + "/boundary", lengths.size())[k]);
    }
    block.cell_data = {{"name", "", 1, std::move(name)},
                       {"word", "", 1, std::move(word)},
                       {"length", "1", 1, std::move(length)},
                       {number, "", 1, std::move(which)}};
    if (!boundary.empty()) block.cell_data.push_back({"boundary", "", 1, std::move(boundary)});
    return block;
}

}  // namespace

bool has_drawn(const ItemSource& source, const std::string& kind, const std::string& subgroup) {
    const ResultGroup* group = result_of(source.item(), kind);
    return group != nullptr && !source.intrinsic() && StoredArrays(*group).has(subgroup + "/points");
}

GeometryBlock sides(const ItemSource& source) {
    const StoredLayout& stored = source.layout();
    const LaidOutDomain domain(stored, source.options().model);
    const std::vector<int> pairs = pair_numbers(stored.cut);
    GeometryBlock block = lines();
    SideData data;
    std::vector<std::int32_t> layout_vertex;
    for (std::size_t s = 0; s < stored.cut.sides.size(); ++s) {
        const std::vector<Index> vertices = domain.side_vertices(stored.cut.sides[s]);
        if (vertices.size() < 2) continue;
        std::vector<Point> line;
        for (const Index v : vertices) line.push_back(layout_point(source, v));
        block.add_cell_of(line);
        layout_vertex.insert(layout_vertex.end(), vertices.begin(), vertices.end());
        data.add(stored.cut, pairs, s);
    }
    block.point_data = {{"layout_vertex", "", 1, std::move(layout_vertex)}};
    block.cell_data = std::move(data).arrays();
    const StoredArrays arrays(*result_of(source.item(), "layout"));
    const auto& paired = arrays.list<Index>("pairings/side");
    block.field_data = {
        {"pairing_side", "", 1, paired},
        {"pairing_element", "1", 4, arrays.list<double>("pairings/element", 4 * paired.size())}};
    return block;
}

GeometryBlock cut(const ItemSource& source) {
    const CutGraph& graph = source.layout().cut;
    const std::vector<Triangle>& triangles = source.item().item.triangles;
    const std::vector<int> pairs = pair_numbers(graph);
    GeometryBlock block = lines();
    SideData data;
    for (std::size_t s = 0; s < graph.sides.size(); ++s) {
        const CutSide& side = graph.sides[s];
        const bool second = side.partner >= 0 && at(side.partner) < s;
        if (second || side.halfedges.empty()) continue;  // two sides are one line on the surface
        std::vector<Index> vertices;
        for (const Index h : side.halfedges) vertices.push_back(triangles[at(h / 3)][at(h % 3)]);
        const Index last = side.halfedges.back();
        vertices.push_back(triangles[at(last / 3)][at((last + 1) % 3)]);
        block.add_cell_of(mesh_points(source, vertices));
        data.add(graph, pairs, s);
    }
    block.cell_data = std::move(data).arrays();
    return block;
}

GeometryBlock generators(const ItemSource& source) {
    GeometryBlock block = lines();
    std::vector<std::size_t> which;
    const auto& paths = source.layout().generators;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        if (paths[k].size() < 2) continue;
        block.add_cell_of(mesh_points(source, paths[k]));
        which.push_back(k);
    }
    block.cell_data = generator_data(source, which);
    return block;
}

GeometryBlock layout_generators(const ItemSource& source) {
    const StoredLayout& stored = source.layout();
    const LaidOutDomain domain(stored, source.options().model);
    const HalfedgeTable halfedges(source.item().item.triangles);
    GeometryBlock block = lines();
    std::vector<std::size_t> which;
    for (std::size_t k = 0; k < stored.generators.size(); ++k) {
        const std::vector<Index>& path = stored.generators[k];
        std::vector<Index> run;
        const auto close_run = [&] {
            std::vector<Point> line;
            for (const Index v : run) line.push_back(layout_point(source, v));
            if (line.size() > 1) {
                block.add_cell_of(line);
                which.push_back(k);
            }
            run.clear();
        };
        for (std::size_t i = 0; i + 1 < path.size(); ++i) {
            // On the boundary only one of the two directions has a face.
            std::vector<Index> along = domain.halfedge_vertices(halfedges.find(path[i], path[i + 1]));
            if (along.empty()) {
                along = domain.halfedge_vertices(halfedges.find(path[i + 1], path[i]));
                std::reverse(along.begin(), along.end());
            }
            if (!run.empty() && (along.empty() || run.back() != along.front())) close_run();
            if (along.empty()) continue;
            run.insert(run.end(), along.begin() + (run.empty() ? 0 : 1), along.end());
        }
        close_run();
    }
    block.cell_data = generator_data(source, which);
    return block;
}

GeometryBlock geodesics(const ItemSource& source) {
    // Which powers of them make the spectrum is field data of every block of the item (spectrum_...).
    return drawn_curves(source, "spectrum", "geodesics", "geodesic");
}

GeometryBlock curves(const ItemSource& source) {
    return drawn_curves(source, "teichmuller", "curves", "curve");
}

GeometryBlock loops(const ItemSource& source) {
    return drawn_curves(source, "teichmuller", "loops", "loop");
}

}  // namespace ricci::app::blocks
