#include "engine/shape_space/closed_geodesic.h"

#include <algorithm>
#include <cmath>

namespace ricci {
namespace {

constexpr double kSame = 1e-6;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A crossing by its parameters along both curves.
struct Crossing {
    double first, second;
};

double circular_difference(double x, double y, double length) {
    const double d = std::remainder(x - y, length);
    return std::abs(d);
}

/// Crossings of x and y within the radii of vertices, once each.
std::vector<Crossing> crossing_points(const ClosedGeodesic& x, const ClosedGeodesic& y,
                                      const CoarseSurface& s, bool itself) {
    std::vector<Crossing> found;
    for (std::size_t i = 0; i < x.passes.size(); ++i)
        for (std::size_t j = itself ? i + 1 : 0; j < y.passes.size(); ++j) {
            const GeodesicPass &p = x.passes[i], &q = y.passes[j];
            if (p.vertex != q.vertex) continue;
            if (!lines_cross(p.normal, q.normal)) continue;
            const Minkowski meet = line_crossing(-1, p.normal, q.normal);
            if (meet[2] > std::cosh(s.radius[at(p.vertex)]) * (1 + 1e-7)) continue;
            const Crossing c{p.offset + foot_parameter(p.normal, meet),
                             q.offset + foot_parameter(q.normal, meet)};
            const bool known = std::any_of(found.begin(), found.end(), [&](const Crossing& f) {
                const auto same = [&](double a, double b) {
                    return circular_difference(a, f.first, x.length) < kSame &&
                           circular_difference(b, f.second, y.length) < kSame;
                };
                return same(c.first, c.second) || (itself && same(c.second, c.first));
            });
            if (!known) found.push_back(c);
        }
    return found;
}

}  // namespace

double foot_parameter(const Minkowski& n, const Minkowski& point) {
    const double size = std::sqrt(1 + n[2] * n[2]);
    const double along = (point[0] * n[1] - point[1] * n[0]) / size;  // <point, direction at the foot>
    const double height = minkowski(n, point);
    return std::asinh(along / std::sqrt(1 + height * height));
}

bool lines_cross(const Minkowski& n, const Minkowski& m) {
    return std::abs(minkowski(n, m)) < 1 - 1e-10;
}

bool same_normal(const Minkowski& x, const Minkowski& y) {
    double size = 1, difference = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        size = std::max(size, std::abs(x[k]));
        difference = std::max(difference, std::abs(x[k] - y[k]));
    }
    return difference < kSame * size;
}

Isometry<double> translation_along(const Minkowski& n, double length) {
    const double sine = std::sinh(length / 2);
    return {{std::cosh(length / 2), sine * n[2]}, {sine * n[1], -sine * n[0]}};
}

namespace {

/// Passes as they are found, with offsets that are not yet taken modulo the length, and the integrals of the
/// cocycles up to them.
class Follower {
  public:
    Follower(const CoarseSurface& surface, double length, std::span<const Cocycle> cocycles)
        : s_(surface), cocycles_(cocycles) {
        g_.length = length;
        g_.periods.assign(cocycles.size(), 0);
    }

    ClosedGeodesic follow(Index vertex, const Minkowski& normal) {
        g_.passes.push_back({vertex, normal, 0.0});
        integrals_.assign(cocycles_.size(), 0);
        for (std::size_t k = 0; k < g_.passes.size(); ++k)
            for_neighbours(s_, g_.passes[k].vertex, [&](CoarseStep step, Index w) { arrive(k, step, w); });
        for (GeodesicPass& p : g_.passes) p.offset -= g_.length * std::floor(p.offset / g_.length);
        return std::move(g_);
    }

  private:
    void arrive(std::size_t from, CoarseStep step, Index to) {
        const GeodesicPass origin = g_.passes[from];
        const Isometry<double> move = s_.along(step);
        const Minkowski n = apply(-1, inverse(move), origin.normal);
        if (std::abs(n[2]) > std::sinh(s_.radius[at(to)]) * (1 + 1e-9)) return;
        const double offset = origin.offset + foot_parameter(origin.normal, image_of_origin(-1, move));
        for (std::size_t k = 0; k < g_.passes.size(); ++k)
            if (g_.passes[k].vertex == to && same_normal(g_.passes[k].normal, n)) {
                close(from, k, offset, step);
                return;
            }
        g_.passes.push_back({to, n, offset});
        for (std::size_t c = 0; c < cocycles_.size(); ++c)
            integrals_.push_back(integrals_[from * cocycles_.size() + c] + value(cocycles_[c], step));
    }

    static Index value(const Cocycle& cocycle, CoarseStep step) {
        return step >= 0 ? cocycle[at(step)] : -cocycle[at(~step)];
    }

    /// A pass that is known already: if it lies a whole turn away, the integrals there are periods.
    void close(std::size_t from, std::size_t known, double offset, CoarseStep step) {
        if (closed_ || cocycles_.empty()) return;
        const double turns = (offset - g_.passes[known].offset) / g_.length;
        if (std::abs(std::abs(turns) - 1) > 1e-3) return;
        closed_ = true;
        for (std::size_t c = 0; c < cocycles_.size(); ++c) {
            const Index around = integrals_[from * cocycles_.size() + c] + value(cocycles_[c], step) -
                                 integrals_[known * cocycles_.size() + c];
            g_.periods[c] = turns > 0 ? around : -around;
        }
    }

    const CoarseSurface& s_;
    std::span<const Cocycle> cocycles_;
    ClosedGeodesic g_;
    std::vector<Index> integrals_;  // per pass and cocycle
    bool closed_ = false;
};

}  // namespace

ClosedGeodesic follow_geodesic(const CoarseSurface& s, Index vertex, const Minkowski& normal, double length,
                               std::span<const Cocycle> cocycles) {
    return Follower(s, length, cocycles).follow(vertex, normal);
}

std::optional<Meeting> nearest_meeting(const ClosedGeodesic& x, const ClosedGeodesic& y) {
    std::optional<Meeting> best;
    for (const GeodesicPass& p : x.passes)
        for (const GeodesicPass& q : y.passes) {
            if (p.vertex != q.vertex || !lines_cross(p.normal, q.normal)) continue;
            const Minkowski point = line_crossing(-1, p.normal, q.normal);
            if (!best || point[2] < best->point[2]) best = Meeting{p.vertex, p.normal, q.normal, point};
        }
    return best;
}

Index crossings(const ClosedGeodesic& x, const ClosedGeodesic& y, const CoarseSurface& surface) {
    return static_cast<Index>(crossing_points(x, y, surface, false).size());
}

Index self_crossings(const ClosedGeodesic& x, const CoarseSurface& surface) {
    return static_cast<Index>(crossing_points(x, x, surface, true).size());
}

}  // namespace ricci
