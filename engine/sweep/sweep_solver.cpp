#include "engine/sweep/sweep_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "engine/flow/target.h"
#include "engine/remesh/densify.h"
#include "engine/sweep/area_distortion.h"

namespace ricci {
namespace {

using std::numbers::pi;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

double cone_of(const Topology& topology, const SweepOptions& options) {
    return options.cone_curvature.value_or(2.0 * pi * topology.euler_characteristic);
}

FlowOptions flow_options(const SweepOptions& options) {
    FlowOptions flow;
    flow.geometry = Geometry::euclidean;
    flow.scheme = options.scheme;
    flow.boundary = options.boundary;
    return flow;
}

}  // namespace

std::string explain_inadmissible(const Topology& topology, const SweepOptions& options) {
    const double cone = cone_of(topology, options);
    const bool absorbs = options.boundary == Boundary::free && topology.boundaries > 0;
    if (absorbs && options.cone_curvature)
        return cone < 2.0 * pi ? std::string() : "a cone's curvature must stay below 2 pi";
    const Index chi = topology.euler_characteristic;
    if (chi == 0)
        return "chi = 0 needs no cone: the flat metric has none. Use 'ricci flow' (target flat) instead of a "
               "sweep";
    if (chi > 0)
        return fmt::format(
            "chi = {} admits no single cone: its curvature would have to be {} pi, but a cone's stays "
            "below 2 pi. Use 'ricci flow' with the spherical geometry, several cones (--cone), or target "
            "boundary for a disk",
            chi, 2 * chi);
    if (!absorbs && std::abs(cone - 2.0 * pi * chi) > 1e-11)
        return fmt::format(
            "one cone must carry 2 pi chi = {:.12g} (Gauss-Bonnet), not {:.12g}; with boundary, "
            "'--boundary free' lets the boundary take the rest",
            2.0 * pi * chi, cone);
    return {};
}

std::string_view name_of(SweepSolverKind solver) {
    return solver == SweepSolverKind::lanes ? "lanes" : "newton";
}

SweepSurface::SweepSurface(SurfaceMesh mesh, const SweepOptions& options)
    : mesh_(std::move(mesh)), options_(options), topology_(topology_of(mesh_.connectivity)) {
    cone_curvature_ = cone_of(topology_, options);
    inadmissible_ = explain_inadmissible(topology_, options);
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh_.connectivity),
                                    used = used_vertices(mesh_.connectivity);
    for (Index v = 0; v < mesh_.connectivity.vertex_count; ++v)
        if (used[at(v)] && !boundary[at(v)]) candidates_.push_back(v);
    if (inadmissible_.empty() && candidates_.empty()) inadmissible_ = "no interior vertex to put the cone at";
    if (!inadmissible_.empty()) return;
    area_ = face_areas(mesh_);
    const bool scaling = options.scheme == Scheme::vertex_scaling;
    surface_ =
        make_flow_surface(mesh_, scaling && options.boundary != Boundary::free, scaling && options.delaunay);
    target_ = make_target(surface_, flow_options(options), Geometry::euclidean, options.boundary);
    const NewtonSolver ordered(surface_, target_, Definiteness::positive, true);
    ordering_.assign(ordered.ordering().begin(), ordered.ordering().end());
    if (scaling) {
        start_ = rounded(surface_.triangulation);
        if (options.solver == SweepSolverKind::lanes && options.precision != Precision::extended)
            lane_surface_ = make_lane_surface(surface_, target_, ordering_);
    } else {
        packing_ = initial_circle_packing(mesh_.connectivity, mesh_.edge_length, Geometry::euclidean,
                                          options.scheme);
    }
}

LaneOptions SweepSurface::lane_options(int lanes) const {
    LaneOptions options;
    options.cone_curvature = cone_curvature_;
    options.tolerance = options_.tolerance;
    options.lanes = lanes;
    if (options_.max_iterations > 0)
        options.max_steps = std::min(options.max_steps, static_cast<int>(options_.max_iterations));
    return options;
}

std::int64_t SweepSurface::worker_bytes(int lanes) const {
    // Per halfedge: two triangulations, fields and workspace; per unknown: a nested-dissection factor of
    // about 7.75 n log2 n entries (George 1973's constant for a grid), twice (own and first step), and its
    // pattern.
    const auto halfedges = static_cast<double>(surface_.triangulation.log_chord.size());
    const auto n = static_cast<double>(std::max<Index>(target_.unknown_count, 2));
    const auto newton =
        static_cast<std::int64_t>(halfedges * 140.0 + n * (2.0 * 8.0 * 7.75 * std::log2(n) + 400.0));
    if (!lane_surface_) return newton;
    // Any vertex may fall back on Newton's method.
    return newton + LaneSolver::predicted_bytes(lane_surface_->rows(), lane_surface_->faces.face_count(),
                                                lane_options(lanes));
}

std::int64_t SweepSurface::shared_bytes() const {
    return static_cast<std::int64_t>(static_cast<double>(surface_.triangulation.log_chord.size()) * 70.0 +
                                     static_cast<double>(mesh_.edge_length.size()) * 60.0) +
           (lane_surface_ ? lane_surface_->bytes() : 0);
}

SweepWorker::SweepWorker(std::shared_ptr<const SweepSurface> surface, int lanes)
    : shared_(std::move(surface)), lanes_(lanes > 0 ? lanes : shared_->lanes()), target_(shared_->target_) {}

void SweepWorker::make_newton() {
    if (newton_ || (shared_->packing_ && shared_->options_.densify)) return;  // densify: a mesh per vertex
    auto newton = std::make_unique<NewtonSolver>(shared_->surface_, target_, Definiteness::positive, true,
                                                 shared_->ordering_);
    if (shared_->packing_) {
        packed_ =
            std::make_unique<PackedMetric>(shared_->surface_, *shared_->packing_, Geometry::euclidean, false);
    } else {
        metric_ = std::make_unique<ScaledMetric<double>>(shared_->surface_, Geometry::euclidean, false);
        newton->prepare_first_factor(*metric_, std::vector<double>(target_.curvature.size(), 0.0));
    }
    newton_ = std::move(newton);
}

void SweepWorker::drop_newton() {
    newton_.reset();
    metric_.reset();
    packed_.reset();
    target_ = shared_->target_;
}

SweepWorker::~SweepWorker() = default;

SweepSolve SweepWorker::solve(Index vertex, const std::function<std::optional<Status>()>& interrupted) {
    using Clock = std::chrono::steady_clock;
    if (!std::binary_search(shared_->candidates_.begin(), shared_->candidates_.end(), vertex))
        throw std::invalid_argument(fmt::format("vertex {} is no interior vertex of this surface", vertex));
    make_newton();
    const auto start = Clock::now();
    SweepSolve result;
    result.vertex = vertex;
    result.area_distortion = std::numeric_limits<double>::quiet_NaN();
    SolveOptions options;
    options.tolerance = shared_->options_.tolerance;
    options.max_iterations = shared_->options_.max_iterations > 0 ? shared_->options_.max_iterations : 500;
    options.convex = shared_->options_.scheme != Scheme::virtual_radius;
    options.interrupted = interrupted;
    target_.curvature[at(vertex)] += shared_->cone_curvature_;
    if (!newton_) {
        solve_densified(result, options);
    } else if (packed_) {
        solve_packing(result, options);
    } else {
        solve_scaling(result, options);
    }
    target_.curvature[at(vertex)] = shared_->target_.curvature[at(vertex)];
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return result;
}

namespace {

void take(const SolveOutcome& outcome, SweepSolve& result) {
    result.status = outcome.status;
    result.residual_max = outcome.residual_max;
    result.newton_iterations += outcome.iterations;
    result.flips += outcome.flips;
}

/// |sum K - 2 pi chi| as the metric stands, Euclidean.
double gauss_bonnet_error(const Metric& metric) {
    const std::span<const double> curvature = metric.curvature();
    const double total = std::accumulate(curvature.begin(), curvature.end(), 0.0);
    return std::abs(total - 2.0 * pi * metric.surface().topology.euler_characteristic);
}

/// Shifts a scale-free solution to mean zero and measures the residual of the very numbers that are stored.
void settle(Metric& metric, const CurvatureTarget& target, double tolerance, SweepSolve& result) {
    std::vector<double>& u = result.conformal_factor;
    if (target.scale_free) {
        double sum = 0.0, count = 0.0;
        for (std::size_t v = 0; v < u.size(); ++v) {
            if (target.unknown[v] < 0) continue;
            sum += u[v];
            count += 1.0;
        }
        for (std::size_t v = 0; v < u.size(); ++v)
            if (target.unknown[v] >= 0) u[v] -= sum / count;
    }
    metric.move_to(u);
    metric.evaluate(false);
    result.residual_max = residual_max(metric.curvature(), target);
    result.gauss_bonnet_error = gauss_bonnet_error(metric);
    if (result.residual_max > tolerance) result.status = Status::stalled;
}

}  // namespace

void SweepWorker::solve_scaling(SweepSolve& result, const SolveOptions& options) {
    ScalingSolve solve;
    solve.u.assign(target_.curvature.size(), 0.0);
    metric_->reset(shared_->start_);
    const ScalingProblem problem{
        &shared_->mesh_,
        &shared_->surface_,
        Geometry::euclidean,
        &target_,
        false,
        options,
        shared_->options_.precision,
        0.1 * options.tolerance,
        [&](Metric& metric, const CurvatureTarget& target, const SolveOptions& level, std::vector<double>& u,
            std::vector<double>* low) { return newton_->solve(metric, target, level, u, low); }};
    solve_by_scaling(problem, *metric_, solve);
    take(solve.outcome, result);
    result.precision_digits = solve.digits;
    result.gauss_bonnet_error = gauss_bonnet_error(*solve.metric);
    result.conformal_factor = std::move(solve.u);
    if (result.status == Status::converged && solve.rounding_floor > options.tolerance)
        result.message = rounding_note(solve.digits, solve.rounding_floor);
    if (result.status == Status::converged && !solve.low.empty()) {
        // A sweep stores doubles: a factor that they do not hold is not handed out as one that converged.
        result.status = Status::stalled;
        result.message = fmt::format(
            "converges in {} digits, but not rounded to double: ricci flow --cone stores both parts of u",
            solve.digits);
        return;
    }
    if (result.status != Status::converged) {
        result.message =
            fmt::format("residual {:.3g} after {} steps", result.residual_max, result.newton_iterations);
        return;
    }
    result.area_distortion =
        area_distortion_of_scaling(shared_->area_, shared_->mesh_.connectivity.tail, result.conformal_factor);
}

void SweepWorker::solve_packing(SweepSolve& result, const SolveOptions& options) {
    const CirclePacking& packing = *shared_->packing_;
    std::vector<double>& u = result.conformal_factor;
    u = packing.u;
    const bool theorem = shared_->options_.scheme != Scheme::virtual_radius;
    const auto violated = [&](std::span<const double> levels) {
        if (!theorem) return false;
        const auto violation = find_violation(shared_->mesh_.connectivity, packing.eta, target_, levels);
        if (!violation) return false;
        result.status = Status::inadmissible_target;
        result.message = describe(*violation);
        return true;
    };
    if (violated({})) return;
    // A violating set shows on the way, while the radii still mean something.
    SolveOptions watched = options;
    int asked = 0;
    watched.interrupted = [&]() -> std::optional<Status> {
        if (options.interrupted)
            if (const auto status = options.interrupted()) return status;
        return ++asked > 4 && violated(u) ? std::optional(Status::inadmissible_target) : std::nullopt;
    };
    take(newton_->solve(*packed_, target_, watched, u), result);
    if (result.status == Status::converged) settle(*packed_, target_, options.tolerance, result);
    if (result.status == Status::converged) {
        result.area_distortion = area_distortion_of_areas(shared_->area_, packed_->face_areas());
    } else if (result.status != Status::inadmissible_target && !violated(u)) {
        result.message =
            fmt::format("residual {:.3g} after {} steps", result.residual_max, result.newton_iterations);
    }
}

void SweepWorker::solve_densified(SweepSolve& result, const SolveOptions& options) {
    const Topology& topology = shared_->topology_;
    // The thesis: no less than four times the genus. Obtuse packings (phi > 0) may need more: Theorem 4
    // tells.
    const Index least = std::max(4 * topology.genus, 3 - 2 * topology.euler_characteristic);
    SweepOptions inner = shared_->options_;
    inner.densify = false;
    for (Index attempt = 1; attempt <= 4; ++attempt) {
        const DensifiedMesh dense = densify_around(shared_->mesh_, result.vertex, attempt * least);
        SweepWorker worker(std::make_shared<SweepSurface>(dense.mesh, inner));
        SweepSolve solved = worker.solve(result.vertex, options.interrupted);
        solved.conformal_factor.resize(shared_->target_.curvature.size());  // the input's vertices come first
        result = std::move(solved);
        if (result.status != Status::inadmissible_target) return;
    }
}

}  // namespace ricci
