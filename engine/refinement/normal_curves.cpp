#include "engine/refinement/normal_curves.h"

#include <algorithm>
#include <stdexcept>

#include "kernels/edge_flip.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

std::vector<DirectedEdge> directed_edges(const Connectivity& c) {
    std::vector<DirectedEdge> result(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        result[at(h)] = 2 * c.edge[at(h)] + (t != kNoTwin && t < h ? 1 : 0);
    }
    return result;
}

NormalCurves::NormalCurves(const Connectivity& original)
    : current_(original),
      along_(original.tail.size()),
      curve_(at(original.edge_count)),
      shared_(at(original.edge_count)),
      original_edges_(original.edge_count),
      original_tail_(at(original.edge_count)) {
    for (Index h = 0; h < original.halfedge_count(); ++h) {
        const Index t = original.twin[at(h)];
        along_[at(h)] = t == kNoTwin || h < t;
        if (along_[at(h)]) original_tail_[at(original.edge[at(h)])] = original.tail[at(h)];
    }
    for (Index e = 0; e < original.edge_count; ++e) shared_[at(e)] = 2 * e;
}

Index NormalCurves::count(Index h) const {
    return static_cast<Index>(curve_[at(current_.edge[at(h)])].size());
}

DirectedEdge NormalCurves::curve(Index h, Index position) const {
    const auto& curves = curve_[at(current_.edge[at(h)])];
    // The face of h lies on its left, so leaving it is crossing from left to right.
    return along_[at(h)] ? curves[at(position)] : reversed(curves[curves.size() - 1 - at(position)]);
}

DirectedEdge NormalCurves::shared(Index h) const {
    const DirectedEdge edge = shared_[at(current_.edge[at(h)])];
    return edge < 0 || along_[at(h)] ? edge : reversed(edge);
}

/// Number of curves that cut off each corner.
std::array<Index, 3> NormalCurves::corner_arcs(Index face) const {
    std::array<Index, 3> n{};
    for (std::size_t k = 0; k < 3; ++k) n[k] = count(3 * face + static_cast<Index>(k));
    std::array<Index, 3> arcs{};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3, prev = (k + 2) % 3;
        if (n[next] > n[k] + n[prev]) {  // some leave corner k across the opposite side
            arcs[k] = 0;
            arcs[next] = n[k];
            arcs[prev] = n[prev];
            return arcs;
        }
    }
    for (std::size_t k = 0; k < 3; ++k) arcs[k] = (n[k] + n[(k + 2) % 3] - n[(k + 1) % 3]) / 2;
    return arcs;
}

/// Positions along h of the curves that end at the corner opposite h.
std::array<Index, 2> NormalCurves::corner_range(Index h) const {
    const std::array<Index, 3> arcs = corner_arcs(face_of(h));
    return {arcs[at(h % 3)], count(h) - arcs[at(next_halfedge(h) % 3)]};
}

Crossing NormalCurves::follow(Index h, Index position) const {
    const auto [begin, end] = corner_range(h);
    if (position < begin) return {prev_halfedge(h), count(prev_halfedge(h)) - 1 - position};
    if (position >= end) return {next_halfedge(h), count(h) - 1 - position};
    return {-1, 0};
}

void NormalCurves::flip(Index h) {
    //      k
    //    /   \      hn: j->k, hp: k->i, tn: i->l, tp: l->j. The new diagonal runs from l to k; what crosses
    //    it from
    //   i --h-> j   left (i) to right (j) is collected from k to l along the two sides at i.
    //    \   /
    //      l
    const Index t = current_.twin[at(h)];
    const Index hn = next_halfedge(h), hp = prev_halfedge(h), tn = next_halfedge(t), tp = prev_halfedge(t);
    const Index diagonal = current_.edge[at(h)], across = count(h);
    std::vector<DirectedEdge> crossing;
    // A curve that enters across `side` (at i) and passes to a side at j, to corner j, or through the old
    // diagonal.
    const auto enter = [&](Index side, Index inner, Index other_side_at_j) {
        for (Index p = 0; p < count(side); ++p) {
            const Crossing exit = follow(side, p);
            bool crosses = true;
            if (exit.halfedge == inner) {
                const Index behind = current_.twin[at(inner)];
                const Crossing further = follow(behind, across - 1 - exit.position);
                crosses = further.halfedge == other_side_at_j;
            }
            if (crosses) crossing.push_back(reversed(curve(side, p)));
        }
    };
    enter(hp, h, tp);
    const auto leave_corner = [&](Index opposite) {
        const auto [begin, end] = corner_range(opposite);
        for (Index p = end - 1; p >= begin; --p) crossing.push_back(curve(opposite, p));
    };
    leave_corner(hn);
    if (shared(h) >= 0) crossing.push_back(shared(h));
    leave_corner(tp);
    enter(tn, t, hn);
    // A curve from l to k becomes the new edge.
    DirectedEdge along_new = -1;
    const auto [begin, end] = corner_range(h);
    for (Index p = begin; p < end; ++p)
        if (follow(t, across - 1 - p).halfedge < 0) along_new = reversed(curve(h, p));
    std::reverse(crossing.begin(), crossing.end());
    curve_[at(diagonal)] = std::move(crossing);
    shared_[at(diagonal)] = along_new;
    along_[at(h)] = along_[at(tn)];
    along_[at(t)] = along_[at(hn)];
    along_[at(hn)] = 1;  // becomes l->k
    along_[at(tn)] = 0;
    // hn becomes l->k: seen from face f, whose other corner is i. It lies on its left.
    flip_edge(current_, h);
}

CurvePaths NormalCurves::trace() const {
    CurvePaths paths;
    paths.shared.assign(at(original_edges_), -1);
    std::vector<std::vector<Crossing>> found(at(original_edges_));
    for (Index h = 0; h < current_.halfedge_count(); ++h) {
        const DirectedEdge edge = shared(h);
        if (edge >= 0 && edge % 2 == 0) paths.shared[at(edge / 2)] = h;
        const auto [begin, end] = corner_range(h);
        for (Index p = begin; p < end; ++p) {
            const DirectedEdge start = curve(h, p);
            if (start % 2 != 0) continue;
            std::vector<Crossing>& path = found[at(start / 2)];
            if (!path.empty()) throw std::logic_error("a curve starts twice");
            for (Crossing c{h, p}; c.halfedge >= 0;) {
                if (curve(c.halfedge, c.position) != start) throw std::logic_error("two curves are mixed up");
                path.push_back(c);
                const Index t = current_.twin[at(c.halfedge)];
                c = follow(t, count(t) - 1 - c.position);
            }
        }
    }
    paths.first.assign(1, 0);
    for (Index e = 0; e < original_edges_; ++e) {
        const std::vector<Crossing>& path = found[at(e)];
        if (path.empty() == (paths.shared[at(e)] < 0)) throw std::logic_error("a curve has no path, or two");
        paths.crossing.insert(paths.crossing.end(), path.begin(), path.end());
        paths.first.push_back(static_cast<Index>(paths.crossing.size()));
    }
    return paths;
}

}  // namespace ricci
