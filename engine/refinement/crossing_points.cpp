#include "engine/refinement/crossing_points.h"

#include <array>
#include <cmath>

namespace ricci {
namespace {

using Real = long double;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

struct Vector {
    Real x = 0, y = 0;
};
Vector operator-(Vector a, Vector b) {
    return {a.x - b.x, a.y - b.y};
}
Real cross(Vector a, Vector b) {
    return a.x * b.y - a.y * b.x;
}

/// Third corner of a triangle, to the left of p -> q, at the given distances from p and q.
Vector apex(Vector p, Vector q, Real from_p, Real from_q) {
    const Vector d = q - p;
    const Real base = std::hypot(d.x, d.y);
    const Real foot = (base * base + (from_p - from_q) * (from_p + from_q)) / (2 * base);
    // Height by Heron in Kahan's order.
    Real a = base, b = from_p, c = from_q;
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    const Real product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    const Real height = std::sqrt(std::max(product, Real(0))) / (2 * base);
    const Real ux = d.x / base, uy = d.y / base;
    return {p.x + foot * ux - height * uy, p.y + foot * uy + height * ux};
}

/// The strip of faces along one curve, unfolded: for each crossing the ends of the crossed halfedge (tail to
/// the right of the curve, head to the left), and the curve's end; it starts at the origin.
struct Strip {
    std::vector<std::array<Vector, 2>> gate;
    Vector end;
};

Strip unfold(const Connectivity& c, std::span<const Real> log_length, std::span<const Crossing> path) {
    Strip strip;
    const auto length = [&](Index h) { return std::exp(log_length[at(h)]); };
    Index h = path.front().halfedge;
    // The start lies opposite the first gate; the gate's tail is put on the x axis.
    Vector tail{length(prev_halfedge(h)), 0};
    Vector head = apex({0, 0}, tail, length(next_halfedge(h)), length(h));
    for (std::size_t k = 0;; ++k) {
        strip.gate.push_back({tail, head});
        const Index t = c.twin[at(h)];  // from head to tail, the next face on its left
        const Vector far = apex(head, tail, length(prev_halfedge(t)), length(next_halfedge(t)));
        if (k + 1 == path.size()) {
            strip.end = far;
            return strip;
        }
        h = path[k + 1].halfedge;
        // next(t) starts at `tail` and ends at `far`; prev(t) runs from `far` to `head`.
        if (h == next_halfedge(t)) {
            head = far;
        } else {
            tail = far;
        }
    }
}

}  // namespace

std::vector<CrossingPoint> straight_crossings(const Connectivity& c, std::span<const Real> log_length,
                                              const CurvePaths& paths) {
    std::vector<CrossingPoint> points;
    points.reserve(paths.crossing.size());
    for (Index e = 0; e + 1 < static_cast<Index>(paths.first.size()); ++e) {
        const std::span<const Crossing> path = paths.of(e);
        if (path.empty()) continue;
        const Strip strip = unfold(c, log_length, path);
        for (const auto& [tail, head] : strip.gate) {
            const Real right = -cross(strip.end, tail), left = cross(strip.end, head);
            CrossingPoint point;
            point.on_edge = right / (right + left);
            point.on_curve = cross(tail, head - tail) / cross(strip.end, head - tail);
            points.push_back(point);
        }
    }
    return points;
}

std::vector<CrossingPoint> ideal_crossings(const Connectivity& c, std::span<const Real> log_chord,
                                           std::span<const double> u, const CurvePaths& paths) {
    // Chords in the metric u, in which the current triangulation is well shaped.
    const auto chord = [&](Index h) {
        const Real sum = static_cast<Real>(u[at(c.tail[at(h)])]) + static_cast<Real>(u[at(c.head(h))]);
        return std::exp(log_chord[at(h)] + sum / 2);
    };
    struct Ends {
        Real tail, head;  // lambda from one end of the curve to the ends of the crossed halfedge
    };
    std::vector<CrossingPoint> points;
    points.reserve(paths.crossing.size());
    std::vector<Ends> from_start, from_end;
    for (Index e = 0; e + 1 < static_cast<Index>(paths.first.size()); ++e) {
        const std::span<const Crossing> path = paths.of(e);
        if (path.empty()) continue;
        const std::size_t n = path.size();
        from_start.resize(n);
        from_end.resize(n);
        // Distances to the far corner of the face behind a gate: lambda_in lambda_kl = lambda_ik lambda_ln +
        // lambda_il lambda_kn.
        const auto beyond = [&](Ends near, Index gate, Index behind) {
            return (near.tail * chord(prev_halfedge(behind)) + near.head * chord(next_halfedge(behind))) /
                   chord(gate);
        };
        const Index first = path.front().halfedge;
        from_start[0] = {chord(prev_halfedge(first)), chord(next_halfedge(first))};
        Real whole = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const Index h = path[k].halfedge, t = c.twin[at(h)];
            const Real far = beyond(from_start[k], h, t);
            if (k + 1 == n) {
                whole = far;
            } else if (path[k + 1].halfedge == next_halfedge(t)) {
                from_start[k + 1] = {from_start[k].tail, far};
            } else {
                from_start[k + 1] = {far, from_start[k].head};
            }
        }
        const Index last = c.twin[at(path.back().halfedge)];  // from head to tail of the last gate
        from_end[n - 1] = {chord(next_halfedge(last)), chord(prev_halfedge(last))};
        for (std::size_t k = n - 1; k > 0; --k) {
            const Index h = path[k].halfedge, near = path[k - 1].halfedge, t = c.twin[at(near)];
            // Behind gate k, seen from the end, lies the face of h; its corner opposite h is an end of gate k
            // - 1.
            const Real beyond_h =
                (from_end[k].tail * chord(next_halfedge(h)) + from_end[k].head * chord(prev_halfedge(h))) /
                chord(h);
            from_end[k - 1] =
                h == next_halfedge(t) ? Ends{from_end[k].tail, beyond_h} : Ends{beyond_h, from_end[k].head};
        }
        const auto scale = [&](Index v) { return std::exp(static_cast<Real>(u[at(v)])); };
        const Index start = c.tail[at(prev_halfedge(first))], end = c.tail[at(prev_halfedge(last))];
        for (std::size_t k = 0; k < n; ++k) {
            const Index h = path[k].halfedge;
            const Ends i = from_start[k], j = from_end[k];
            // In the metric u; v = exp(-u) times the scaled vector at the curve's ends.
            const Real weight_i = j.tail * j.head * scale(start), weight_j = i.tail * i.head * scale(end);
            const Real common = whole / (chord(h) * (weight_i + weight_j));
            points.push_back(
                {weight_j / (weight_i + weight_j), 0, common * i.head * j.head, common * i.tail * j.tail});
        }
    }
    return points;
}

}  // namespace ricci
