// The universal cover of a coarse surface around a vertex.
#pragma once

#include <cmath>
#include <vector>

#include "engine/flow/cancellation.h"
#include "engine/shape_space/coarse_surface.h"

namespace ricci {

/// The view from a vertex p along geodesics: every lift of every vertex within a distance is met, since a
/// straight segment leads there. A node is an edge a->b seen through the window between two rays, p on its
/// left. A vertex on a ray exactly may be met twice.
class Unfolding {
  public:
    explicit Unfolding(const CoarseSurface& surface) : surface_(&surface) {}

    /// Calls visit(vertex, isometry) for every lift of a vertex within `distance` of that of `from`, itself
    /// left out; the isometry takes the frame of the vertex to that of the lift, in the frame of `from`.
    /// Stops and returns false where more than `budget` edges would be crossed. Throws Cancelled.
    template <class Visit>
    bool visit(Index from, double distance, std::int64_t budget, Visit&& visit);

    /// Edges crossed so far.
    [[nodiscard]] std::int64_t crossed() const { return crossed_; }

  private:
    using Direction = std::array<double, 2>;
    struct Window {
        Index halfedge;               // a -> b in the face on p's side
        Isometry<double> tail, head;  // frames of a and b
        Direction right, left;        // limits of the window, unit or not
    };
    static double cross(const Direction& u, const Direction& v) { return u[0] * v[1] - u[1] * v[0]; }
    static Direction towards(const Isometry<double>& x) {
        const Complex<double> p = x.b * x.a;
        return {p.re, p.im};
    }
    [[nodiscard]] bool beyond(const Window& w, double sine) const;

    const CoarseSurface* surface_;
    std::vector<Window> stack_;
    std::int64_t crossed_ = 0;
};

/// Whether no point of the edge within the window is nearer than a distance with this hyperbolic sine.
inline bool Unfolding::beyond(const Window& w, double sine) const {
    const std::array<double, 3> a = image_of_origin(-1, w.tail), b = image_of_origin(-1, w.head);
    // The edge's line: m . x = m_t t. A ray in the unit direction u meets it where tanh d = m_t / (m . u), so
    // that sinh^2 d = m_t^2 / ((m . u)^2 - m_t^2), and (m . u)^2 - m_t^2 = sinh^2 l - (m x u)^2, l the edge's
    // length.
    const Direction m{b[1] * a[2] - a[1] * b[2], a[0] * b[2] - b[0] * a[2]};
    const double mt = a[0] * b[1] - a[1] * b[0];
    const double s = surface_->half_chord[static_cast<std::size_t>(w.halfedge)];
    const double edge2 = 4 * s * s * (1 + s * s);
    double nearest = edge2;  // the largest of these in the window: where the foot of the perpendicular is
    if (!(cross(w.right, m) >= 0 && cross(m, w.left) >= 0)) {
        const auto along = [&](const Direction& u) {
            if (m[0] * u[0] + m[1] * u[1] <= 0) return 0.0;
            const double across = cross(m, u);
            return edge2 - across * across / (u[0] * u[0] + u[1] * u[1]);
        };
        nearest = std::max(along(w.right), along(w.left));
    }
    return mt > 0 && mt * mt > sine * sine * (nearest + 1e-9 * edge2);
}

template <class Visit>
bool Unfolding::visit(Index from, double distance, std::int64_t budget, Visit&& visit) {
    const CoarseSurface& s = *surface_;
    const Connectivity& c = s.connectivity;
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    const double sine = std::sinh(distance), farthest = std::cosh(distance) * (1 + 1e-12);
    const std::int64_t last = crossed_ + budget;
    stack_.clear();
    const Index first = s.outgoing[at(from)];
    for (Index h = first; h != kNoTwin;) {
        const Index in = prev_halfedge(h);
        Window w{next_halfedge(h), s.step[at(h)], {}, {}, {}};
        w.head = compose(-1, s.step[at(h)], s.step[at(next_halfedge(h))]);
        w.right = towards(w.tail);
        w.left = towards(w.head);
        // The edges at p themselves: each once, the last of the boundary by its face.
        const auto meet = [&](Index vertex, const Isometry<double>& x) {
            if (squared(x.a) + squared(x.b) <= farthest) visit(vertex, x);
        };
        meet(c.head(h), w.tail);
        if (c.twin[at(in)] == kNoTwin) meet(c.tail[at(in)], w.head);
        stack_.push_back(w);
        h = c.twin[at(in)];
        if (h == first) break;
    }
    while (!stack_.empty()) {
        const Window w = stack_.back();
        stack_.pop_back();
        const Index t = c.twin[at(w.halfedge)];
        if (t == kNoTwin || beyond(w, sine)) continue;
        if (++crossed_ > last) return false;
        cancellation_point(crossed_);
        const Index ac = next_halfedge(t), cb = prev_halfedge(t);
        const Isometry<double> apex = compose(-1, w.tail, s.step[at(ac)]);
        const Direction u = towards(apex);
        const double from_right = cross(w.right, u), to_left = cross(u, w.left);
        const double size = 1e-9 * std::sqrt(u[0] * u[0] + u[1] * u[1]);
        const auto length = [](const Direction& d) { return std::sqrt(d[0] * d[0] + d[1] * d[1]); };
        if (from_right >= -size * length(w.right) && to_left >= -size * length(w.left) &&
            squared(apex.a) + squared(apex.b) <= farthest)
            visit(c.tail[at(cb)], apex);
        if (from_right > 0) stack_.push_back({ac, w.tail, apex, w.right, to_left > 0 ? u : w.left});
        if (to_left > 0) stack_.push_back({cb, apex, w.head, from_right > 0 ? u : w.right, w.left});
    }
    return true;
}

}  // namespace ricci
