#include "engine/flow/flow.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "engine/flow/target.h"
#include "engine/sphere/solve_sphere.h"

namespace ricci {
namespace {

using std::numbers::pi;

Boundary resolve_boundary(const FlowOptions& options) {
    if (options.boundary) return *options.boundary;
    const TargetKind target = options.target.value_or(TargetKind::flat);
    return target == TargetKind::boundary || target == TargetKind::values ? Boundary::curvature
                                                                          : Boundary::geodesic;
}

SolveOptions solve_options(const FlowOptions& options, Geometry geometry) {
    SolveOptions result;
    result.tolerance = options.tolerance;
    result.max_iterations = options.max_iterations > 0 ? options.max_iterations
                                                       : (options.method == Method::newton ? 500 : 100000);
    result.convex = geometry != Geometry::spherical && options.scheme != Scheme::virtual_radius;
    result.interrupted = options.interrupted;
    result.progress = options.progress;
    return result;
}

SolveOutcome run(Metric& metric, const CurvatureTarget& target, const SolveOptions& solve, Method method,
                 Geometry geometry, std::vector<double>& u, std::vector<double>* low = nullptr) {
    if (method == Method::gradient) return gradient_descent(metric, target, solve, u);
    const Definiteness definiteness =
        geometry == Geometry::spherical ? Definiteness::indefinite : Definiteness::positive;
    NewtonSolver newton(metric.surface(), target, definiteness, false);
    return newton.solve(metric, target, solve, u, low);
}

void store(Metric& metric, const CurvatureTarget& target, FlowResult& result) {
    const FlowSurface& surface = metric.surface();
    result.curvature.assign(metric.curvature().begin(), metric.curvature().end());
    result.target_curvature = target.curvature;
    for (std::size_t v = 0; v < result.curvature.size(); ++v)
        if (surface.used[v] && target.unknown[v] < 0) result.target_curvature[v] = result.curvature[v];
    result.area = metric.area();
    const double total = std::accumulate(result.curvature.begin(), result.curvature.end(), 0.0);
    result.gauss_bonnet_error = std::abs(total + curvature_sign(result.geometry) * result.area -
                                         2.0 * pi * surface.topology.euler_characteristic);
    result.doubled = surface.doubled;
    result.triangulation = metric.connectivity();
    result.edge_length = metric.edge_lengths();
}

std::string reason(Status status, Geometry geometry, const FlowOptions& options) {
    switch (status) {
        case Status::converged:
            return {};
        case Status::stalled:
            return geometry == Geometry::spherical
                       ? fmt::format(
                             "the spherical energy is not convex and the direct {} method found no further "
                             "descent",
                             name_of(options.method))
                       : "no step reduces the residual any more: the rounding floor of the evaluation";
        case Status::max_iterations:
            return "the number of iterations ran out";
        case Status::factorization_failed:
            return "the Hessian could not be factorised, shifted or not";
        case Status::inadmissible_metric:
            return fmt::format("the initial {} metric has faces that break the triangle inequality",
                               name_of(options.scheme));
        case Status::not_finite:
            return "a curvature is not finite";
        default:
            return std::string(name_of(status));
    }
}

bool goes_through_plane(const FlowSurface& surface, const FlowOptions& options, const FlowResult& result) {
    const TargetKind target = options.target.value_or(TargetKind::flat);
    const bool zero = target == TargetKind::flat || target == TargetKind::uniform;
    return result.geometry == Geometry::spherical && options.sphere_route == SphereRoute::robust &&
           options.method == Method::newton && options.cones.empty() && zero &&
           (result.boundary == Boundary::geodesic || surface.topology.boundaries == 0) &&
           sphere_route_exists(surface);
}

/// One third of the faces around each vertex. // V
std::vector<double> vertex_areas(const SurfaceMesh& mesh) {
    const std::vector<double> face = face_areas(mesh);
    std::vector<double> area(static_cast<std::size_t>(mesh.connectivity.vertex_count), 0.0);
    for (std::size_t h = 0; h < mesh.connectivity.tail.size(); ++h)
        area[static_cast<std::size_t>(mesh.connectivity.tail[h])] += face[h / 3] / 3.0;
    return area;
}

void flow_through_plane(const SurfaceMesh& mesh, const FlowSurface& surface, const CurvatureTarget& target,
                        const FlowOptions& options, FlowResult& result) {
    SphereOptions sphere;
    sphere.tolerance = options.tolerance;
    if (options.max_iterations > 0) sphere.max_iterations = options.max_iterations;
    sphere.parallel = options.parallel;
    sphere.precision = options.precision;
    sphere.mass = vertex_areas(mesh);
    sphere.interrupted = options.interrupted;
    sphere.progress = options.progress;
    SphereResult solved = solve_sphere(surface, sphere);
    result.outcome = std::move(solved.outcome);
    result.message = std::move(solved.message);
    result.precision_digits = solved.extended_precision ? 19 : 16;
    // A solve that ended in the plane has no u for the sphere; the metric shown is then the initial one.
    if (solved.reached_sphere) result.conformal_factor = std::move(solved.u);
    std::unique_ptr<Metric> metric =
        std::make_unique<ScaledMetric<double>>(surface, Geometry::spherical, options.parallel);
    if (solved.extended_precision)
        metric = std::make_unique<ScaledMetric<long double>>(surface, Geometry::spherical, options.parallel);
    metric->move_to(result.conformal_factor);
    metric->evaluate(false);
    if (!solved.reached_sphere) result.outcome.residual_max = residual_max(metric->curvature(), target);
    store(*metric, target, result);
}

/// Vertex scaling; in more digits where double does not suffice.
void flow_by_scaling(const SurfaceMesh& mesh, const FlowOptions& options, FlowResult& result) {
    const FlowSurface surface = make_flow_surface(mesh, result.boundary != Boundary::free, options.delaunay);
    const CurvatureTarget target = make_target(surface, options, result.geometry, result.boundary);
    std::vector<double>& u = result.conformal_factor;
    u.assign(surface.used.size(), 0.0);
    const bool fixed = result.boundary == Boundary::free && surface.topology.boundaries > 0;
    if (!fixed) std::fill(u.begin(), u.end(), initial_log_scale(mesh, target.curvature, result.geometry));
    result.target_curvature = target.curvature;
    result.message = inadmissibility(surface, target, result.geometry, result.boundary);
    std::unique_ptr<Metric> metric =
        std::make_unique<ScaledMetric<double>>(surface, result.geometry, options.parallel);
    if (!result.message.empty()) {
        metric->move_to(u);
        metric->evaluate(false);
        result.outcome.status = Status::inadmissible_target;
        result.outcome.residual_max = residual_max(metric->curvature(), target);
        store(*metric, target, result);
        return;
    }
    if (goes_through_plane(surface, options, result))
        return flow_through_plane(mesh, surface, target, options, result);
    ScalingSolve solve;
    solve.u = std::move(u);
    const ScalingProblem problem{
        &mesh,
        &surface,
        result.geometry,
        &target,
        options.parallel,
        solve_options(options, result.geometry),
        options.precision,
        options.tolerated_rounding > 0.0 ? options.tolerated_rounding : 0.1 * options.tolerance,
        [&](Metric& at, const CurvatureTarget& aim, const SolveOptions& level, std::vector<double>& factor,
            std::vector<double>* low) {
            return run(at, aim, level, options.method, result.geometry, factor, low);
        }};
    solve_by_scaling(problem, *metric, solve);
    u = std::move(solve.u);
    result.conformal_factor_low = std::move(solve.low);
    result.outcome = std::move(solve.outcome);
    result.precision_digits = solve.digits;
    result.message = reason(result.outcome.status, result.geometry, options);
    if (result.outcome.status == Status::converged && solve.rounding_floor > options.tolerance)
        result.message = rounding_note(solve.digits, solve.rounding_floor);
    store(*solve.metric, target, result);
}

void flow_by_packing(const SurfaceMesh& mesh, const FlowOptions& options, FlowResult& result) {
    const FlowSurface surface = make_flow_surface(mesh, false, false);
    const CurvatureTarget target = make_target(surface, options, result.geometry, result.boundary);
    const double scale = std::exp(initial_log_scale(mesh, target.curvature, result.geometry));
    std::vector<double> length = mesh.edge_length;
    for (double& l : length) l *= scale;
    result.packing = initial_circle_packing(mesh.connectivity, length, result.geometry, options.scheme);
    PackedMetric metric(surface, *result.packing, result.geometry, options.parallel);
    std::vector<double>& u = result.conformal_factor;
    u = result.packing->u;
    result.target_curvature = target.curvature;
    result.message = inadmissibility(surface, target, result.geometry, result.boundary);
    const auto violated = [&](std::span<const double> levels) {
        if (result.geometry != Geometry::euclidean || options.scheme == Scheme::virtual_radius) return false;
        const auto violation = find_violation(mesh.connectivity, result.packing->eta, target, levels);
        if (violation) result.message = describe(*violation);
        return violation.has_value();
    };
    if (!result.message.empty() || violated({})) {
        metric.move_to(u);
        metric.evaluate(false);
        result.outcome.status = Status::inadmissible_target;
        result.outcome.residual_max = residual_max(metric.curvature(), target);
        store(metric, target, result);
        return;
    }
    // Towards an inadmissible target the circles of a violating set shrink for ever. It is asked for on the
    // way, while the radii still mean something; any set found is a proof.
    FlowOptions watched = options;
    std::int64_t asked = 0;
    watched.interrupted = [&]() -> std::optional<Status> {
        if (options.interrupted)
            if (const auto status = options.interrupted()) return status;
        const std::int64_t every = options.method == Method::newton ? 1 : 100;
        ++asked;
        return asked > 4 && asked % every == 0 && violated(u) ? std::optional(Status::inadmissible_target)
                                                              : std::nullopt;
    };
    result.outcome =
        run(metric, target, solve_options(watched, result.geometry), options.method, result.geometry, u);
    const Status status = result.outcome.status;
    if (status != Status::converged && status != Status::inadmissible_target) {
        result.message = reason(status, result.geometry, options);
        if (status != Status::cancelled && status != Status::timeout && violated(u))
            result.outcome.status = Status::inadmissible_target;
    }
    store(metric, target, result);
}

}  // namespace

std::string_view name_of(Method method) {
    return method == Method::newton ? "newton" : "gradient";
}

std::string_view name_of(SphereRoute route) {
    return route == SphereRoute::robust ? "robust" : "direct";
}

Geometry resolve_geometry(const FlowOptions& options, const Topology& topology) {
    if (options.geometry) return *options.geometry;
    if (options.target || !options.cones.empty()) return Geometry::euclidean;
    if (topology.euler_characteristic < 0) return Geometry::hyperbolic;
    return topology.euler_characteristic == 0 ? Geometry::euclidean : Geometry::spherical;
}

MetricAccuracy accuracy_of(const FlowResult& result) {
    return {result.outcome.residual_max, result.gauss_bonnet_error, result.precision_digits};
}

FlowResult solve_flow(const SurfaceMesh& mesh, const FlowOptions& options) {
    FlowResult result;
    result.geometry = resolve_geometry(options, topology_of(mesh.connectivity));
    result.boundary = resolve_boundary(options);
    if (options.scheme == Scheme::vertex_scaling) {
        flow_by_scaling(mesh, options, result);
    } else {
        flow_by_packing(mesh, options, result);
    }
    return result;
}

}  // namespace ricci
