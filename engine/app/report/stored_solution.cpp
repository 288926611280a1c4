#include "engine/app/report/stored_solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/app/solve_options.h"

namespace ricci::app {
namespace {

/// Area of the final faces, of the surface itself where they are those of its double.
double area_of(const CommonRefinement& refinement) {
    const FinalMetric<double> metric = make_final_metric(0, refinement);
    double area = 0.0;
    for (std::size_t h = 0; h + 2 < metric.half_chord.size(); h += 3) {
        std::array<double, 3> l{2 * metric.half_chord[h], 2 * metric.half_chord[h + 1],
                                2 * metric.half_chord[h + 2]};
        std::sort(l.begin(), l.end(), std::greater<>());
        const double product =
            (l[0] + (l[1] + l[2])) * (l[2] - (l[0] - l[1])) * (l[2] + (l[0] - l[1])) * (l[0] + (l[1] - l[2]));
        area += 0.25 * std::sqrt(std::max(0.0, product));
    }
    return refinement.doubled ? 0.5 * area : area;
}

}  // namespace

FlowResult flow_result_of(const FlowRecord& flow) {
    FlowResult result;
    const std::optional<Geometry> geometry = parse_geometry(flow.geometry);
    if (!geometry) throw FileError(fmt::format("{}/flow: geometry is '{}'", flow.item, flow.geometry));
    result.geometry = *geometry;
    result.boundary = parse_boundary(flow.boundary);
    result.outcome.status = static_cast<Status>(flow.status);
    result.precision_digits = flow.precision_digits;
    result.conformal_factor = flow.conformal_factor;
    result.conformal_factor_low = flow.conformal_factor_low;
    result.target_curvature = flow.target_curvature;
    result.curvature = flow.curvature;
    result.doubled = flow.doubled;
    result.triangulation.twin = flow.twin;
    result.edge_length = flow.edge_length;
    if (parse_scheme(flow.scheme) != Scheme::vertex_scaling) result.packing.emplace();
    return result;
}

FlowResult cone_result_of(const SurfaceMesh& mesh, const KeptFactor& kept, const StoredSettings& settings) {
    FlowResult result;
    result.geometry = Geometry::euclidean;
    result.boundary = settings.boundary;
    result.outcome.status = Status::converged;
    result.conformal_factor = kept.conformal_factor;
    result.target_curvature.assign(kept.conformal_factor.size(), 0.0);
    result.target_curvature[static_cast<std::size_t>(kept.vertex)] = settings.cone_curvature.value_or(
        2.0 * std::numbers::pi * topology_of(mesh.connectivity).euler_characteristic);
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity);
    const bool bordered = std::find(boundary.begin(), boundary.end(), 1) != boundary.end();
    result.doubled = bordered && settings.boundary == Boundary::geodesic;
    result.area =
        area_of(make_common_refinement(mesh, result.conformal_factor, result.doubled, settings.delaunay));
    return result;
}

ConformalityReport quality_of(const SurfaceMesh& mesh, const FlowResult& flow, bool delaunay) {
    const int kappa = curvature_sign(flow.geometry);
    const CommonRefinement refinement = refinement_of_flow(mesh, flow, delaunay, 0.0);
    return measure_conformality(mesh, refinement, make_final_metric(kappa, refinement));
}

}  // namespace ricci::app
