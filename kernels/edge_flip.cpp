#include "kernels/edge_flip.h"

#include <algorithm>
#include <cmath>

namespace ricci {
namespace {

std::size_t at(Index h) {
    return static_cast<std::size_t>(h);
}

}  // namespace

bool flippable(const Connectivity& connectivity, Index h) {
    const Index t = connectivity.twin[at(h)];
    return t != kNoTwin && face_of(t) != face_of(h);
}

void flip_edge(Connectivity& c, Index h) {
    const Index t = c.twin[at(h)];
    const Index hn = next_halfedge(h), hp = prev_halfedge(h);
    const Index tn = next_halfedge(t), tp = prev_halfedge(t);
    // Slot h takes over what tn was, slot t what hn was; a twin that pointed at a moved slot follows it.
    const auto moved = [&](Index x) { return x == tn ? h : (x == hn ? t : x); };
    const Index outer_tn = moved(c.twin[at(tn)]), outer_hn = moved(c.twin[at(hn)]);
    const Index diagonal = c.edge[at(h)];
    c.edge[at(h)] = c.edge[at(tn)];
    c.edge[at(t)] = c.edge[at(hn)];
    c.edge[at(hn)] = diagonal;
    c.edge[at(tn)] = diagonal;
    c.tail[at(hn)] = c.tail[at(tp)];
    c.tail[at(tn)] = c.tail[at(hp)];
    c.twin[at(h)] = outer_tn;
    if (outer_tn != kNoTwin) c.twin[at(outer_tn)] = h;
    c.twin[at(t)] = outer_hn;
    if (outer_hn != kNoTwin) c.twin[at(outer_hn)] = t;
    c.twin[at(hn)] = tn;
    c.twin[at(tn)] = hn;
}

template <class Real>
void flip_edge(Connectivity& c, std::span<Real> log_chord, Index h, Real new_log) {
    const Index t = c.twin[at(h)];
    const Index hn = next_halfedge(h), tn = next_halfedge(t);
    log_chord[at(h)] = log_chord[at(tn)];
    log_chord[at(t)] = log_chord[at(hn)];
    log_chord[at(hn)] = new_log;
    log_chord[at(tn)] = new_log;
    flip_edge(c, h);
}

template <class Real>
Real ptolemy_log(std::span<const Real> log_chord, const Connectivity& c, Index h) {
    const Index t = c.twin[at(h)];
    const Real jk = log_chord[at(next_halfedge(h))], ki = log_chord[at(prev_halfedge(h))];
    const Real il = log_chord[at(next_halfedge(t))], lj = log_chord[at(prev_halfedge(t))];
    const Real first = ki + lj, second = il + jk;
    const Real larger = std::max(first, second), smaller = std::min(first, second);
    return larger + std::log1p(std::exp(smaller - larger)) - log_chord[at(h)];
}

template <class Real>
Real unfolded_log(std::span<const Real> log_chord, const Connectivity& c, Index h) {
    const Index t = c.twin[at(h)];
    const Real unit = log_chord[at(h)];  // lengths relative to the edge: c = 1
    const Real a = std::exp(log_chord[at(next_halfedge(h))] - unit),
               b = std::exp(log_chord[at(prev_halfedge(h))] - unit);
    const Real d = std::exp(log_chord[at(next_halfedge(t))] - unit),
               e = std::exp(log_chord[at(prev_halfedge(t))] - unit);
    // Apex over the edge from (0,0) to (1,0), at distance `from_i` of the start and `from_j` of the end.
    const auto height = [](Real from_i, Real from_j) {
        Real x = Real(1), y = std::max(from_i, from_j), z = std::min(from_i, from_j);
        if (y > x) std::swap(x, y);
        if (z > y) std::swap(y, z);
        const Real sixteen_area2 = (x + (y + z)) * (z - (x - y)) * (z + (x - y)) * (x + (y - z));
        return std::sqrt(std::max(sixteen_area2, Real(0))) / Real(2);
    };
    const auto foot = [](Real from_i, Real from_j) {
        return ((from_i - from_j) * (from_i + from_j) + Real(1)) / Real(2);
    };
    return std::log(std::hypot(foot(b, a) - foot(d, e), height(b, a) + height(d, e))) + unit;
}

#define RICCI_INSTANTIATE(Real)                                                         \
    template void flip_edge<Real>(Connectivity&, std::span<Real>, Index, Real);         \
    template Real ptolemy_log<Real>(std::span<const Real>, const Connectivity&, Index); \
    template Real unfolded_log<Real>(std::span<const Real>, const Connectivity&, Index);
RICCI_INSTANTIATE(double)
RICCI_INSTANTIATE(long double)
#undef RICCI_INSTANTIATE

}  // namespace ricci
