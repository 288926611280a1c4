#include "engine/refinement/piece_builder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ricci {
namespace {

using Real = long double;
using Plane = std::array<Real, 2>;
using Weights = std::array<Real, 3>;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

void PieceBuilder::run() {
    collect_input_segments();
    collect_final_segments();
    for (Index f = 0; f < x_.middle->face_count(); ++f) add_face(f);
    for (const auto& [left, right] : side_corner_) {
        if (left < 0 || right < 0) continue;
        out_.twin[at(left)] = right;
        out_.twin[at(right)] = left;
    }
}

/// Place on the boundary of face f of the node `number` (global) that lies on halfedge h of f.
Index PieceBuilder::place(Index h, Index number) const {
    const Index e = x_.middle->edge[at(h)], k = number - nodes_.first[at(e)];
    const Index along = h == nodes_.halfedge[at(e)] ? k : nodes_.count(e) - 1 - k;
    return corner_place(h) + 1 + along;
}

Index PieceBuilder::corner_place(Index h) const {
    Index place = 0;
    for (Index side = 3 * face_of(h); side < h; ++side) place += 1 + nodes_.count(x_.middle->edge[at(side)]);
    return place;
}

void PieceBuilder::collect_input_segments() {
    const CurvePaths& paths = x_.input_paths;
    for (Index e = 0; e < x_.input->edge_count; ++e) {
        const Index begin = paths.first[at(e)], end = paths.first[at(e) + 1];
        for (Index k = begin; k <= end && begin < end; ++k) {
            const Index entered = k > begin ? x_.middle->twin[at(paths.crossing[at(k) - 1].halfedge)] : -1;
            const Index left = k < end ? paths.crossing[at(k)].halfedge : -1;
            const Index face = face_of(left >= 0 ? left : entered);
            Segment s;
            s.code = 2 * e;
            s.placed.from = entered < 0 ? corner_place(prev_halfedge(left))
                                        : place(entered, nodes_.node_of_input[at(k) - 1]);
            s.placed.to =
                left < 0 ? corner_place(prev_halfedge(entered)) : place(left, nodes_.node_of_input[at(k)]);
            input_segments_[at(face)].push_back(s);
        }
    }
}

void PieceBuilder::collect_final_segments() {
    // Middle edges across each final edge, in order along its lowest halfedge.
    const Connectivity& last = *x_.last;
    const std::vector<Index> lowest = edge_halfedges(last);
    const CurvePaths& paths = x_.middle_paths;
    struct Passage {
        Index leave, node;  // the middle halfedge across which the final edge leaves a face
    };
    std::vector<std::vector<Passage>> passages(at(last.edge_count));
    for (const Crossing& crossing : paths.crossing)
        passages[at(last.edge[at(crossing.halfedge)])].push_back({});
    for (Index e = 0; e < x_.middle->edge_count; ++e) {
        const Index d = nodes_.halfedge[at(e)];
        for (Index k = paths.first[at(e)]; k < paths.first[at(e) + 1]; ++k) {
            const Crossing& crossing = paths.crossing[at(k)];
            auto& here = passages[at(last.edge[at(crossing.halfedge)])];
            const bool along = crossing.halfedge == lowest[at(last.edge[at(crossing.halfedge)])];
            const Index position =
                along ? crossing.position : static_cast<Index>(here.size()) - 1 - crossing.position;
            // The middle edge d leaves the face on the left of the crossed halfedge; seen the other way
            // round, that halfedge comes from the right of d.
            here[at(position)] = {along ? x_.middle->twin[at(d)] : d, nodes_.node_of_final[at(k)]};
        }
    }
    for (Index q = 0; q < last.edge_count; ++q) {
        const auto& here = passages[at(q)];
        for (std::size_t k = 0; k <= here.size() && !here.empty(); ++k) {
            const Index entered = k > 0 ? x_.middle->twin[at(here[k - 1].leave)] : -1;
            const Index left = k < here.size() ? here[k].leave : -1;
            const Index face = face_of(left >= 0 ? left : entered);
            Segment s;
            s.code = lowest[at(q)];
            s.placed.from =
                entered < 0 ? corner_place(prev_halfedge(left)) : place(entered, here[k - 1].node);
            s.placed.to = left < 0 ? corner_place(prev_halfedge(entered)) : place(left, here[k].node);
            final_segments_[at(face)].push_back(s);
        }
    }
}

void PieceBuilder::lay_out_places(Index f) {
    places_.clear();
    const auto length = [&](Index k) { return std::exp(log_length_[at(3 * f + k)]); };
    const Real a = length(0), b = length(1), c = length(2);
    const Real foot = (a * a + (c - b) * (c + b)) / (2 * a);
    Real p = a, q = b, r = c;
    if (p < q) std::swap(p, q);
    if (q < r) std::swap(q, r);
    if (p < q) std::swap(p, q);
    const Real product = (p + (q + r)) * (r - (p - q)) * (r + (p - q)) * (p + (q - r));
    const std::array<Plane, 3> corner{
        {{0, 0}, {a, 0}, {foot, std::sqrt(std::max(product, Real(0))) / (2 * a)}}};
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        const Index e = x_.middle->edge[at(h)], n = nodes_.count(e);
        const bool along = h == nodes_.halfedge[at(e)];
        const Plane &from = corner[at(h - 3 * f)], &to = corner[at(next_halfedge(h) - 3 * f)];
        const Index base = nodes_.first[at(e)] + e;
        places_.push_back({x_.middle->tail[at(h)], from, h, base + (along ? 0 : n)});
        for (Index k = 0; k < n; ++k) {
            const Index number = nodes_.first[at(e)] + (along ? k : n - 1 - k);
            const Real t = nodes_.node[at(number)].fraction, s = along ? t : 1 - t;
            places_.push_back({first_node_vertex() + number,
                               {(1 - s) * from[0] + s * to[0], (1 - s) * from[1] + s * to[1]},
                               h,
                               base + (along ? k + 1 : n - 1 - k)});
        }
    }
}

void PieceBuilder::add_face(Index f) {
    lay_out_places(f);
    const auto& first = input_segments_[at(f)];
    const auto& second = final_segments_[at(f)];
    placed_first_.clear();
    placed_second_.clear();
    for (const Segment& s : first) placed_first_.push_back(s.placed);
    for (const Segment& s : second) placed_second_.push_back(s.placed);
    arrangement_.build(static_cast<Index>(places_.size()), placed_first_, placed_second_);
    cross_segments();
    const Index corner_base = out_.corner_count(), piece_base = out_.piece_count();
    const std::span<const Index> begin = arrangement_.polygon_begin();
    for (std::size_t p = 0; p + 1 < begin.size(); ++p)
        add_polygon(f, arrangement_.edges().subspan(at(begin[p]), at(begin[p + 1] - begin[p])), corner_base);
    name_pieces(piece_base, corner_base);
    weigh_corners(piece_base, corner_base);
}

/// Points where input and final segments cross.
void PieceBuilder::cross_segments() {
    crossing_flat_.clear();
    crossing_on_final_.clear();
    for (const auto& [a, b] : arrangement_.crossings()) {
        const ArrangedSegment &p = placed_first_[at(a)], &q = placed_second_[at(b)];
        const Plane &p0 = places_[at(p.from)].flat, &p1 = places_[at(p.to)].flat;
        const Plane &q0 = places_[at(q.from)].flat, &q1 = places_[at(q.to)].flat;
        const auto side = [](const Plane& o, const Plane& d, const Plane& x) {
            return (d[0] - o[0]) * (x[1] - o[1]) - (d[1] - o[1]) * (x[0] - o[0]);
        };
        const auto fraction = [](Real before, Real after) {
            const Real whole = std::abs(before) + std::abs(after);
            return whole > 0 ? std::abs(before) / whole : Real(0.5);
        };
        const Real s = fraction(side(q0, q1, p0), side(q0, q1, p1));
        const Real t = fraction(side(p0, p1, q0), side(p0, p1, q1));
        crossing_flat_.push_back({(1 - s) * p0[0] + s * p1[0], (1 - s) * p0[1] + s * p1[1]});
        crossing_on_final_.push_back(t);
        const Index vertex = first_node_vertex() + static_cast<Index>(nodes_.node.size() + inside_.size());
        crossing_vertex_.resize(crossing_flat_.size());
        crossing_vertex_.back() = vertex;
        inside_.push_back({vertex, places_[at(p.from)].vertex, places_[at(p.to)].vertex, s});
    }
}

void PieceBuilder::add_polygon(Index f, std::span<const ArrangedEdge> edges, Index corner_base) {
    using Kind = ArrangedEdge::Kind;
    const auto places = static_cast<Index>(places_.size());
    for (const ArrangedEdge& edge : edges) {
        const bool inside = edge.vertex >= places;
        const auto crossing = at(edge.vertex - places);
        const Plane& flat = inside ? crossing_flat_[crossing] : places_[at(edge.vertex)].flat;
        const auto corner = out_.corner_count();
        out_.vertex.push_back(inside ? crossing_vertex_[crossing] : places_[at(edge.vertex)].vertex);
        out_.flat.push_back({static_cast<double>(flat[0]), static_cast<double>(flat[1])});
        out_.piece.push_back(out_.piece_count());
        out_.weight.push_back({});
        out_.twin.push_back(edge.twin < 0 ? -1 : corner_base + edge.twin);
        Index input = -1, last = -1;
        if (edge.kind == Kind::boundary) {
            const Place& place = places_[at(edge.segment)];
            const Index h = place.side;
            input = input_halfedge_of(x_.input_along[at(h)]);
            last = x_.last_along[at(h)];
            const bool left = h == nodes_.halfedge[at(x_.middle->edge[at(h)])];
            side_corner_[at(place.stretch)][left ? 0 : 1] = corner;
        } else if (edge.kind == Kind::first) {
            const DirectedEdge code = input_segments_[at(f)][at(edge.segment)].code;
            input = input_halfedge_of(edge.forward ? code : reversed(code));
        } else {
            const Index code = final_segments_[at(f)][at(edge.segment)].code;
            last = edge.forward ? code : x_.last->twin[at(code)];
        }
        out_.input_halfedge.push_back(input);
        out_.final_halfedge.push_back(last);
    }
    out_.first.push_back(out_.corner_count());
    out_.input_face.push_back(-1);
    out_.final_face.push_back(-1);
}

Index PieceBuilder::input_halfedge_of(DirectedEdge code) const {
    if (code < 0) return -1;
    const Index h = input_lowest_[at(code / 2)];
    return code % 2 == 0 ? h : x_.input->twin[at(h)];
}

/// Input and final face of the pieces of one middle face: from the sides that lie on their edges, and
/// from neighbours across sides that do not.
void PieceBuilder::name_pieces(Index piece_base, Index corner_base) {
    const std::span<const ArrangedEdge> edges = arrangement_.edges();
    for (std::size_t k = 0; k < edges.size(); ++k) {
        const Index c = corner_base + static_cast<Index>(k), p = out_.piece[at(c)];
        if (out_.input_halfedge[at(c)] >= 0) out_.input_face[at(p)] = face_of(out_.input_halfedge[at(c)]);
        if (out_.final_halfedge[at(c)] >= 0) out_.final_face[at(p)] = face_of(out_.final_halfedge[at(c)]);
        if (edges[k].kind != ArrangedEdge::Kind::boundary) continue;
        const Place& place = places_[at(edges[k].segment)];
        const bool left = place.side == nodes_.halfedge[at(x_.middle->edge[at(place.side)])];
        out_.final_face[at(p)] = nodes_.stretch[at(place.stretch)].final_face[left ? 0 : 1];
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t k = 0; k < edges.size(); ++k) {
            const Index c = corner_base + static_cast<Index>(k), t = edges[k].twin;
            if (t < 0) continue;
            const Index p = out_.piece[at(c)], q = out_.piece[at(corner_base + t)];
            const bool input = edges[k].kind == ArrangedEdge::Kind::second;
            auto& face = input ? out_.input_face : out_.final_face;
            if (face[at(p)] >= 0 || face[at(q)] < 0) continue;
            face[at(p)] = face[at(q)];
            changed = true;
        }
    }
    for (Index p = piece_base; p < out_.piece_count(); ++p)
        if (out_.input_face[at(p)] < 0 || out_.final_face[at(p)] < 0)
            throw std::logic_error("a piece of the common refinement belongs to no face");
}

/// Weights of a place as seen from the boundary side that starts (or ends) there.
Weights PieceBuilder::boundary_weights(const Place& side, bool at_start) const {
    const bool left = side.side == nodes_.halfedge[at(x_.middle->edge[at(side.side)])];
    const EdgeStretch& stretch = nodes_.stretch[at(side.stretch)];
    return left == at_start ? stretch.begin[left ? 0 : 1] : stretch.end[left ? 0 : 1];
}

/// Corner of its final face that the piece starting at corner c (which leaves a corner of the middle face
/// across its inside) has there: that of the last final edge counterclockwise before it, or of the middle
/// edge.
Weights PieceBuilder::inner_corner_weights(Index c, Index place) const {
    const Real size = std::exp(-static_cast<Real>(u_[at(out_.vertex[at(c)])]));
    Weights w{};
    const auto distance = [&](Index to) {
        const auto places = static_cast<Index>(places_.size());
        return (to - place + places) % places;
    };
    const ArrangedEdge& edge = arrangement_.edges()[at(c - current_base_)];
    const auto& placed = edge.kind == ArrangedEdge::Kind::first ? placed_first_ : placed_second_;
    const ArrangedSegment& own = placed[at(edge.segment)];
    const Index limit = distance(edge.forward ? own.to : own.from);
    Index best = 0, halfedge = -1;
    for (std::size_t s = 0; s < placed_second_.size(); ++s) {
        const ArrangedSegment& q = placed_second_[s];
        for (const bool forward : {true, false}) {
            if ((forward ? q.from : q.to) != place) continue;
            const Index far = distance(forward ? q.to : q.from);
            if (far > limit || far < best) continue;
            best = far;
            const Index code = final_segments_[at(face_of(places_[0].side))][s].code;
            halfedge = forward ? code : x_.last->twin[at(code)];
        }
    }
    if (halfedge < 0) return boundary_weights(places_[at(place)], true);
    w[at(halfedge % 3)] = size;
    return w;
}

void PieceBuilder::weigh_corners(Index piece_base, Index corner_base) {
    using Kind = ArrangedEdge::Kind;
    current_base_ = corner_base;
    const std::span<const ArrangedEdge> edges = arrangement_.edges();
    const auto places = static_cast<Index>(places_.size());
    for (Index p = piece_base; p < out_.piece_count(); ++p) {
        weights_.clear();
        Real largest = 0;
        for (Index c = out_.first[at(p)]; c < out_.first[at(p) + 1]; ++c) {
            const ArrangedEdge& out = edges[at(c - corner_base)];
            const ArrangedEdge& in = edges[at(out_.previous(c) - corner_base)];
            Weights w{};
            if (out.vertex >= places) {
                const auto x = at(out.vertex - places);
                w = inside_weights(x, out.kind == Kind::second ? out : in);
            } else if (out.kind == Kind::boundary) {
                w = boundary_weights(places_[at(out.segment)], true);
            } else if (in.kind == Kind::boundary) {
                w = boundary_weights(places_[at(in.segment)], false);
            } else {
                w = inner_corner_weights(c, out.vertex);
            }
            weights_.push_back(w);
            for (const Real value : w) largest = std::max(largest, value);
        }
        for (Index c = out_.first[at(p)]; c < out_.first[at(p) + 1]; ++c)
            for (std::size_t k = 0; k < 3; ++k)
                out_.weight[at(c)][k] = static_cast<double>(weights_[at(c - out_.first[at(p)])][k] / largest);
    }
}

/// Weights of crossing x in the final face on the left of `edge`, a side on a final segment.
Weights PieceBuilder::inside_weights(std::size_t x, const ArrangedEdge& edge) const {
    const ArrangedSegment& q = placed_second_[at(edge.segment)];
    const Index code = final_segments_[at(face_of(places_[0].side))][at(edge.segment)].code;
    const std::array<Real, 2> from = on_final_edge(q.from, code, true), to = on_final_edge(q.to, code, false);
    const Real t = crossing_on_final_[x];
    const Real tail = (1 - t) * from[0] + t * to[0], head = (1 - t) * from[1] + t * to[1];
    Weights w{};
    const Index g = edge.forward ? code : x_.last->twin[at(code)];
    w[at(g % 3)] = edge.forward ? tail : head;
    w[at(next_halfedge(g) % 3)] = edge.forward ? head : tail;
    return w;
}

/// A place on a final edge: weights of the tail and head of its halfedge `code`.
std::array<Real, 2> PieceBuilder::on_final_edge(Index place, Index code, bool start) const {
    const Index vertex = places_[at(place)].vertex - first_node_vertex();
    if (vertex < 0) {
        const Real size = std::exp(-static_cast<Real>(u_[at(places_[at(place)].vertex)]));
        return start ? std::array<Real, 2>{size, 0} : std::array<Real, 2>{0, size};
    }
    const Index k = nodes_.node[at(vertex)].crossing;
    const CrossingPoint& point = x_.middle_points[at(k)];
    return x_.middle_paths.crossing[at(k)].halfedge == code ? std::array<Real, 2>{point.tail, point.head}
                                                            : std::array<Real, 2>{point.head, point.tail};
}
}  // namespace ricci
