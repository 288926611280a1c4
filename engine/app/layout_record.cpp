#include "engine/app/layout_record.h"

#include "engine/app/accuracy_record.h"
#include "engine/app/console.h"
#include "engine/app/result_arrays.h"

namespace ricci::app {
namespace {

void add_refinement(ResultArrays& arrays, const CommonRefinement& r) {
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

void add_layout(ResultArrays& arrays, const SurfaceStructure& s) {
    const SurfaceLayout& layout = s.layout;
    arrays.rows("position", layout.position);
    arrays.isometries("frame", layout.frame);
    std::vector<std::array<double, 2>> conformal;
    conformal.reserve(layout.position.size());
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

void add_topology(ResultArrays& arrays, const SurfaceMesh& mesh, const SurfaceStructure& s) {
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
    loops.reserve(static_cast<std::size_t>(s.basis->letters()));
    for (Index k = 0; k < s.basis->letters(); ++k)
        loops.push_back(vertices_of(mesh.connectivity, s.basis->loop_path(k)));
    arrays.list("letters/name", s.basis->letter_names());
    arrays.lists("letters/path", loops);
    arrays.isometries("letters/element", s.group.letters);
}

void add_generators(ResultArrays& arrays, const SurfaceMesh& mesh, const SurfaceStructure& s) {
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
        paths.push_back(vertices_of(mesh.connectivity, s.basis->walk(g.word)));
    }
    arrays.list("generators/name", names);
    arrays.list("generators/word", words);
    arrays.lists("generators/path", paths);
    arrays.isometries("generators/element", elements);
    if (s.kappa < 0) arrays.matrices("generators/half_plane", 2, half_plane);
    arrays.matrices("generators/matrix", 3, matrices);
}

}  // namespace

ResultGroup make_layout_group(const std::string& item, const SurfaceMesh& mesh, const SurfaceStructure& s,
                              const std::vector<Isometry<double>>& copies) {
    ResultGroup group;
    group.item = item;
    group.kind = "layout";
    group.status = static_cast<std::uint8_t>(s.flow.outcome.status);
    group.attributes = {{"geometry", std::string(name_of(s.flow.geometry))}};
    add_accuracy(accuracy_of(s.flow), group);
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
    ResultArrays arrays(group);
    add_refinement(arrays, *s.refinement);
    add_layout(arrays, s);
    add_topology(arrays, mesh, s);
    add_generators(arrays, mesh, s);
    if (!copies.empty()) arrays.isometries("copies/element", copies);
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
                             {"generators", nlohmann::json::array()},
                             {"relator_error", nullptr},
                             {"closing_error", nullptr},
                             {"flipped_pieces", nullptr}};
    add_accuracy(accuracy_of(s.flow), object);
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

}  // namespace ricci::app
