#include "engine/app/verify_results.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "engine/app/console.h"
#include "engine/app/records.h"
#include "engine/app/solve_options.h"
#include "engine/app/stored_settings.h"
#include "engine/flow/target.h"
#include "engine/sweep/sweep_solver.h"
#include "engine/verify/recompute.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

/// What the recomputation may differ by where the stored residual was evaluated in double: angles at factors
/// of e^48 carry some 1e-12, and solves whose rounding could be more than a tenth of the tolerance are
/// measured in more digits. Those may differ by that tenth.
constexpr double kResidualSlack = 1e-9;
double residual_slack(int precision_digits, double tolerance) {
    return precision_digits > 16 ? std::max(2e-11, 0.1 * tolerance) : kResidualSlack;
}
constexpr double kDistortionSlack = 1e-9;  // relative

/// In more digits where the solve took more.
int recomputed_digits(int precision_digits) {
    return precision_digits > 16 ? 50 : 19;
}

Recomputed recompute(const SurfaceMesh& mesh, ConformalFactor u, Scheme scheme, Geometry geometry,
                     Boundary boundary, bool delaunay, double packing_scale, int digits) {
    if (scheme == Scheme::vertex_scaling)
        return recompute_scaling(mesh, u, geometry, boundary, delaunay, digits);
    std::vector<double> length = mesh.edge_length;
    for (double& l : length) l *= packing_scale;
    const CirclePacking packing = initial_circle_packing(mesh.connectivity, length, geometry, scheme);
    return recompute_packing(mesh, packing.eta, packing.eps, u.high, geometry);
}

/// max |K - target| over vertices that are prescribed: all used ones, but not a free boundary.
double residual(const SurfaceMesh& mesh, const Recomputed& r, std::span<const double> target,
                Boundary boundary) {
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(mesh.connectivity),
                                    used = used_vertices(mesh.connectivity);
    double largest = 0.0;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v] || (on_boundary[v] && boundary == Boundary::free)) continue;
        largest = std::max(largest, std::abs(r.curvature[v] - target[v]));
    }
    return largest;
}

/// Both sums of curvatures carry a rounding per vertex, of the size of the largest.
double gauss_bonnet_slack(const Recomputed& r) {
    double sum = 0.0;
    for (const double k : r.curvature) sum += 1.0 + std::abs(k);
    return 1e-9 + 1e-14 * sum;
}

void judge(const Recomputed& r, double slack, RecomputedSolution& s) {
    s.flips = r.isometric_flips + r.ptolemy_flips;
    s.gauss_bonnet_recomputed = r.gauss_bonnet_error;
    s.distortion_recomputed = r.area_distortion;
    if (!r.valid)
        s.message = "a face of the rebuilt metric is no triangle";
    else if (r.non_delaunay > 0)
        s.message = fmt::format("{} edges of the rebuilt metric are not Delaunay", r.non_delaunay);
    else if (!(std::abs(s.residual_recomputed - s.residual_stored) <= slack))
        s.message =
            fmt::format("residual is {:.3g}, stored {:.3g}", s.residual_recomputed, s.residual_stored);
    else if (std::isfinite(s.gauss_bonnet_stored) &&
             !(std::abs(s.gauss_bonnet_recomputed - s.gauss_bonnet_stored) <= gauss_bonnet_slack(r)))
        s.message = fmt::format("the Gauss-Bonnet error is {:.3g}, stored {:.3g}", s.gauss_bonnet_recomputed,
                                s.gauss_bonnet_stored);
    else if (std::isfinite(s.distortion_stored) &&
             !(std::abs(s.distortion_recomputed - s.distortion_stored) <=
               kDistortionSlack * (1.0 + s.distortion_stored)))
        s.message = fmt::format("area distortion is {:.12g}, stored {:.12g}", s.distortion_recomputed,
                                s.distortion_stored);
    s.sound = s.message.empty();
}

RecomputedSolution check_kept(const StoredItem& item, const KeptFactor& kept, const StoredSettings& options) {
    int precision_digits = 0;
    RecomputedSolution s;
    const StoredSweep& sweep = *item.sweep;
    s.item = item.item.name;
    s.what = fmt::format("{} (vertex {})",
                         kept.vertex == sweep.best ? "best" : (kept.vertex == sweep.worst ? "worst" : "kept"),
                         kept.vertex);
    s.distortion_stored = kept.area_distortion;
    for (const SweepRow& row : sweep.rows)
        if (row.vertex == kept.vertex) {
            s.residual_stored = row.residual_max;
            s.gauss_bonnet_stored = row.gauss_bonnet_error;
            precision_digits = row.precision_digits;
        }
    s.digits = recomputed_digits(precision_digits);
    if (options.densify) {
        s.message = "solved on a densified mesh, which is not stored: cannot be recomputed";
        return s;
    }
    const SurfaceMesh mesh = surface_of(item.item);
    std::vector<double> target(kept.conformal_factor.size(), 0.0);
    target[static_cast<std::size_t>(kept.vertex)] =
        options.cone_curvature.value_or(2.0 * std::numbers::pi * item.item.euler_characteristic);
    const Recomputed r = recompute(mesh, kept.conformal_factor, options.scheme, Geometry::euclidean,
                                   options.boundary, options.delaunay, 1.0, s.digits);
    s.residual_recomputed = residual(mesh, r, target, options.boundary);
    judge(r, residual_slack(precision_digits, options.tolerance), s);
    return s;
}

RecomputedSolution check_flow(const StoredItem& item, const StoredSettings& options) {
    const FlowRecord& flow = *item.flow;
    RecomputedSolution s;
    s.item = item.item.name;
    s.what = fmt::format("flow ({})", flow.geometry);
    s.residual_stored = flow.residual_max;
    s.gauss_bonnet_stored = flow.gauss_bonnet_error;
    s.digits = recomputed_digits(flow.precision_digits);
    s.distortion_stored = std::numeric_limits<double>::quiet_NaN();
    const SurfaceMesh mesh = surface_of(item.item);
    const std::optional<Geometry> named = parse_geometry(flow.geometry);
    if (!named) throw FileError(fmt::format("{}/flow: geometry is '{}'", s.item, flow.geometry));
    const Geometry geometry = *named;
    const Boundary boundary = parse_boundary(flow.boundary);
    // A free boundary's stored target is what it came to have; the flow started from zero there.
    std::vector<double> prescribed = flow.target_curvature;
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(mesh.connectivity);
    for (std::size_t v = 0; v < prescribed.size(); ++v)
        if (boundary == Boundary::free && on_boundary[v]) prescribed[v] = 0.0;
    const double scale = std::exp(initial_log_scale(mesh, prescribed, geometry));
    const Recomputed r =
        recompute(mesh, {flow.conformal_factor, flow.conformal_factor_low}, parse_scheme(flow.scheme),
                  geometry, boundary, options.delaunay, scale, s.digits);
    s.residual_recomputed = residual(mesh, r, flow.target_curvature, boundary);
    judge(r, residual_slack(flow.precision_digits, options.tolerance), s);
    return s;
}

}  // namespace

std::vector<RecomputedSolution> recompute_solutions(const StoredRun& run, int threads) {
    const StoredSettings options = settings_of(run);
    std::vector<std::function<RecomputedSolution()>> jobs;
    for (const StoredItem& item : run.items) {
        if (item.sweep)
            for (const KeptFactor& kept : item.sweep->kept)
                jobs.emplace_back([&] { return check_kept(item, kept, options); });
        if (item.flow) jobs.emplace_back([&] { return check_flow(item, options); });
    }
    std::vector<RecomputedSolution> results(jobs.size());
    with_thread_limit(threads, [&] {
        for_blocks(static_cast<std::int64_t>(jobs.size()), 1, threads > 1,
                   [&](std::int64_t begin, std::int64_t) {
                       const auto k = static_cast<std::size_t>(begin);
                       results[k] = jobs[k]();
                   });
    });
    return results;
}

}  // namespace ricci::app
