#include "engine/app/layout_record.h"

#include <algorithm>

#include "engine/app/console.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

template <class T, std::size_t n>
std::vector<T> flattened(const std::vector<std::array<T, n>>& rows) {
    std::vector<T> values;
    values.reserve(rows.size() * n);
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    return values;
}

/// Adds arrays of the shapes that occur.
class Arrays {
  public:
    explicit Arrays(ResultGroup& group) : group_(&group) {}

    template <class T>
    void list(const std::string& path, std::vector<T> values) {
        const auto size = static_cast<std::uint64_t>(values.size());
        group_->arrays.push_back({path, {size}, std::move(values)});
    }
    template <class T, std::size_t n>
    void rows(const std::string& path, const std::vector<std::array<T, n>>& values) {
        group_->arrays.push_back({path, {values.size(), n}, flattened(values)});
    }
    /// Isometries as (Re a, Im a, Re b, Im b).
    void isometries(const std::string& path, const std::vector<Isometry<double>>& values) {
        std::vector<std::array<double, 4>> entries;
        for (const auto& x : values) entries.push_back({x.a.re, x.a.im, x.b.re, x.b.im});
        rows(path, entries);
    }
    /// Lists of different lengths, one after another: <path> and <path>_first.
    void lists(const std::string& path, const std::vector<std::vector<Index>>& values) {
        std::vector<Index> all, first{0};
        for (const auto& one : values) {
            all.insert(all.end(), one.begin(), one.end());
            first.push_back(static_cast<Index>(all.size()));
        }
        list(path, std::move(all));
        list(path + "_first", std::move(first));
    }

  private:
    ResultGroup* group_;
};

void add_refinement(Arrays& arrays, const CommonRefinement& r) {
    const IntrinsicTriangulation<long double>& last = r.final_triangulation;
    arrays.list("final/tail", last.connectivity.tail);
    arrays.list("final/twin", last.connectivity.twin);
    std::vector<double> log_chord(last.log_chord.begin(), last.log_chord.end());
    arrays.list("final/log_chord", std::move(log_chord));
    arrays.list("final/conformal_factor", r.u);
    if (!r.points.empty()) arrays.rows("refinement/points", r.points);
    arrays.list("refinement/first", r.first);
    arrays.list("refinement/input_face", r.input_face);
    arrays.list("refinement/final_face", r.final_face);
    arrays.list("refinement/vertex", r.vertex);
    arrays.list("refinement/twin", r.twin);
    arrays.list("refinement/input_halfedge", r.input_halfedge);
    arrays.list("refinement/final_halfedge", r.final_halfedge);
    arrays.rows("refinement/weight", r.weight);
    arrays.rows("refinement/flat", r.flat);
}

void add_layout(Arrays& arrays, const SurfaceStructure& s) {
    const SurfaceLayout& layout = s.layout;
    arrays.rows("position", layout.position);
    std::vector<std::array<double, 2>> conformal;
    for (const auto& p : layout.position) conformal.push_back(conformal_point(s.kappa, p));
    arrays.rows("conformal", conformal);
    arrays.list("refinement_vertex", layout.refinement_vertex);
    arrays.list("corner_vertex", layout.corner_vertex);
    arrays.isometries("base_frame", {layout.base_frame});
    std::vector<Isometry<double>> pairing;
    std::vector<Index> paired;
    std::vector<double> spread;
    for (const SidePairing& p : layout.pairings) {
        paired.push_back(p.side);
        pairing.push_back(p.element);
        spread.push_back(p.spread);
    }
    arrays.list("pairings/side", paired);
    arrays.isometries("pairings/element", pairing);
    arrays.list("pairings/spread", spread);
}

void add_topology(Arrays& arrays, const SurfaceMesh& mesh, const SurfaceStructure& s) {
    std::vector<std::string> names;
    std::vector<Index> partner, boundary;
    std::vector<std::vector<Index>> halfedges;
    for (const CutSide& side : s.cut.sides) {
        names.push_back(side.name);
        partner.push_back(side.partner);
        boundary.push_back(side.boundary);
        halfedges.push_back(side.halfedges);
    }
    arrays.list("sides/name", names);
    arrays.list("sides/partner", partner);
    arrays.list("sides/boundary", boundary);
    arrays.lists("sides/halfedge", halfedges);
    std::vector<std::vector<Index>> loops;
    for (Index k = 0; k < s.basis->letters(); ++k) {
        std::vector<Index> path;
        const EdgePath steps = s.basis->loop_path(k);
        for (const Step step : steps) path.push_back(step_tail(mesh.connectivity, step));
        if (!steps.empty()) path.push_back(step_head(mesh.connectivity, steps.back()));
        loops.push_back(std::move(path));
    }
    arrays.list("letters/name", s.basis->letter_names());
    arrays.lists("letters/path", loops);
    arrays.isometries("letters/element", s.group.letters);
}

void add_generators(Arrays& arrays, const SurfaceMesh& mesh, const SurfaceStructure& s) {
    std::vector<std::string> names, words;
    std::vector<Isometry<double>> elements;
    std::vector<std::array<double, 4>> half_plane;
    std::vector<std::array<double, 9>> matrices;
    std::vector<std::vector<Index>> paths;
    const std::vector<std::string> letters = s.basis->letter_names();
    for (const GroupGenerator& g : s.group.generators) {
        names.push_back(g.name);
        words.push_back(to_text(g.word, letters));
        elements.push_back(g.element);
        half_plane.push_back(half_plane_matrix(g.element));
        matrices.push_back(s.kappa == 0 ? plane_matrix(g.element) : projective_matrix(s.kappa, g.element));
        std::vector<Index> path;
        const EdgePath steps = s.basis->walk(g.word);
        for (const Step step : steps) path.push_back(step_tail(mesh.connectivity, step));
        if (!steps.empty()) path.push_back(step_head(mesh.connectivity, steps.back()));
        paths.push_back(std::move(path));
    }
    arrays.list("generators/name", names);
    arrays.list("generators/word", words);
    arrays.lists("generators/path", paths);
    arrays.isometries("generators/element", elements);
    if (s.kappa < 0) arrays.rows("generators/half_plane", half_plane);
    arrays.rows("generators/matrix", matrices);
}

}  // namespace

ResultGroup make_layout_group(const std::string& item, const SurfaceMesh& mesh, const SurfaceStructure& s) {
    ResultGroup group;
    group.item = item;
    group.kind = "layout";
    group.status = static_cast<std::uint8_t>(s.flow.outcome.status);
    group.attributes = {{"geometry", std::string(name_of(s.flow.geometry))}};
    if (!s.refinement) return group;
    const auto number = [](std::int64_t value) { return value; };
    const std::vector<ResultAttribute> more = {
        {"relator_error", s.group.relator_error},
        {"group_digits", static_cast<std::int32_t>(s.group.digits)},
        {"closing_error", s.layout.closing_error},
        {"layout_digits", static_cast<std::int32_t>(s.layout.digits)},
        {"flipped_pieces", number(s.layout.flipped)},
        {"degenerate_pieces", number(s.layout.degenerate)},
        {"unresolved_pieces", number(s.layout.unresolved)},
        {"radius", s.layout.radius},
        {"log_scale", s.log_scale},
        {"base_vertex", static_cast<std::int32_t>(s.basis->base())},
        {"relator", to_text(s.basis->relator(), s.basis->letter_names())},
        {"doubled", static_cast<std::uint8_t>(s.refinement->doubled)}};
    group.attributes.insert(group.attributes.end(), more.begin(), more.end());
    Arrays arrays(group);
    add_refinement(arrays, *s.refinement);
    add_layout(arrays, s);
    add_topology(arrays, mesh, s);
    add_generators(arrays, mesh, s);
    return group;
}

nlohmann::json generator_matrix(int kappa, const Isometry<double>& element) {
    const auto rows = [](const auto& values, std::size_t n) {
        nlohmann::json matrix = nlohmann::json::array();
        for (std::size_t i = 0; i < n; ++i) {
            nlohmann::json row = nlohmann::json::array();
            for (std::size_t j = 0; j < n; ++j) row.push_back(values[n * i + j]);
            matrix.push_back(row);
        }
        return matrix;
    };
    if (kappa < 0) return rows(half_plane_matrix(element), 2);
    return rows(kappa == 0 ? plane_matrix(element) : projective_matrix(kappa, element), 3);
}

nlohmann::json layout_json(const SurfaceStructure& s) {
    nlohmann::json object = {{"geometry", name_of(s.flow.geometry)},
                             {"status", name_of(s.flow.outcome.status)},
                             {"message", s.flow.message},
                             {"residual_max", finite_or_null(s.flow.outcome.residual_max)},
                             {"generators", nlohmann::json::array()},
                             {"relator_error", nullptr},
                             {"closing_error", nullptr},
                             {"flipped_pieces", nullptr}};
    if (!s.refinement) return object;
    const std::vector<std::string> letters = s.basis->letter_names();
    for (const GroupGenerator& g : s.group.generators)
        object["generators"].push_back({{"name", g.name},
                                        {"word", to_text(g.word, letters)},
                                        {"matrix", generator_matrix(s.kappa, g.element)}});
    object["letters"] = letters;
    object["relator"] = to_text(s.basis->relator(), letters);
    object["relator_error"] = finite_or_null(s.group.relator_error);
    object["group_digits"] = s.group.digits;
    object["closing_error"] = finite_or_null(s.layout.closing_error);
    object["layout_digits"] = s.layout.digits;
    object["flipped_pieces"] = s.layout.flipped;
    object["degenerate_pieces"] = s.layout.degenerate;
    object["unresolved_pieces"] = s.layout.unresolved;
    object["pieces"] = s.refinement->piece_count();
    object["radius"] = finite_or_null(s.layout.radius);
    object["base_vertex"] = s.basis->base();
    object["sides"] = s.cut.sides.size();
    object["stage_seconds"] = {{"flow", s.seconds.flow},
                               {"refinement", s.seconds.refinement},
                               {"topology", s.seconds.topology},
                               {"group", s.seconds.group},
                               {"layout", s.seconds.layout}};
    return object;
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

TexturedMesh textured_surface(const SurfaceMesh& mesh, const SurfaceStructure& s, LayoutModel model) {
    if (mesh.intrinsic()) throw UsageError("an intrinsic surface has no points in space to write");
    const CommonRefinement& r = *s.refinement;
    TexturedMesh out;
    out.points = r.points;
    const bool disk = s.kappa != 0 && !(s.kappa < 0 && model == LayoutModel::half_plane);
    for (const auto& p : s.layout.position) {
        std::array<double, 2> uv = model_point(model, s.kappa, p);
        if (disk) uv = {(uv[0] + 1) / 2, (uv[1] + 1) / 2};
        out.uv.push_back(uv);
    }
    for (Index c = 0; c < r.corner_count(); ++c)
        out.corners.push_back({r.vertex[at(c)], s.layout.corner_vertex[at(c)]});
    out.face_start = r.first;
    return out;
}

TexturedMesh layout_surface(const SurfaceStructure& s, LayoutModel model) {
    TexturedMesh out;
    for (const auto& p : s.layout.position) {
        const std::array<double, 2> uv = model_point(model, s.kappa, p);
        out.points.push_back(s.kappa > 0 ? Point{p[0], p[1], p[2]} : Point{uv[0], uv[1], 0.0});
        out.uv.push_back(uv);
    }
    for (const Index v : s.layout.corner_vertex) out.corners.push_back({v, v});
    out.face_start = s.refinement->first;
    return out;
}

}  // namespace ricci::app
