#include "kernels/edge_flip.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "kernels/extended.h"

namespace ricci {
namespace {

std::size_t at(Index h) {
    return static_cast<std::size_t>(h);
}

/// log(1 + e^x), x <= 0; to the absolute accuracy of Real.
template <class Real>
Real log_one_plus_exp(const Real& x) {
    if constexpr (std::is_floating_point_v<Real>) {
        return std::log1p(std::exp(x));
    } else {
        return log(Real(Real(1) + exp(x)));
    }
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
    return larger + log_one_plus_exp(Real(smaller - larger)) - log_chord[at(h)];
}

template <class Real>
Real unfolded_log(std::span<const Real> log_chord, const Connectivity& c, Index h) {
    const Index t = c.twin[at(h)];
    using std::exp;
    using std::log;
    using std::sqrt;
    const Real unit = log_chord[at(h)];  // lengths relative to the edge: c = 1
    const Real a = exp(Real(log_chord[at(next_halfedge(h))] - unit)),
               b = exp(Real(log_chord[at(prev_halfedge(h))] - unit));
    const Real d = exp(Real(log_chord[at(next_halfedge(t))] - unit)),
               e = exp(Real(log_chord[at(prev_halfedge(t))] - unit));
    // Apex over the edge from (0,0) to (1,0), at distance `from_i` of the start and `from_j` of the end.
    const auto height = [](Real from_i, Real from_j) -> Real {
        Real x = Real(1), y = std::max(from_i, from_j), z = std::min(from_i, from_j);
        if (y > x) std::swap(x, y);
        if (z > y) std::swap(y, z);
        const Real sixteen_area2 = (x + (y + z)) * (z - (x - y)) * (z + (x - y)) * (x + (y - z));
        return sqrt(Real(std::max(sixteen_area2, Real(0)))) / Real(2);
    };
    const auto foot = [](Real from_i, Real from_j) -> Real {
        return ((from_i - from_j) * (from_i + from_j) + Real(1)) / Real(2);
    };
    const Real x = foot(b, a) - foot(d, e), y = height(b, a) + height(d, e);
    if constexpr (std::is_floating_point_v<Real>) {
        return log(std::hypot(x, y)) + unit;
    } else {
        return log(Real(x * x + y * y)) / Real(2) + unit;  // nothing overflows there
    }
}

#define RICCI_INSTANTIATE(Real)                                                         \
    template void flip_edge<Real>(Connectivity&, std::span<Real>, Index, Real);         \
    template Real ptolemy_log<Real>(std::span<const Real>, const Connectivity&, Index); \
    template Real unfolded_log<Real>(std::span<const Real>, const Connectivity&, Index);
RICCI_INSTANTIATE(double)
RICCI_INSTANTIATE(long double)
RICCI_INSTANTIATE(WideReal)
#undef RICCI_INSTANTIATE

}  // namespace ricci
