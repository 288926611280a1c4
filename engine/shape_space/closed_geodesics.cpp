#include "engine/shape_space/closed_geodesics.h"

#include <algorithm>
#include <cmath>

#include "engine/shape_space/line_table.h"
#include "engine/shape_space/unfolding.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

struct Candidate {
    double length;
    Index vertex;
    Minkowski normal;
};

}  // namespace

std::vector<AxisAt> axes_at(const CoarseSurface& s, Index vertex, double max_length, std::int64_t& budget) {
    const double radius = s.radius[at(vertex)] * (1 + 1e-9);
    const double distance = 2 * std::asinh(std::cosh(radius) * std::sinh(max_length / 2)) * (1 + 1e-12);
    std::vector<AxisAt> axes;
    Unfolding unfolding(s);
    const double cosine = std::cosh(max_length / 2) * (1 + 1e-14), sine = std::sinh(radius);
    const bool whole = unfolding.visit(vertex, distance, budget, [&](Index v, const Isometry<double>& x) {
        if (v != vertex || std::abs(x.a.re) > cosine) return;
        const double length = translation_length(x);
        if (length <= 0 || length > max_length) return;
        const Minkowski normal = axis_normal(x);
        if (std::abs(normal[2]) <= sine) axes.push_back({length, normal, x});
    });
    budget -= unfolding.crossed();
    if (!whole) budget = -1;
    std::sort(axes.begin(), axes.end(), [](const AxisAt& x, const AxisAt& y) {
        return x.length != y.length ? x.length < y.length : x.normal < y.normal;
    });
    // Powers, inverses and what was met twice share their line with one that comes before.
    LineTable lines;
    std::vector<AxisAt> distinct;
    for (const AxisAt& a : axes) {
        if (lines.find(vertex, a.normal) >= 0) continue;
        lines.insert(vertex, a.normal, static_cast<Index>(distinct.size()));
        distinct.push_back(a);
    }
    return distinct;
}

ClosedGeodesics find_closed_geodesics(const CoarseSurface& s, double max_length, std::int64_t budget,
                                      std::span<const Cocycle> cocycles) {
    ClosedGeodesics found;
    const std::int64_t allowed = budget;
    std::vector<Candidate> candidates;
    for (Index v = 0; v < s.connectivity.vertex_count; ++v) {
        for (const AxisAt& a : axes_at(s, v, max_length, budget))
            candidates.push_back({a.length, v, a.normal});
        if (budget < 0) return found;
    }
    found.crossed = allowed - budget;
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
        return x.length != y.length   ? x.length < y.length
               : x.vertex != y.vertex ? x.vertex < y.vertex
                                      : x.normal < y.normal;
    });
    LineTable enumerated, taken;
    for (const Candidate& c : candidates) enumerated.insert(c.vertex, c.normal, 0);
    std::vector<double>
        nearest;  // per geodesic: its distance from the vertex that its length was measured at
    for (const Candidate& c : candidates) {
        const double distance = std::abs(c.normal[2]);
        if (const Index known = taken.find(c.vertex, c.normal); known >= 0) {
            // Of lengths that differ by rounding the one from the nearest vertex is the most exact.
            if (distance >= nearest[at(known)]) continue;
            nearest[at(known)] = distance;
            found.primitive[at(known)].length = c.length;
            continue;
        }
        ClosedGeodesic g = follow_geodesic(s, c.vertex, c.normal, c.length, cocycles);
        for (const GeodesicPass& p : g.passes) {
            taken.insert(p.vertex, p.normal, static_cast<Index>(found.primitive.size()));
            if (enumerated.find(p.vertex, p.normal) < 0) ++found.missed;
        }
        found.primitive.push_back(std::move(g));
        nearest.push_back(distance);
    }
    std::sort(found.primitive.begin(), found.primitive.end(),
              [](const ClosedGeodesic& x, const ClosedGeodesic& y) { return x.length < y.length; });
    found.complete_up_to = max_length;
    return found;
}

}  // namespace ricci
