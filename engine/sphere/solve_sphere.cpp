#include "engine/sphere/solve_sphere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "engine/sphere/barycentre.h"
#include "engine/sphere/plane_layout.h"
#include "engine/sphere/punctured_plane.h"

namespace ricci {
namespace {

using Complex = std::complex<long double>;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

struct Masses {
    std::vector<long double> mass;  // per vertex of the triangulation; 0 at infinity
    long double at_infinity = 0.0L;
};

/// One third of the adjacent faces. // V, of the surface as it starts
std::vector<double> vertex_areas(const FlowSurface& surface) {
    const Connectivity& c = surface.triangulation.connectivity;
    const std::vector<double> zero(surface.orbit.size(), 0.0);
    std::vector<long double> angle(c.tail.size()), area(c.tail.size() / 3);
    evaluate_faces<long double>(Geometry::euclidean, {c.tail, surface.triangulation.log_chord, zero},
                                {angle, {}, {}, area}, false);
    std::vector<double> result(surface.used.size(), 0.0);
    for (std::size_t h = 0; h < c.tail.size(); ++h)
        result[at(surface.orbit[at(c.tail[h])])] += surface.side * static_cast<double>(area[h / 3]) / 3.0;
    return result;
}

/// Masses shared among the vertices of an orbit.
Masses masses_of(const FlowSurface& surface, const SphereOptions& options, Index infinity) {
    const std::vector<double> mass = options.mass.empty() ? vertex_areas(surface) : options.mass;
    std::vector<int> copies(mass.size(), 0);
    for (const Index v : surface.orbit) ++copies[at(v)];
    Masses result;
    for (const Index v : surface.orbit)
        result.mass.push_back(surface.used[at(v)] ? static_cast<long double>(mass[at(v)]) / copies[at(v)]
                                                  : 0.0L);
    result.at_infinity = std::exchange(result.mass[at(infinity)], 0.0L);
    return result;
}

/// Layout and normalisation together: a layout is exact near its origin, so that has to be where the centre
/// of the normalisation is, be it at a place e^40 times smaller than the rest.
PlaneSimilarity place(const IntrinsicTriangulation<long double>& disk, const Masses& masses,
                      std::vector<Complex>& z) {
    const Connectivity& c = disk.connectivity;
    constexpr long double kNear = 1e-4L;  // scale over distance from the origin: four digits lost
    Index seed = 0;
    PlaneSimilarity map;
    for (int round = 0; round < 40; ++round) {
        z = lay_out_plane(disk, seed);
        PlaneSimilarity start;
        // The rim is the largest thing in sight and contains all others.
        for (const Complex& p : z) start.scale = std::max(start.scale, std::abs(p));
        map = balance(z, masses.mass, masses.at_infinity,
                      round == 0 ? start : PlaneSimilarity{0.0L, map.scale});
        if (map.scale >= kNear * std::abs(map.centre)) break;
        Index nearest = 0;
        for (Index h = 1; h < c.halfedge_count(); ++h)
            if (std::abs(z[at(c.tail[at(h)])] - map.centre) <
                std::abs(z[at(c.tail[at(nearest)])] - map.centre))
                nearest = h;
        if (c.tail[at(nearest)] == c.tail[at(seed)]) break;
        seed = nearest;
    }
    return map;
}

/// From the plane to the sphere: |p_i - p_j| = 2 |w_i - w_j| / sqrt((1+|w_i|^2)(1+|w_j|^2)), and 2 /
/// sqrt(1+|w_i|^2) to the pole, where chords to infinity are 1.
std::vector<double> spherical_factor(const FlowSurface& surface, const PuncturedPlane& plane,
                                     const PlaneSimilarity& map, std::span<const Complex> z, Index infinity) {
    const std::size_t vertices = surface.used.size();
    std::vector<long double> sum(vertices, 0.0L);
    std::vector<int> copies(vertices, 0);
    for (std::size_t s = 0; s < surface.orbit.size(); ++s) {
        sum[at(surface.orbit[s])] += std::log(2.0L) - std::log1p(std::norm((z[s] - map.centre) / map.scale));
        ++copies[at(surface.orbit[s])];
    }
    std::vector<double> u(vertices, 0.0);
    for (std::size_t v = 0; v < vertices; ++v)
        if (surface.used[v])
            u[v] = static_cast<double>(plane.factor()[v] - std::log(map.scale) + sum[v] / copies[v]);
    u[at(surface.orbit[at(infinity)])] = static_cast<double>(std::log(2.0L) + std::log(map.scale));
    return u;
}

std::vector<Point> positions(const PlaneSimilarity& map, std::span<const Complex> z, Index infinity) {
    std::vector<Point> result;
    for (const Complex& p : z) {
        const Complex w = (p - map.centre) / map.scale;
        // In the far half by 1/w, so that nothing overflows.
        const bool far = std::abs(w) > 1.0L;
        const Complex q = far ? 1.0L / std::conj(w) : w;
        const long double unit = 1.0L / (1.0L + std::norm(q)), height = (std::norm(q) - 1.0L) * unit;
        result.push_back({static_cast<double>(2.0L * q.real() * unit),
                          static_cast<double>(2.0L * q.imag() * unit),
                          static_cast<double>(far ? -height : height)});
    }
    result[at(infinity)] = {0.0, 0.0, 1.0};
    return result;
}

/// max |K| on the sphere, infinite where some face is no triangle of the sphere, and what rounding may change
/// it by.
struct SphericalResidual {
    double largest = std::numeric_limits<double>::infinity(), rounding_floor = 0.0;
};

template <class Real>
SphericalResidual spherical_residual(const FlowSurface& surface, std::span<const double> u, bool parallel) {
    ScaledMetric<Real> metric(surface, Geometry::spherical, parallel);
    SphericalResidual result;
    if (!metric.move_to(u) || !metric.evaluate(true)) return result;
    result.largest = 0.0;
    for (const double k : metric.curvature()) result.largest = std::max(result.largest, std::abs(k));
    result.rounding_floor = metric.rounding_floor();
    return result;
}

/// Edges from a vertex to all others. // per vertex
std::vector<Index> hops_from(const Connectivity& c, Index vertex) {
    std::vector<Index> hops(at(c.vertex_count), -1);
    hops[at(vertex)] = 0;
    for (bool grew = true; grew;) {
        grew = false;
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            const Index i = c.tail[at(h)], j = c.head(h);
            if (hops[at(i)] < 0 || hops[at(j)] >= 0) continue;
            hops[at(j)] = hops[at(i)] + 1;
            grew = true;
        }
    }
    return hops;
}

/// Vertices that may go to infinity, the most promising first: the largest smallest angle around it, then the
/// same in the far half of the surface. Vertices of the triangulation.
std::vector<Index> candidates(const FlowSurface& surface) {
    const Connectivity& c = surface.triangulation.connectivity;
    const std::vector<double> zero(surface.orbit.size(), 0.0);
    std::vector<long double> angle(c.tail.size());
    evaluate_faces<long double>(Geometry::euclidean, {c.tail, surface.triangulation.log_chord, zero},
                                {angle, {}, {}, {}}, false);
    std::vector<long double> roundness(surface.orbit.size(), 4.0L);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        long double& r = roundness[at(c.tail[at(h)])];
        for (const Index k : {h, next_halfedge(h), prev_halfedge(h)}) r = std::min(r, angle[at(k)]);
    }
    std::vector<Index> order;
    for (std::size_t s = 0; s < surface.orbit.size(); ++s) {
        const auto v = at(surface.orbit[s]);
        if (surface.used[v] && (!surface.doubled || surface.boundary[v]))
            order.push_back(static_cast<Index>(s));
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return roundness[at(a)] > roundness[at(b)]; });
    const auto first = std::find_if(order.begin(), order.end(), [&](Index s) { return embedded_star(c, s); });
    if (first == order.end()) return {};
    std::vector<Index> result{*first};
    const std::vector<Index> hops = hops_from(c, *first);
    const Index far = *std::max_element(hops.begin(), hops.end());
    const auto second = std::find_if(order.begin(), order.end(), [&](Index s) {
        return 2 * hops[at(s)] >= far && s != *first && embedded_star(c, s);
    });
    if (second != order.end()) result.push_back(*second);
    return result;
}

SphereResult solve_from(const FlowSurface& surface, const SphereOptions& options, Index infinity) {
    SphereResult result;
    result.infinity = surface.orbit[at(infinity)];
    result.u.assign(surface.used.size(), 0.0);
    PuncturedPlane plane(surface, infinity, options.parallel);
    SolveOptions solve;
    solve.tolerance = 1e-3 * options.tolerance;  // leaves the tolerance to the rounding of u
    solve.max_iterations = options.max_iterations;
    solve.interrupted = options.interrupted;
    solve.progress = options.progress;
    result.outcome = plane.flatten(solve, options.tolerance);
    result.infinity_valence = plane.rim_size();
    if (result.outcome.status != Status::converged) {
        result.message =
            fmt::format("the plane with vertex {} at infinity is {}, residual {:.3g}", result.infinity,
                        name_of(result.outcome.status), result.outcome.residual_max);
        return result;
    }
    std::vector<Complex> z;
    const PlaneSimilarity map = place(plane.triangulation(), masses_of(surface, options, infinity), z);
    result.imbalance = static_cast<double>(map.imbalance);
    result.u = spherical_factor(surface, plane, map, z, infinity);
    result.position = positions(map, z, infinity);
    result.reached_sphere = true;
    double& residual = result.outcome.residual_max;
    SphericalResidual measured = spherical_residual<double>(surface, result.u, options.parallel);
    const bool coarse =
        !(measured.largest <= options.tolerance) || measured.rounding_floor > 0.1 * options.tolerance;
    result.extended_precision =
        options.precision == Precision::extended || (options.precision == Precision::automatic && coarse);
    if (result.extended_precision)
        measured = spherical_residual<long double>(surface, result.u, options.parallel);
    residual = measured.largest;
    if (residual <= options.tolerance && measured.rounding_floor > options.tolerance)
        result.message = rounding_note(result.extended_precision ? 19 : 16, measured.rounding_floor);
    if (!(residual <= options.tolerance)) {
        result.outcome.status = Status::stalled;
        result.message = fmt::format(
            "flat in the plane, but u rounded to double leaves a curvature of {:.3g} on the sphere",
            residual);
    }
    constexpr double kBalanced = 1e-9;
    if (result.imbalance > kBalanced)
        result.message +=
            fmt::format("{}the centre of mass stays {:.3g} from the origin: one vertex has half of the mass",
                        result.message.empty() ? "" : "; ", result.imbalance);
    return result;
}

bool ends_all(Status status) {
    return status == Status::converged || status == Status::cancelled || status == Status::timeout;
}

}  // namespace

bool sphere_route_exists(const FlowSurface& surface) {
    const Topology& t = surface.topology;
    return t.components == 1 && t.genus == 0 && (t.boundaries == 0 || (t.boundaries == 1 && surface.doubled));
}

SphereResult solve_sphere(const FlowSurface& surface, const SphereOptions& options) {
    if (!sphere_route_exists(surface))
        throw std::invalid_argument("the sphere needs a closed surface of genus 0 or the double of a disk");
    if (!options.mass.empty() && options.mass.size() != surface.used.size())
        throw std::invalid_argument(
            fmt::format("there are {} masses and {} vertices", options.mass.size(), surface.used.size()));
    std::vector<Index> tries;
    if (options.infinity) {
        const Index v = *options.infinity;  // an orbit's first vertex has its number
        if (v < 0 || v >= surface.vertex_count() || !surface.used[at(v)] ||
            (surface.doubled && !surface.boundary[at(v)]) ||
            !embedded_star(surface.triangulation.connectivity, v))
            throw std::invalid_argument(fmt::format("vertex {} cannot be sent to infinity", v));
        tries = {v};
    } else {
        tries = candidates(surface);
    }
    SphereResult best;
    best.outcome.status = Status::inadmissible_metric;
    best.outcome.residual_max = std::numeric_limits<double>::infinity();
    best.message = "no vertex has a star that can be opened at infinity";
    best.u.assign(surface.used.size(), 0.0);
    for (const Index v : tries) {
        SphereResult result = solve_from(surface, options, v);
        const bool better = result.outcome.status == Status::converged || best.infinity < 0 ||
                            result.outcome.residual_max < best.outcome.residual_max;
        const bool enough = ends_all(result.outcome.status);
        if (better || enough) best = std::move(result);
        if (enough) break;
    }
    return best;
}

}  // namespace ricci
