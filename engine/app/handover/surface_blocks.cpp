// The surface in space, its cones, and the charts of its atlas.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/app/handover/blocks.h"
#include "engine/app/records.h"
#include "engine/app/result_values.h"
#include "engine/app/stored_arrays.h"
#include "io/exchange/vertex_normals.h"

namespace ricci::app::blocks {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

GeometryBlock surface(const ItemSource& source) {
    const StoredItem& stored = source.item();
    GeometryBlock block;
    block.points = stored.item.points;
    for (const Triangle& triangle : stored.item.triangles) block.add_cell(triangle);
    block.point_data = vertex_fields(stored);
    block.cell_data = face_fields(stored);
    add_normals(block, {});
    block.field_data.push_back({"length_unit", "", 1, std::vector<std::string>{length_unit(stored)}});
    return block;
}

std::vector<Cone> find_cones(const StoredItem& stored) {
    std::vector<Cone> cones;
    if (stored.flow) {
        // Vertices that stand out from a target that is zero elsewhere, boundaries aside: their corners
        // are none.
        const std::vector<double>& target = stored.flow->target_curvature;
        std::vector<std::uint8_t> excluded(target.size(), 0);
        if (stored.item.boundaries > 0) excluded = boundary_vertices(surface_of(stored.item).connectivity);
        constexpr double kSmallest = 1e-9;
        for (std::size_t v = 0; v < target.size(); ++v)
            if (std::abs(target[v]) > kSmallest && !excluded[v])
                cones.push_back({fmt::format("cone at {}", v), static_cast<Index>(v), target[v]});
        if (2 * cones.size() > target.size()) cones.clear();  // a target such as `uniform`
    }
    if (!stored.sweep) return cones;
    const double curvature = 2.0 * std::numbers::pi * stored.item.euler_characteristic;
    if (stored.sweep->best) cones.push_back({"best", *stored.sweep->best, curvature});
    if (stored.sweep->worst && stored.sweep->worst != stored.sweep->best)
        cones.push_back({"worst", *stored.sweep->worst, curvature});
    return cones;
}

GeometryBlock cones(const ItemSource& source) {
    GeometryBlock block;
    block.kind = CellKind::point;
    std::vector<std::string> name;
    std::vector<std::int32_t> vertex;
    std::vector<double> curvature;
    for (const Cone& cone : find_cones(source.item())) {
        const Point& point = source.item().item.points.at(at(cone.vertex));
        block.add_cell_of(std::span(&point, 1));
        name.push_back(cone.name);
        vertex.push_back(cone.vertex);
        curvature.push_back(cone.curvature);
    }
    block.cell_data = {{"name", "", 1, std::move(name)},
                       {"vertex", "", 1, std::move(vertex)},
                       {"cone_curvature", "rad", 1, std::move(curvature)}};
    return block;
}

GeometryBlock samples(const ItemSource& source) {
    const StoredItem& stored = source.item();
    const std::vector<SweepRow>& rows = stored.sweep->rows;
    GeometryBlock block;
    block.kind = CellKind::point;
    std::vector<std::int32_t> vertex;
    for (const SweepRow& row : rows) {
        block.add_cell_of(std::span(&stored.item.points.at(at(row.vertex)), 1));
        vertex.push_back(row.vertex);
    }
    block.point_data = {{"vertex", "", 1, vertex}};
    for (const DataArray& field : vertex_fields(stored))
        std::visit(
            [&]<class T>(const std::vector<T>& values) {
                std::vector<T> picked;
                for (const Index v : vertex) picked.push_back(values[at(v)]);
                block.point_data.push_back({field.name, field.unit, 1, std::move(picked)});
            },
            field.values);
    return block;
}

GeometryBlock charts(const ItemSource& source) {
    const StoredItem& stored = source.item();
    const StoredArrays arrays(*result_of(stored, "atlas"));
    const auto faces = arrays.lists("charts/face"), vertices = arrays.lists("charts/vertex");
    std::size_t entries = 0;
    for (const auto& list : vertices) entries += list.size();
    const auto& coordinates = arrays.list<double>("charts/point");
    arrays.require(faces.size() == vertices.size() && entries > 0 && coordinates.size() % entries == 0,
                   "charts do not fit together");
    const std::size_t dimension = coordinates.size() / entries;
    arrays.require(dimension == 2 || dimension == 3,
                   "coordinates of charts have neither two nor three numbers");
    GeometryBlock block;
    std::vector<std::int32_t> chart, face_number, vertex_number;
    std::vector<Index> place(vertex_count(stored), -1);
    for (std::size_t k = 0, entry = 0; k < vertices.size(); ++k) {
        for (const Index v : vertices[k]) {
            arrays.require(v >= 0 && at(v) < place.size(), "a chart has a vertex that does not exist");
            place[at(v)] = static_cast<Index>(block.points.size());
            const double* x = &coordinates[dimension * entry++];
            block.points.push_back({x[0], x[1], dimension == 3 ? x[2] : 0.0});
            vertex_number.push_back(v);
        }
        for (const Index f : faces[k]) {
            arrays.require(f >= 0 && at(f) < stored.item.triangles.size(),
                           "a chart has a face that does not exist");
            std::array<Index, 3> corners{};
            for (std::size_t i = 0; i < 3; ++i) corners[i] = place[at(stored.item.triangles[at(f)][i])];
            arrays.require(std::all_of(corners.begin(), corners.end(), [](Index p) { return p >= 0; }),
                           "a chart lacks a vertex of one of its faces");
            block.add_cell(corners);
            chart.push_back(static_cast<std::int32_t>(k));
            face_number.push_back(f);
        }
        for (const Index v : vertices[k]) place[at(v)] = -1;
    }
    block.point_data = {{"vertex", "", 1, std::move(vertex_number)}};
    block.cell_data = {{"chart", "", 1, std::move(chart)}, {"input_face", "", 1, std::move(face_number)}};
    return block;
}

}  // namespace ricci::app::blocks
