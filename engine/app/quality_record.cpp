#include "engine/app/quality_record.h"

#include <fmt/format.h>

#include "engine/app/console.h"
#include "engine/app/result_arrays.h"

namespace ricci::app {
namespace {

nlohmann::json distribution_json(const Distribution& d) {
    nlohmann::json quantiles = nlohmann::json::object();
    for (std::size_t k = 0; k < kQuantileLevels.size(); ++k)
        quantiles[fmt::format("{}", kQuantileLevels[k])] = finite_or_null(d.quantile[k]);
    return {{"count", d.count},
            {"mean", finite_or_null(d.mean)},
            {"min", finite_or_null(d.min)},
            {"max", finite_or_null(d.max)},
            {"quantiles", quantiles}};
}

nlohmann::json angle_json(const AngleRatios& angles) {
    const auto summary = [](const AngleSummary& s) {
        return nlohmann::json{{"ratio", distribution_json(s.ratio)},
                              {"within_1_percent", s.within_1},
                              {"within_5_percent", s.within_5},
                              {"area_within_1_percent", s.area_within_1},
                              {"area_within_5_percent", s.area_within_5}};
    };
    return {{"regular", summary(angles.regular)},
            {"curved", summary(angles.curved)},
            {"unresolved", angles.unresolved}};
}

std::vector<std::uint8_t> bytes_of(const std::vector<CornerKind>& kinds) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(kinds.size());
    for (const CornerKind kind : kinds) bytes.push_back(static_cast<std::uint8_t>(kind));
    return bytes;
}

}  // namespace

ResultGroup make_quality_group(const std::string& item, std::uint8_t status,
                               const ConformalityReport& report) {
    ResultGroup group;
    group.item = item;
    group.kind = "quality";
    group.status = status;
    group.attributes = {{"angles_within_5_percent", report.pieces.regular.within_5},
                        {"face_angles_within_5_percent", report.faces.regular.within_5},
                        {"distortion_mean", report.distortion_by_area.mean},
                        {"area_distortion", report.area_distortion},
                        {"total_image_area", report.total_image_area},
                        {"corner_kinds", std::vector<std::string>{"regular", "curved", "unresolved"}}};
    ResultArrays arrays(group);
    arrays.list("angles/ratio", report.pieces.ratio);
    arrays.list("angles/kind", bytes_of(report.pieces.kind));
    arrays.list("face_angles/ratio", report.faces.ratio);
    arrays.list("face_angles/kind", bytes_of(report.faces.kind));
    arrays.list("distortion", report.distortion);
    arrays.list("image_area", report.image_area);
    arrays.list("log_area_ratio", report.log_area_ratio);
    return group;
}

ResultGroup make_atlas_group(const std::string& item, std::uint8_t status, const Atlas& atlas,
                             const AtlasChecks& checks) {
    ResultGroup group;
    group.item = item;
    group.kind = "atlas";
    group.status = status;
    group.attributes = {{"kind", std::string(name_of(atlas.kind))},
                        {"vertex_disagreement", checks.vertex_disagreement},
                        {"edge_disagreement", checks.edge_disagreement},
                        {"cocycle_error", checks.cocycle_error},
                        {"triple_overlaps", checks.triples},
                        {"form_error", checks.form_error},
                        {"circle_error", checks.circle_error},
                        {"uncovered_vertices", static_cast<std::int32_t>(checks.uncovered_vertices)}};
    std::vector<Index> seeds, to, from;
    std::vector<std::vector<Index>> faces, vertices, pieces, overlaps;
    std::vector<std::uint8_t> inside;
    std::vector<double> points;
    for (const Chart& chart : atlas.charts) {
        seeds.push_back(chart.seed_face);
        faces.push_back(chart.faces);
        vertices.push_back(chart.vertices);
        pieces.push_back(chart.pieces);
        inside.insert(inside.end(), chart.inside.begin(), chart.inside.end());
        points.insert(points.end(), chart.point.begin(), chart.point.end());
    }
    std::vector<Isometry<double>> maps;
    std::vector<std::array<double, 9>> matrices;
    for (const Transition& t : atlas.transitions) {
        to.push_back(t.to);
        from.push_back(t.from);
        overlaps.push_back(t.pieces);
        maps.push_back(t.map);
        matrices.push_back(t.matrix);
    }
    ResultArrays arrays(group);
    arrays.list("charts/seed_face", seeds);
    arrays.lists("charts/face", faces);
    arrays.lists("charts/vertex", vertices);
    arrays.lists("charts/piece", pieces);
    arrays.list("charts/inside", inside);
    const auto dimension = static_cast<std::uint64_t>(atlas.dimension);
    group.arrays.push_back({"charts/point", {points.size() / dimension, dimension}, points});
    arrays.list("transitions/to", to);
    arrays.list("transitions/from", from);
    arrays.lists("transitions/piece", overlaps);
    arrays.isometries("transitions/map", maps);
    arrays.matrices("transitions/matrix", 3, matrices);
    return group;
}

nlohmann::json quality_json(const ConformalityReport& report) {
    return {{"angles", angle_json(report.pieces)},
            {"face_angles", angle_json(report.faces)},
            {"distortion", distribution_json(report.distortion_by_area)},
            {"log_area_ratio", distribution_json(report.log_area)},
            {"area_distortion", finite_or_null(report.area_distortion)},
            {"total_image_area", finite_or_null(report.total_image_area)},
            {"degenerate_pieces", report.degenerate},
            {"flipped_pieces", report.flipped}};
}

nlohmann::json atlas_json(const Atlas& atlas, const AtlasChecks& checks) {
    return {{"kind", name_of(atlas.kind)},
            {"charts", atlas.charts.size()},
            {"transitions", atlas.transitions.size()},
            {"vertex_disagreement", checks.vertex_disagreement},
            {"edge_disagreement", checks.edge_disagreement},
            {"cocycle_error", checks.cocycle_error},
            {"triple_overlaps", checks.triples},
            {"form_error", checks.form_error},
            {"circle_error", checks.circle_error},
            {"uncovered_vertices", checks.uncovered_vertices}};
}

AtlasKind parse_atlas_kind(const std::string& text, int kappa) {
    if (text == "auto")
        return kappa == 0 ? AtlasKind::affine : (kappa < 0 ? AtlasKind::hyperbolic : AtlasKind::spherical);
    for (const AtlasKind kind :
         {AtlasKind::affine, AtlasKind::hyperbolic, AtlasKind::projective, AtlasKind::spherical})
        if (text == name_of(kind)) return kind;
    throw UsageError("unknown atlas '" + text + "' (known: auto, affine, hyperbolic, projective, spherical)");
}

}  // namespace ricci::app
