#include "engine/refinement/null_sides.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Vertices that are one; the lowest number stands for all.
class MergedVertices {
  public:
    explicit MergedVertices(Index count) : parent_(at(count)) {
        std::iota(parent_.begin(), parent_.end(), Index{0});
    }
    Index find(Index v) {
        while (parent_[at(v)] != v) {
            parent_[at(v)] = parent_[at(parent_[at(v)])];
            v = parent_[at(v)];
        }
        return v;
    }
    void merge(Index a, Index b) { parent_[at(std::max(a, b))] = std::min(a, b); }

  private:
    std::vector<Index> parent_;
};

bool merge_null_sides(const CommonRefinement& r, MergedVertices& merged) {
    constexpr double kRounding = 16 * 0x1p-53;
    bool any = false;
    for (Index c = 0; c < r.corner_count(); ++c) {
        const std::array<double, 2>&p = r.flat[at(c)], &q = r.flat[at(r.next(c))];
        const double size = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(q[0]), std::abs(q[1])});
        if (!(std::hypot(q[0] - p[0], q[1] - p[1]) <= kRounding * size)) continue;
        const Index a = merged.find(r.vertex[at(c)]), b = merged.find(r.vertex[at(r.next(c))]);
        if (a == b || std::max(a, b) < r.input_vertices) continue;
        merged.merge(a, b);
        any = true;
    }
    return any;
}

/// The side `to` takes over what ran along `from`, which has the same direction.
void inherit(CommonRefinement& r, Index to, Index from) {
    if (r.input_halfedge[at(to)] < 0) r.input_halfedge[at(to)] = r.input_halfedge[at(from)];
    if (r.final_halfedge[at(to)] < 0) r.final_halfedge[at(to)] = r.final_halfedge[at(from)];
}

/// Glues the neighbours of a piece with the two sides c and d.
void bridge(CommonRefinement& r, Index c, Index d) {
    const Index t = r.twin[at(c)], u = r.twin[at(d)];
    if (t >= 0) inherit(r, t, d);
    if (u >= 0) inherit(r, u, c);
    if (t >= 0) r.twin[at(t)] = u;
    if (u >= 0) r.twin[at(u)] = t;
}

}  // namespace

Index collapse_null_sides(CommonRefinement& r) {
    MergedVertices merged(r.vertex_count);
    if (!merge_null_sides(r, merged)) return 0;
    for (Index& v : r.vertex) v = merged.find(v);
    std::vector<std::uint8_t> kept(at(r.corner_count()), 1);
    Index removed = 0;
    std::vector<std::uint8_t> piece_kept(at(r.piece_count()), 1);
    for (Index p = 0; p < r.piece_count(); ++p) {
        std::vector<Index> sides;
        for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
            kept[at(c)] = r.vertex[at(c)] != r.vertex[at(r.next(c))];
            if (kept[at(c)]) sides.push_back(c);
        }
        if (sides.size() > 2) continue;
        for (const Index c : sides) kept[at(c)] = 0;
        if (sides.size() == 2) bridge(r, sides[0], sides[1]);
        piece_kept[at(p)] = 0;
        ++removed;
    }
    // Move what is kept to the front.
    std::vector<Index> number(kept.size(), -1), first{0};
    Index corners = 0, pieces = 0;
    for (Index p = 0; p < r.piece_count(); ++p) {
        if (!piece_kept[at(p)]) continue;
        for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
            if (!kept[at(c)]) continue;
            number[at(c)] = corners;
            r.copy_corner(c, corners, pieces);
            ++corners;
        }
        r.input_face[at(pieces)] = r.input_face[at(p)];
        r.final_face[at(pieces)] = r.final_face[at(p)];
        first.push_back(corners);
        ++pieces;
    }
    r.resize(pieces, corners);
    r.first = std::move(first);
    for (Index& t : r.twin)
        if (t >= 0) t = number[at(t)];
    return removed;
}

}  // namespace ricci
