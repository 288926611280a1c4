#include "engine/flow/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace ricci {
namespace {

using std::numbers::pi;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

void fill_uniform(const FlowSurface& surface, std::vector<double>& curvature) {
    if (surface.topology.boundaries > 0)
        throw std::invalid_argument(
            "target uniform needs a closed surface; use target boundary for one with boundary");
    const double value = 2.0 * pi * surface.topology.euler_characteristic / surface.topology.vertices;
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if (surface.used[v]) curvature[v] = value;
}

void fill_boundary(const FlowSurface& surface, std::vector<double>& curvature) {
    const auto count = std::count(surface.boundary.begin(), surface.boundary.end(), std::uint8_t{1});
    if (count == 0) throw std::invalid_argument("target boundary needs a surface with boundary");
    const double value = 2.0 * pi * surface.topology.euler_characteristic / static_cast<double>(count);
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if (surface.boundary[v]) curvature[v] = value;
}

}  // namespace

CurvatureTarget make_target(const FlowSurface& surface, const FlowOptions& options, Geometry geometry,
                            Boundary boundary) {
    const std::size_t vertices = surface.used.size();
    CurvatureTarget target;
    target.curvature.assign(vertices, 0.0);
    switch (options.target.value_or(TargetKind::flat)) {
        case TargetKind::flat:
            break;
        case TargetKind::uniform:
            if (geometry == Geometry::euclidean) fill_uniform(surface, target.curvature);
            break;
        case TargetKind::boundary:
            fill_boundary(surface, target.curvature);
            break;
        case TargetKind::values:
            if (options.target_values.size() != vertices)
                throw std::invalid_argument(fmt::format("the target has {} values, the surface {} vertices",
                                                        options.target_values.size(), vertices));
            target.curvature = options.target_values;
            break;
    }
    for (const Cone& cone : options.cones) {
        if (cone.vertex < 0 || at(cone.vertex) >= vertices || !surface.used[at(cone.vertex)])
            throw std::invalid_argument(fmt::format("cone at vertex {}: there is no such vertex (0 … {})",
                                                    cone.vertex, vertices - 1));
        if (boundary == Boundary::geodesic && surface.boundary[at(cone.vertex)])
            throw std::invalid_argument(fmt::format(
                "cone at boundary vertex {}: a geodesic boundary has no curvature; use --boundary curvature",
                cone.vertex));
        target.curvature[at(cone.vertex)] = cone.curvature;
    }
    target.unknown.assign(vertices, -1);
    bool fixed = false;
    for (std::size_t v = 0; v < vertices; ++v) {
        if (!surface.used[v]) continue;
        if (boundary == Boundary::geodesic && surface.boundary[v]) target.curvature[v] = 0.0;
        if (boundary == Boundary::free && surface.boundary[v]) {
            target.curvature[v] = 0.0;
            fixed = true;
            continue;
        }
        target.unknown[v] = target.unknown_count++;
    }
    if (target.unknown_count == 0)
        throw std::invalid_argument("every vertex lies on the free boundary: nothing to solve");
    target.scale_free = geometry == Geometry::euclidean && !fixed;
    return target;
}

std::string inadmissibility(const FlowSurface& surface, const CurvatureTarget& target, Geometry geometry,
                            Boundary boundary) {
    double sum = 0.0;
    for (std::size_t v = 0; v < target.curvature.size(); ++v) {
        const double value = target.curvature[v];
        if (!std::isfinite(value)) return fmt::format("target curvature of vertex {} is not finite", v);
        if (target.unknown[v] < 0) continue;
        const double limit = surface.boundary[v] ? pi : 2.0 * pi;
        if (value >= limit)
            return fmt::format("target curvature {:.9g} of {} vertex {} is not below {}", value,
                               surface.boundary[v] ? "boundary" : "interior", v,
                               surface.boundary[v] ? "pi" : "2 pi");
        sum += value;
    }
    const double needed = 2.0 * pi * surface.topology.euler_characteristic;
    const bool has_free_part = boundary == Boundary::free && surface.topology.boundaries > 0;
    if (has_free_part) return {};
    const double slack = 1e-11 * (10.0 + std::abs(needed));
    if (geometry == Geometry::euclidean && std::abs(sum - needed) > slack)
        return fmt::format(
            "target curvatures sum to {:.12g}, but Gauss-Bonnet asks for 2 pi chi = {:.12g} (chi = {}), "
            "{:.3g} apart",
            sum, needed, surface.topology.euler_characteristic, sum - needed);
    if (geometry == Geometry::hyperbolic && sum <= needed)
        return fmt::format(
            "target curvatures sum to {:.12g}; a hyperbolic metric needs more than 2 pi chi = {:.12g} "
            "(chi = {}), the difference being its area",
            sum, needed, surface.topology.euler_characteristic);
    if (geometry == Geometry::spherical && sum >= needed)
        return fmt::format(
            "target curvatures sum to {:.12g}; a spherical metric needs less than 2 pi chi = {:.12g} "
            "(chi = {}), the difference being its area",
            sum, needed, surface.topology.euler_characteristic);
    return {};
}

double initial_log_scale(const SurfaceMesh& mesh, std::span<const double> curvature, Geometry geometry) {
    if (geometry == Geometry::euclidean) return 0.0;
    const double sum = std::accumulate(curvature.begin(), curvature.end(), 0.0);
    const double chi = topology_of(mesh.connectivity).euler_characteristic;
    const double expected = curvature_sign(geometry) * (2.0 * pi * chi - sum);
    const std::vector<double> areas = face_areas(mesh);
    const double input = std::accumulate(areas.begin(), areas.end(), 0.0);
    return expected > 0.0 ? 0.5 * std::log(expected / input) : 0.0;
}

std::optional<AdmissibilityViolation> find_violation(const Connectivity& c, std::span<const double> eta,
                                                     const CurvatureTarget& target,
                                                     std::span<const double> u) {
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(c);
    std::vector<std::vector<Index>> corners(at(c.vertex_count));
    for (Index h = 0; h < c.halfedge_count(); ++h) corners[at(c.tail[at(h)])].push_back(h);
    // The largest angle the corner at h can take while only its own circle shrinks: pi - phi(opposite edge).
    const auto corner_limit = [&](Index h) {
        const double cosine = std::clamp(eta[at(next_halfedge(h))], -1.0, 1.0);
        return pi - std::acos(cosine);
    };
    const auto full = [&](Index v) { return on_boundary[at(v)] ? pi : 2.0 * pi; };
    constexpr double kSlack = 1e-9;  // a set this close to its bound needs radii beyond double anyway
    std::optional<AdmissibilityViolation> worst;
    double worst_excess = -kSlack;
    std::vector<Index> order;
    for (Index v = 0; v < c.vertex_count; ++v) {
        if (corners[at(v)].empty() || target.unknown[at(v)] < 0) continue;
        order.push_back(v);
        double bound = full(v);
        for (const Index h : corners[at(v)]) bound -= corner_limit(h);
        const double excess = bound - target.curvature[at(v)];
        if (excess > worst_excess) {
            worst_excess = excess;
            worst = AdmissibilityViolation{{v}, target.curvature[at(v)], bound};
        }
    }
    if (u.empty() || worst) return worst;
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return u[at(a)] < u[at(b)]; });
    std::vector<std::uint8_t> inside(at(c.vertex_count), 0);
    double sum = 0.0, bound = 0.0;
    std::size_t best = 0;
    double best_sum = 0.0, best_bound = 0.0;
    // Proper subsets only: all unknowns together are one where others (a free boundary) are fixed.
    const auto used =
        std::count_if(corners.begin(), corners.end(), [](const auto& list) { return !list.empty(); });
    const std::size_t largest = order.size() - (static_cast<std::size_t>(used) == order.size() ? 1 : 0);
    for (std::size_t k = 0; k < largest; ++k) {
        const Index v = order[k];
        sum += target.curvature[at(v)];
        bound += full(v);
        for (const Index h : corners[at(v)]) {
            const Index n = next_halfedge(h), p = prev_halfedge(h);
            const bool next_in = inside[at(c.tail[at(n)])] != 0, prev_in = inside[at(c.tail[at(p)])] != 0;
            if (!next_in && !prev_in) bound -= corner_limit(h);
            if (next_in != prev_in) bound += corner_limit(next_in ? n : p) - pi;
        }
        inside[at(v)] = 1;
        if (bound - sum > worst_excess) {
            worst_excess = bound - sum;
            best = k + 1;
            best_sum = sum;
            best_bound = bound;
        }
    }
    if (best == 0) return std::nullopt;
    AdmissibilityViolation violation{
        {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(best)}, best_sum, best_bound};
    std::sort(violation.vertices.begin(), violation.vertices.end());
    return violation;
}

std::string describe(const AdmissibilityViolation& violation) {
    std::string list;
    for (std::size_t k = 0; k < violation.vertices.size() && k < 8; ++k)
        list += fmt::format("{}{}", k == 0 ? "" : ", ", violation.vertices[k]);
    if (violation.vertices.size() > 8) list += fmt::format(", … ({} in all)", violation.vertices.size());
    return fmt::format(
        "the set I = {{{}}} violates Theorem 4: sum of target curvature over I is {:.9g}, but must exceed "
        "-sum_Lk(I) (pi - phi) + 2 pi chi(F_I) = {:.9g}",
        list, violation.curvature_sum, violation.bound);
}

}  // namespace ricci
