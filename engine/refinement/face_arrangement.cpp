#include "engine/refinement/face_arrangement.h"

#include <algorithm>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

void FaceArrangement::build(Index places, std::span<const ArrangedSegment> first,
                            std::span<const ArrangedSegment> second) {
    places_ = places;
    family_ = {first, second};
    find_crossings();
    link();
    trace();
}

void FaceArrangement::find_crossings() {
    const std::size_t n = family_[0].size(), segments = n + family_[1].size();
    crossings_.clear();
    if (cuts_.size() < segments) cuts_.resize(segments);
    for (std::size_t s = 0; s < segments; ++s) cuts_[s].clear();
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < family_[1].size(); ++b) {
            const ArrangedSegment &p = family_[0][a], &q = family_[1][b];
            if (p.from == q.from || p.from == q.to || p.to == q.from || p.to == q.to) continue;
            const Index end = distance(p.from, p.to);
            const Index f = distance(p.from, q.from), t = distance(p.from, q.to);
            if ((f < end) == (t < end)) continue;
            const auto x = static_cast<Index>(crossings_.size());
            crossings_.push_back({static_cast<Index>(a), static_cast<Index>(b)});
            // Along p the order is that of the ends on the arc from p.from to p.to; from one corner, of the
            // others.
            const Index inner = f < end ? q.from : q.to, outer = f < end ? q.to : q.from;
            cuts_[a].push_back({x, distance(p.from, inner), distance(outer, p.from)});
            const bool from_inner = distance(q.from, p.from) < distance(q.from, q.to);
            const Index near = from_inner ? p.from : p.to, far = from_inner ? p.to : p.from;
            cuts_[n + b].push_back({x, distance(q.from, near), distance(far, q.from)});
        }
    for (std::size_t s = 0; s < segments; ++s)
        std::sort(cuts_[s].begin(), cuts_[s].end(),
                  [](const Cut& a, const Cut& b) { return a.ccw != b.ccw ? a.ccw < b.ccw : a.cw < b.cw; });
}

void FaceArrangement::link() {
    using Kind = ArrangedEdge::Kind;
    half_.clear();
    for (Index p = 0; p < places_; ++p) half_.push_back({Kind::boundary, p, p, true, -1});
    const std::size_t n = family_[0].size();
    piece_begin_.clear();
    if (leaving_.size() < at(places_)) leaving_.resize(at(places_));
    for (std::size_t p = 0; p < at(places_); ++p) leaving_[p].clear();
    for (std::size_t s = 0; s < n + family_[1].size(); ++s) {
        const bool second = s >= n;
        const auto number = static_cast<Index>(second ? s - n : s);
        const ArrangedSegment& segment = family_[second ? 1 : 0][at(number)];
        piece_begin_.push_back(static_cast<Index>(half_.size()));
        Index vertex = segment.from;
        for (std::size_t k = 0; k <= cuts_[s].size(); ++k) {
            const Index end = k < cuts_[s].size() ? places_ + cuts_[s][k].crossing : segment.to;
            half_.push_back({second ? Kind::second : Kind::first, vertex, number, true, -1});
            half_.push_back({second ? Kind::second : Kind::first, end, number, false, -1});
            vertex = end;
        }
        leaving_[at(segment.from)].push_back({distance(segment.from, segment.to), piece_begin_.back()});
        leaving_[at(segment.to)].push_back(
            {distance(segment.to, segment.from), static_cast<Index>(half_.size()) - 1});
    }
    // The face of a half-edge lies on its left: after it comes the first one clockwise from its reverse.
    next_.assign(half_.size(), -1);
    const auto reverse_of = [&](Index half) { return places_ + ((half - places_) ^ 1); };
    for (Index p = 0; p < places_; ++p) {
        auto& out = leaving_[at(p)];
        std::sort(out.begin(), out.end());
        const Index arriving = p == 0 ? places_ - 1 : p - 1;
        next_[at(arriving)] = out.empty() ? p : out.back()[1];
        for (std::size_t k = 0; k < out.size(); ++k)
            next_[at(reverse_of(out[k][1]))] = k == 0 ? p : out[k - 1][1];
    }
    // At a crossing, counterclockwise: the first segment's way on, the second one's end on its left, back,
    // right.
    std::vector<std::array<Index, 2>> ahead(crossings_.size());  // half-edges leaving forward, per family
    for (std::size_t s = 0; s < n + family_[1].size(); ++s)
        for (std::size_t k = 0; k < cuts_[s].size(); ++k)
            ahead[at(cuts_[s][k].crossing)][s < n ? 0 : 1] =
                piece_begin_[s] + 2 * (static_cast<Index>(k) + 1);
    for (std::size_t x = 0; x < crossings_.size(); ++x) {
        const ArrangedSegment &p = family_[0][at(crossings_[x][0])], &q = family_[1][at(crossings_[x][1])];
        const Index on = ahead[x][0], back = on - 1;  // leaving along p, forward and backward
        Index left = ahead[x][1], right = left - 1;
        if (distance(p.from, q.to) < distance(p.from, p.to))
            std::swap(left, right);  // q ends on the right of p
        next_[at(reverse_of(back))] = left;
        next_[at(reverse_of(on))] = right;
        next_[at(reverse_of(right))] = back;
        next_[at(reverse_of(left))] = on;
    }
}

void FaceArrangement::trace() {
    place_of_.assign(half_.size(), -1);
    edges_.clear();
    polygon_begin_.assign(1, 0);
    for (std::size_t start = 0; start < half_.size(); ++start) {
        if (place_of_[start] >= 0) continue;
        for (auto h = static_cast<Index>(start); place_of_[at(h)] < 0; h = next_[at(h)]) {
            place_of_[at(h)] = static_cast<Index>(edges_.size());
            edges_.push_back(half_[at(h)]);
            edges_.back().twin = h < places_ ? -1 : places_ + ((h - places_) ^ 1);
        }
        polygon_begin_.push_back(static_cast<Index>(edges_.size()));
    }
    for (ArrangedEdge& edge : edges_)
        if (edge.twin >= 0) edge.twin = place_of_[at(edge.twin)];
}

}  // namespace ricci
