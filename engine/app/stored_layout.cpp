#include "engine/app/stored_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/app/console.h"
#include "engine/app/stored_arrays.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Whether all lie in low ... limit - 1.
bool all_in(const std::vector<Index>& values, Index low, std::size_t limit) {
    return std::all_of(values.begin(), values.end(),
                       [&](Index v) { return v >= low && (v < 0 || at(v) < limit); });
}

/// What can be drawn and multiplied without leaving the range of double.
template <std::size_t n>
bool all_moderate(const std::vector<std::array<double, n>>& rows) {
    constexpr double kLargest = 1e150;
    return std::all_of(rows.begin(), rows.end(), [](const auto& row) {
        return std::all_of(row.begin(), row.end(), [](double x) { return std::abs(x) <= kLargest; });
    });
}

void require_pieces(const StoredArrays& arrays, const CommonRefinement& r, std::size_t faces) {
    const std::size_t corners = r.vertex.size();
    arrays.require(r.first.size() == r.input_face.size() + 1 && r.final_face.size() == r.input_face.size() &&
                       r.first.front() == 0 && at(r.first.back()) == corners &&
                       std::is_sorted(r.first.begin(), r.first.end()),
                   "pieces do not fit their corners");
    arrays.require(std::adjacent_find(r.first.begin(), r.first.end()) == r.first.end(),
                   "a piece has no corners");
    arrays.require(r.twin.size() == corners && r.input_halfedge.size() == corners &&
                       r.final_halfedge.size() == corners && r.weight.size() == corners &&
                       r.flat.size() == corners,
                   "corners have arrays of different lengths");
    constexpr std::size_t kNoLimit =
        std::numeric_limits<Index>::max();  // intrinsic surfaces list no vertices
    const std::size_t vertices = r.points.empty() ? kNoLimit : r.points.size();
    arrays.require(all_in(r.twin, -1, corners) && all_in(r.vertex, 0, vertices) &&
                       all_in(r.input_face, 0, faces) && all_in(r.input_halfedge, -1, 3 * faces),
                   "a corner names something that does not exist");
    arrays.require(all_moderate(r.points), "a point is not finite, or beyond 1e150");
}

CommonRefinement read_refinement(const StoredArrays& arrays, std::size_t faces) {
    CommonRefinement r;
    if (arrays.has("refinement/points")) r.points = arrays.rows<3>("refinement/points");
    r.first = arrays.list<Index>("refinement/first");
    r.input_face = arrays.list<Index>("refinement/input_face");
    r.final_face = arrays.list<Index>("refinement/final_face");
    r.vertex = arrays.list<Index>("refinement/vertex");
    r.twin = arrays.list<Index>("refinement/twin");
    r.input_halfedge = arrays.list<Index>("refinement/input_halfedge");
    r.final_halfedge = arrays.list<Index>("refinement/final_halfedge");
    r.weight = arrays.rows<3>("refinement/weight");
    r.flat = arrays.rows<2>("refinement/flat");
    require_pieces(arrays, r, faces);
    for (Index p = 0; p < r.piece_count(); ++p)
        r.piece.insert(r.piece.end(), at(r.first[at(p) + 1] - r.first[at(p)]), p);
    for (const Index v : r.vertex) r.vertex_count = std::max(r.vertex_count, v + 1);
    return r;
}

CutGraph read_cut(const StoredArrays& arrays, std::size_t faces) {
    CutGraph cut;
    const auto& name = arrays.list<std::string>("sides/name");
    const auto& partner = arrays.list<Index>("sides/partner");
    const auto& boundary = arrays.list<Index>("sides/boundary");
    std::vector<std::vector<Index>> halfedges = arrays.lists("sides/halfedge");
    arrays.require(
        partner.size() == name.size() && boundary.size() == name.size() && halfedges.size() == name.size(),
        "sides do not fit together");
    arrays.require(all_in(partner, -1, name.size()), "a side is glued to one that does not exist");
    for (const std::vector<Index>& side : halfedges)
        arrays.require(all_in(side, 0, 3 * faces), "a side runs along a halfedge that does not exist");
    for (std::size_t s = 0; s < name.size(); ++s)
        cut.sides.push_back({name[s], partner[s], boundary[s], std::move(halfedges[s])});
    return cut;
}

}  // namespace

StoredLayout read_layout_group(const ResultGroup& group, std::size_t faces) {
    const StoredArrays arrays(group);
    StoredLayout stored;
    stored.refinement = read_refinement(arrays, faces);
    stored.cut = read_cut(arrays, faces);
    SurfaceLayout& layout = stored.layout;
    if (const auto* geometry = find_attribute<std::string>(group, "geometry"))
        layout.kappa = *geometry == "hyperbolic" ? -1 : (*geometry == "spherical" ? 1 : 0);
    layout.position = arrays.rows<3>("position");
    layout.refinement_vertex = arrays.list<Index>("refinement_vertex");
    layout.corner_vertex = arrays.list<Index>("corner_vertex");
    layout.frame = arrays.isometries("frame");
    const auto base = arrays.isometries("base_frame");
    const auto& side = arrays.list<Index>("pairings/side");
    const auto element = arrays.isometries("pairings/element");
    const auto& spread = arrays.list<double>("pairings/spread");
    arrays.require(!base.empty() && element.size() == side.size() && spread.size() == side.size() &&
                       layout.frame.size() == stored.refinement.input_face.size() &&
                       layout.corner_vertex.size() == stored.refinement.vertex.size() &&
                       layout.refinement_vertex.size() == layout.position.size(),
                   "layout arrays differ in length");
    const auto vertices = at(stored.refinement.vertex_count);
    arrays.require(all_in(layout.corner_vertex, 0, layout.position.size()) &&
                       all_in(layout.refinement_vertex, 0, vertices) &&
                       all_in(side, 0, stored.cut.sides.size()),
                   "a corner, vertex or pairing names something that does not exist");
    arrays.require(all_moderate(layout.position), "a position is not finite, or beyond 1e150");
    layout.base_frame = base.front();
    for (std::size_t k = 0; k < side.size(); ++k) layout.pairings.push_back({side[k], element[k], spread[k]});
    stored.generators = arrays.lists("generators/path");
    for (const std::vector<Index>& loop : stored.generators)
        arrays.require(all_in(loop, 0, vertices), "a generator runs through a vertex that does not exist");
    if (arrays.has("copies/element")) stored.copies = arrays.isometries("copies/element");
    return stored;
}

StoredLayout stored_layout_of(const SurfaceMesh& mesh, const SurfaceStructure& s) {
    StoredLayout stored;
    stored.refinement = *s.refinement;
    stored.layout = s.layout;
    stored.cut = s.cut;
    for (const GroupGenerator& g : s.group.generators)
        stored.generators.push_back(vertices_of(mesh.connectivity, s.basis->walk(g.word)));
    return stored;
}

LayoutModel parse_layout_model(const std::string& text) {
    if (text == "auto" || text == "poincare" || text == "plane" || text == "disk" || text == "sphere")
        return LayoutModel::conformal;
    if (text == "klein") return LayoutModel::klein;
    if (text == "half-plane") return LayoutModel::half_plane;
    throw UsageError("unknown model '" + text +
                     "' (known: auto, plane, poincare, klein, half-plane, disk, sphere)");
}

std::array<double, 2> model_point(LayoutModel model, int kappa, const std::array<double, 3>& position) {
    if (kappa < 0 && model == LayoutModel::klein) return projective_point(position);
    if (kappa < 0 && model == LayoutModel::half_plane) return half_plane_point(position);
    return conformal_point(kappa, position);
}

namespace {

std::array<double, 2> finite_or_origin(const std::array<double, 2>& uv) {
    return std::isfinite(uv[0]) && std::isfinite(uv[1]) ? uv : std::array<double, 2>{};
}

}  // namespace

std::vector<std::array<double, 2>> texture_coordinates(const SurfaceLayout& layout, LayoutModel model) {
    const bool disk = layout.kappa != 0 && !(layout.kappa < 0 && model == LayoutModel::half_plane);
    std::vector<std::array<double, 2>> texture;
    texture.reserve(layout.position.size());
    for (const auto& p : layout.position) {
        std::array<double, 2> uv = model_point(model, layout.kappa, p);
        if (disk) uv = {(uv[0] + 1) / 2, (uv[1] + 1) / 2};
        texture.push_back(finite_or_origin(uv));
    }
    return texture;
}

TexturedMesh textured_surface(const CommonRefinement& r, const SurfaceLayout& layout, LayoutModel model) {
    if (r.points.empty()) throw UsageError("an intrinsic surface has no points in space to write");
    TexturedMesh out;
    out.points = r.points;
    out.uv = texture_coordinates(layout, model);
    for (Index c = 0; c < r.corner_count(); ++c)
        out.corners.push_back({r.vertex[at(c)], layout.corner_vertex[at(c)]});
    out.face_start = r.first;
    return out;
}

TexturedMesh layout_surface(const CommonRefinement& r, const SurfaceLayout& layout, LayoutModel model) {
    TexturedMesh out;
    for (const auto& p : layout.position) {
        const std::array<double, 2> uv = model_point(model, layout.kappa, p);
        out.points.push_back(layout.kappa > 0 ? Point{p[0], p[1], p[2]} : Point{uv[0], uv[1], 0.0});
        out.uv.push_back(finite_or_origin(uv));
    }
    for (const Index v : layout.corner_vertex) out.corners.push_back({v, v});
    out.face_start = r.first;
    return out;
}

}  // namespace ricci::app
