#include "engine/shape_space/thinning.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/shape_space/hyperbolic_triangle.h"
#include "kernels/edge_flip.h"

namespace ricci {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kFlat = 1e-9;  // sine of an angle that makes no triangle

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

double wrapped(double direction) {
    return direction < 0 ? direction + kTurn : direction >= kTurn ? direction - kTurn : direction;
}

double radians(const Complex<double>& angle) {
    return std::atan2(angle.im, angle.re);
}

}  // namespace

Thinning::Thinning(const HyperbolicTriangulation& fine)
    : c_(fine.connectivity),
      half_chord_(fine.half_chord),
      half_cosine_(fine.half_chord.size()),
      direction_(fine.half_chord.size(), 0.0),
      angle_(fine.half_chord.size()),
      alive_(at(fine.connectivity.face_count()), 1),
      outgoing_(at(fine.connectivity.vertex_count), kNoTwin) {
    for (std::size_t h = 0; h < half_chord_.size(); ++h)
        half_cosine_[h] = std::sqrt(1 + half_chord_[h] * half_chord_[h]);
    for (Index f = 0; f < c_.face_count(); ++f) update_angles(f);
    for (Index h = 0; h < c_.halfedge_count(); ++h) {
        Index& out = outgoing_[at(c_.tail[at(h)])];
        if (out == kNoTwin || c_.twin[at(h)] == kNoTwin) out = h;
    }
    reference_ = outgoing_;
    set_directions();
}

void Thinning::set_directions() {
    for (const Index first : outgoing_) {
        if (first == kNoTwin) continue;
        double direction = 0.0;
        for (Index h = first;;) {
            direction_[at(h)] = direction;
            direction += radians(angle_[at(h)]);
            h = turned(h);
            if (h == kNoTwin || h == first) break;
        }
    }
}

Index Thinning::turned(Index h) const {
    return c_.twin[at(prev_halfedge(h))];
}

void Thinning::update_angles(Index face) {
    const std::size_t h = 3 * at(face);
    const std::array<Complex<double>, 3> angle =
        triangle_angles({half_chord_[h], half_chord_[h + 1], half_chord_[h + 2]});
    std::copy(angle.begin(), angle.end(), angle_.begin() + static_cast<std::ptrdiff_t>(h));
}

/// kl, in the triangles (i, j, k) left of h and (j, i, l) right of it, from the two sides at i.
double Thinning::new_half_chord(Index h) const {
    const Index il = next_halfedge(c_.twin[at(h)]), ik = prev_halfedge(h);
    return third_half_chord(half_chord_[at(il)], half_chord_[at(ik)], angle_[at(h)] * angle_[at(il)]);
}

/// The determinant of the other three corners, as seen from the tail, on the hyperboloid.
bool Thinning::delaunay(Index h) const {
    const Index t = c_.twin[at(h)], il = next_halfedge(t), ik = prev_halfedge(h);
    const Complex<double>&left = angle_[at(h)], &right = angle_[at(il)];
    const double sj = half_chord_[at(h)], cj = half_cosine_[at(h)], sk = half_chord_[at(ik)],
                 ck = half_cosine_[at(ik)], sl = half_chord_[at(il)], cl = half_cosine_[at(il)];
    const double plus = cj * (ck * sl * left.im + sk * cl * right.im),
                 minus = sj * ck * cl * (left.re * right.im + left.im * right.re);
    return plus - minus > -1e-9 * (plus + std::abs(minus));
}

/// The smaller sine of the quadrilateral's angles at both ends of h: positive where it is convex.
double Thinning::convexity(Index h) const {
    const Index t = c_.twin[at(h)];
    const Complex<double> tail = angle_[at(h)] * angle_[at(next_halfedge(t))],
                          head = angle_[at(next_halfedge(h))] * angle_[at(t)];
    return std::min(tail.im, head.im);
}

void Thinning::flip(Index h) {
    const Index t = c_.twin[at(h)], nh = next_halfedge(h), nt = next_halfedge(t);
    const Index i = c_.tail[at(h)], j = c_.tail[at(t)];
    const double chord = new_half_chord(h);
    if (outgoing_[at(i)] == nt) outgoing_[at(i)] = h;
    if (outgoing_[at(j)] == nh) outgoing_[at(j)] = t;
    flip_edge(c_, h);
    const auto move = [&](Index from, Index to) {
        half_chord_[at(to)] = half_chord_[at(from)];
        half_cosine_[at(to)] = half_cosine_[at(from)];
        direction_[at(to)] = direction_[at(from)];
    };
    move(nt, h);
    move(nh, t);
    half_chord_[at(nh)] = half_chord_[at(nt)] = chord;
    half_cosine_[at(nh)] = half_cosine_[at(nt)] = std::sqrt(1 + chord * chord);
    update_angles(face_of(h));
    update_angles(face_of(t));
    const Index ph = prev_halfedge(h), pt = prev_halfedge(t);
    direction_[at(nh)] = wrapped(direction_[at(pt)] + radians(angle_[at(pt)]));
    direction_[at(nt)] = wrapped(direction_[at(ph)] + radians(angle_[at(ph)]));
}

std::vector<Index> Thinning::star(Index v) const {
    std::vector<Index> halfedges;
    const Index first = outgoing_[at(v)];
    for (Index h = first; h != kNoTwin;) {
        halfedges.push_back(h);
        h = turned(h);
        if (h == first) break;
    }
    return halfedges;
}

/// Flips an edge at v so that fewer edges end there: of those whose quadrilateral is convex the one that is
/// farthest from flat at its corners. (Where loops are about, a flip may bring another edge to v; such flips
/// lead round and round to ever longer edges.)
bool Thinning::flip_best(Index v, const std::vector<Index>& star) {
    Index best = kNoTwin;
    double margin = kFlat;
    for (const Index h : star) {
        const Index t = c_.twin[at(h)];
        if (t == kNoTwin || face_of(t) == face_of(h)) continue;
        const int lost = 1 + (c_.tail[at(t)] == v ? 1 : 0),
                  gained = (c_.tail[at(prev_halfedge(h))] == v ? 1 : 0) +
                           (c_.tail[at(prev_halfedge(t))] == v ? 1 : 0);
        if (gained >= lost) continue;
        const double convex = convexity(h);
        if (convex > margin) {
            margin = convex;
            best = h;
        }
    }
    if (best == kNoTwin) return false;
    const Index t = c_.twin[at(best)];
    flip(best);
    for (const Index h : {best, t})
        for (const Index e : {h, next_halfedge(h), prev_halfedge(h)}) pending_.push_back(e);
    return true;
}

/// Joins the last three faces about an inner vertex, or the last two about one of the boundary, into one.
void Thinning::drop(const std::vector<Index>& star, bool inner) {
    struct Side {
        Index old = kNoTwin, twin = kNoTwin, tail = 0, edge = 0;
        double chord = 0, cosine = 0, direction = 0;
    };
    const auto side = [&](Index h) {
        return Side{h,
                    c_.twin[at(h)],
                    c_.tail[at(h)],
                    c_.edge[at(h)],
                    half_chord_[at(h)],
                    half_cosine_[at(h)],
                    direction_[at(h)]};
    };
    const Index slot = 3 * face_of(star[0]);
    std::array<Side, 3> sides{side(next_halfedge(star[0])), side(next_halfedge(star[1])), {}};
    if (inner) {
        sides[2] = side(next_halfedge(star[2]));
    } else {
        const Index last = prev_halfedge(star[1]);  // x2 -> v, and on v -> x0, straight
        sides[2] = side(last);
        const double s = half_chord_[at(last)], c = half_cosine_[at(last)], s0 = half_chord_[at(star[0])],
                     c0 = half_cosine_[at(star[0])];
        sides[2].chord = s * c0 + c * s0;
        sides[2].cosine = c * c0 + s * s0;
    }
    outgoing_[at(c_.tail[at(star[0])])] = kNoTwin;
    const std::array<Index, 3> arriving{inner ? prev_halfedge(star[2]) : kNoTwin, prev_halfedge(star[0]),
                                        prev_halfedge(star[1])};  // to v from the tails of the sides
    for (std::size_t k = 0; k < star.size(); ++k) alive_[at(face_of(star[k]))] = 0;
    alive_[at(face_of(slot))] = 1;
    // All are looked at before any changes: corners may be one vertex, and new numbers are old ones.
    std::array<bool, 3> moves{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Index out = outgoing_[at(sides[k].tail)];
        moves[k] = out != kNoTwin && (out == sides[k].old || out == arriving[k]);
    }
    for (std::size_t k = 0; k < 3; ++k)
        if (moves[k]) outgoing_[at(sides[k].tail)] = slot + static_cast<Index>(k);
    for (std::size_t k = 0; k < 3; ++k) {
        const Index h = slot + static_cast<Index>(k);
        Index twin = sides[k].twin;
        for (std::size_t m = 0; m < 3; ++m)
            if (twin != kNoTwin && twin == sides[m].old) twin = slot + static_cast<Index>(m);
        sides[k].twin = twin;
        c_.tail[at(h)] = sides[k].tail;
        c_.edge[at(h)] = sides[k].edge;
        half_chord_[at(h)] = sides[k].chord;
        half_cosine_[at(h)] = sides[k].cosine;
        direction_[at(h)] = sides[k].direction;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const Index h = slot + static_cast<Index>(k), twin = sides[k].twin;
        c_.twin[at(h)] = twin;
        if (twin != kNoTwin) c_.twin[at(twin)] = h;
    }
    update_angles(face_of(slot));
    for (Index h = slot; h < slot + 3; ++h) pending_.push_back(h);
}

/// Between edges that rounding finds not Delaunay either way round, flips would go on for ever: then they
/// stop. The triangulation is a right one all the same; its covering radii are measured, not taken for
/// granted.
void Thinning::restore() {
    for (std::size_t tests = 1000 + 100 * pending_.size(); !pending_.empty() && tests > 0; --tests) {
        const Index h = pending_.back();
        pending_.pop_back();
        const Index t = c_.twin[at(h)];
        if (!alive(face_of(h)) || t == kNoTwin || face_of(t) == face_of(h) || delaunay(h)) continue;
        if (convexity(h) <= kFlat) continue;  // rounding: a quadrilateral that is not Delaunay is convex
        flip(h);
        for (const Index e : {h, t, prev_halfedge(h), prev_halfedge(t)}) pending_.push_back(e);
    }
    pending_.clear();
}

void Thinning::set_half_chord(Index h, double chord) {
    half_chord_[at(h)] = chord;
    half_cosine_[at(h)] = std::sqrt(1 + chord * chord);
}

Index Thinning::new_face() {
    const auto h = static_cast<Index>(c_.tail.size());
    for (auto* list : {&c_.tail, &c_.twin, &c_.edge}) list->resize(at(h) + 3, kNoTwin);
    for (auto* list : {&half_chord_, &half_cosine_, &direction_}) list->resize(at(h) + 3);
    angle_.resize(at(h) + 3);
    alive_.push_back(1);
    return h;
}

/// (i, j, k) with h = i->j becomes (i, m, k) in place and (m, j, k), m in the middle of ij; so on the other
/// side.
void Thinning::split(Index h) {
    const Index m = c_.vertex_count++;
    outgoing_.push_back(kNoTwin);
    reference_.push_back(kNoTwin);
    const Index sides[2] = {h, c_.twin[at(h)]};
    Index far[2] = {kNoTwin, kNoTwin};  // on either side, the new half next to its head
    const double quarter = halved(half_chord_[at(h)]);
    const Index edges = c_.edge_count;
    c_.edge_count += sides[1] == kNoTwin ? 2 : 3;
    for (std::size_t k = 0; k < 2 && sides[k] != kNoTwin; ++k) {
        const Index near = sides[k], jk = next_halfedge(near), ki = prev_halfedge(near), j = c_.tail[at(jk)];
        const double to_far = median(near);
        const Index mj = new_face(), moved = mj + 1, km = mj + 2;
        far[k] = mj;
        c_.tail[at(mj)] = m;
        c_.tail[at(moved)] = j;
        c_.tail[at(km)] = c_.tail[at(ki)];
        if (outgoing_[at(j)] == jk) outgoing_[at(j)] = moved;
        set_half_chord(moved, half_chord_[at(jk)]);
        direction_[at(moved)] = direction_[at(jk)];
        c_.edge[at(moved)] = c_.edge[at(jk)];
        c_.twin[at(moved)] = c_.twin[at(jk)];
        if (c_.twin[at(jk)] != kNoTwin) c_.twin[at(c_.twin[at(jk)])] = moved;
        c_.tail[at(jk)] = m;  // now m -> k
        c_.twin[at(jk)] = km;
        c_.twin[at(km)] = jk;
        c_.edge[at(jk)] = c_.edge[at(km)] = edges + 1 + static_cast<Index>(k);
        for (const Index e : {near, mj}) set_half_chord(e, quarter);
        for (const Index e : {jk, km}) set_half_chord(e, to_far);
        update_angles(face_of(near));
        update_angles(face_of(mj));
        direction_[at(km)] = wrapped(direction_[at(ki)] + radians(angle_[at(ki)]));
        for (const Index e : {near, jk, ki, mj, moved, km}) pending_.push_back(e);
    }
    // Halves of the edge: h (i->m) and far[0] (m->j); twin (j->m) and far[1] (m->i).
    c_.edge[at(far[0])] = edges;
    outgoing_[at(m)] = far[0];
    if (sides[1] != kNoTwin) {
        const auto pair = [&](Index x, Index y) {
            c_.twin[at(x)] = y;
            c_.twin[at(y)] = x;
        };
        pair(h, far[1]);
        pair(far[0], sides[1]);
        c_.edge[at(sides[1])] = edges;
        c_.edge[at(far[1])] = c_.edge[at(h)];
    }
    double direction = 0.0;
    for (const Index e : star(m)) {
        direction_[at(e)] = direction;
        direction += radians(angle_[at(e)]);
    }
    restore();
}

double Thinning::covering_radius(Index face) const {
    const std::size_t h = 3 * at(face);
    return ricci::covering_radius({half_chord_[h], half_chord_[h + 1], half_chord_[h + 2]},
                                  {angle_[h], angle_[h + 1], angle_[h + 2]});
}

/// First the boundary, so that edges beside it give way to others that end there; then what is long inside.
/// Points much closer to others than `largest` would only make needles.
void Thinning::limit_radius(double largest) {
    const double half_chord = std::sinh(largest);
    for (Index h = 0; h < c_.halfedge_count(); ++h)
        while (alive(face_of(h)) && c_.twin[at(h)] == kNoTwin && half_chord_[at(h)] > half_chord) split(h);
    std::vector<Index> open;
    for (Index f = 0; f < c_.face_count(); ++f) open.push_back(f);
    for (std::size_t k = 0; k < open.size(); ++k) {
        const Index f = open[k];
        if (!alive(f) || !(covering_radius(f) > largest)) continue;
        const Index h = longest_side(f);
        if (h == kNoTwin) continue;
        const Index t = c_.twin[at(h)];
        if (std::min(median(h), t == kNoTwin ? median(h) : median(t)) < std::sinh(largest / 6)) continue;
        split(h);
        for (const Index e : star(c_.vertex_count - 1)) open.push_back(face_of(e));  // all that changed
    }
}

/// Of a face that is glued to itself along two sides it is the third.
Index Thinning::longest_side(Index face) const {
    Index longest = kNoTwin;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
        const Index t = c_.twin[at(h)];
        if (t != kNoTwin && face_of(t) == face) continue;
        if (longest == kNoTwin || half_chord_[at(h)] > half_chord_[at(longest)]) longest = h;
    }
    return longest;
}

/// Half chord from the middle of h to the opposite corner.
double Thinning::median(Index h) const {
    return third_half_chord(halved(half_chord_[at(h)]), half_chord_[at(prev_halfedge(h))], angle_[at(h)]);
}

void Thinning::make_delaunay() {
    for (Index h = 0; h < c_.halfedge_count(); ++h)
        if (alive(face_of(h)) && h > c_.twin[at(h)]) pending_.push_back(h);
    restore();
}

bool Thinning::remove(Index v) {
    std::vector<Index> halfedges = star(v);
    if (halfedges.empty()) return false;
    const bool inner = c_.twin[at(prev_halfedge(halfedges.back()))] != kNoTwin;
    const std::size_t last = inner ? 3 : 2;
    for (;;) {
        bool loop = false;
        for (const Index h : halfedges) loop = loop || c_.head(h) == v;
        if (!inner) loop = loop || c_.tail[at(prev_halfedge(halfedges.back()))] == v;
        if (halfedges.size() == last && !loop) {
            drop(halfedges, inner);
            restore();
            return true;
        }
        if (!flip_best(v, halfedges)) break;
        halfedges = star(v);
    }
    restore();
    return false;
}

}  // namespace ricci
