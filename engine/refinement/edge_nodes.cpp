#include "engine/refinement/edge_nodes.h"

#include <cmath>

namespace ricci {
namespace {

using Real = long double;
using Weights = std::array<Real, 3>;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

Weights between(const Weights& a, const Weights& b, Real t) {
    Weights w{};
    for (std::size_t k = 0; k < 3; ++k) w[k] = (1 - t) * a[k] + t * b[k];
    return w;
}

Weights on_side(Index halfedge, Real tail, Real head) {
    Weights w{};
    w[at(halfedge % 3)] = tail;
    w[at(next_halfedge(halfedge) % 3)] = head;
    return w;
}

Weights at_corner(Index corner, Real weight) {
    Weights w{};
    w[at(corner % 3)] = weight;
    return w;
}

/// Nodes of one edge: both families are in order already.
void merge_nodes(const Crossings& x, const std::vector<Index>& input_nodes, const std::vector<Real>& fraction,
                 Index final_begin, Index final_end, EdgeNodes& out) {
    std::size_t i = 0;
    Index f = final_begin;
    while (i < input_nodes.size() || f < final_end) {
        const bool take_final =
            i == input_nodes.size() || (f < final_end && x.middle_points[at(f)].on_curve < fraction[i]);
        const auto number = static_cast<Index>(out.node.size());
        if (take_final) {
            out.node_of_final[at(f)] = number;
            out.node.push_back({true, f, x.middle_points[at(f)].on_curve});
            ++f;
        } else {
            out.node_of_input[at(input_nodes[i])] = number;
            out.node.push_back({false, input_nodes[i], fraction[i]});
            ++i;
        }
    }
}

/// Where a middle edge meets final edges (and at its ends), in the final face before and the one after.
struct Anchor {
    Real fraction = 0;
    Index face_before = -1, face_after = -1;
    Weights before{}, after{};
};

std::vector<Anchor> anchors_of(const Crossings& x, Index edge, Index tail, Index head,
                               std::span<const double> u) {
    const std::span<const Crossing> path = x.middle_paths.of(edge);
    const auto size = [&](Index v) { return std::exp(-static_cast<Real>(u[at(v)])); };
    std::vector<Anchor> anchors(path.size() + 2);
    const Index begin = x.middle_paths.first[at(edge)];
    Index g = path.front().halfedge;
    anchors.front() = {0, -1, face_of(g), {}, at_corner(prev_halfedge(g), size(tail))};
    for (std::size_t k = 0; k < path.size(); ++k) {
        g = path[k].halfedge;
        const Index t = x.last->twin[at(g)];
        const CrossingPoint& p = x.middle_points[at(begin) + k];
        anchors[k + 1] = {p.on_curve, face_of(g), face_of(t), on_side(g, p.tail, p.head),
                          on_side(t, p.head, p.tail)};
    }
    const Index t = x.last->twin[at(g)];
    anchors.back() = {1, face_of(t), -1, at_corner(prev_halfedge(t), size(head)), {}};
    return anchors;
}

/// Stretches of an edge that crosses final edges.
void crossing_stretches(const std::vector<Anchor>& anchors, std::span<const EdgeNode> nodes,
                        std::span<EdgeStretch> stretches) {
    std::size_t a = 0;  // the stretch lies between anchors a and a + 1
    const auto point = [&](Real fraction) {
        const Anchor &p = anchors[a], &q = anchors[a + 1];
        const Real width = q.fraction - p.fraction;
        return between(p.after, q.before, width > 0 ? (fraction - p.fraction) / width : Real(0.5));
    };
    Weights begin = anchors.front().after;
    for (std::size_t s = 0; s < stretches.size(); ++s) {
        const bool last = s == nodes.size();
        const bool anchored = last || nodes[s].final_edge;
        const Weights end = anchored ? anchors[a + 1].before : point(nodes[s].fraction);
        for (std::size_t side = 0; side < 2; ++side) {
            stretches[s].final_face[side] = anchors[a].face_after;
            stretches[s].begin[side] = begin;
            stretches[s].end[side] = end;
        }
        if (anchored) ++a;
        begin = anchored && !last ? anchors[a].after : end;
    }
}

/// Stretches of an edge that is one of the final edges, too.
void shared_stretches(const Crossings& x, Index halfedge, std::span<const EdgeNode> nodes,
                      std::span<const double> u, std::span<EdgeStretch> stretches) {
    const Index along = x.last_along[at(halfedge)];
    const Real tail = std::exp(-static_cast<Real>(u[at(x.middle->tail[at(halfedge)])])),
               head = std::exp(-static_cast<Real>(u[at(x.middle->head(halfedge))]));
    for (std::size_t s = 0; s < stretches.size(); ++s) {
        const Real from = s == 0 ? 0 : nodes[s - 1].fraction, to = s == nodes.size() ? 1 : nodes[s].fraction;
        EdgeStretch& stretch = stretches[s];
        stretch.final_face[0] = face_of(along);
        stretch.begin[0] = on_side(along, (1 - from) * tail, from * head);
        stretch.end[0] = on_side(along, (1 - to) * tail, to * head);
        const Index twin = x.last->twin[at(along)];
        if (twin == kNoTwin) continue;
        stretch.final_face[1] = face_of(twin);
        stretch.begin[1] = on_side(twin, from * head, (1 - from) * tail);
        stretch.end[1] = on_side(twin, to * head, (1 - to) * tail);
    }
}

}  // namespace

EdgeNodes merge_edge_nodes(const Crossings& x, std::span<const double> u) {
    const Connectivity& c = *x.middle;
    EdgeNodes out;
    out.halfedge = edge_halfedges(c);
    // Crossings of input edges by middle edge, in order.
    std::vector<std::vector<Index>> input_nodes(at(c.edge_count));
    for (std::size_t k = 0; k < x.input_paths.crossing.size(); ++k)
        input_nodes[at(c.edge[at(x.input_paths.crossing[k].halfedge)])].push_back(static_cast<Index>(k));
    out.node_of_input.assign(x.input_paths.crossing.size(), -1);
    out.node_of_final.assign(x.middle_paths.crossing.size(), -1);
    out.first.assign(1, 0);
    std::vector<Index> ordered;
    std::vector<Real> fraction;
    for (Index e = 0; e < c.edge_count; ++e) {
        const std::vector<Index>& here = input_nodes[at(e)];
        ordered.assign(here.size(), -1);
        fraction.assign(here.size(), 0);
        for (const Index k : here) {
            const Crossing& crossing = x.input_paths.crossing[at(k)];
            const bool along = crossing.halfedge == out.halfedge[at(e)];
            const Index place =
                along ? crossing.position : static_cast<Index>(here.size()) - 1 - crossing.position;
            ordered[at(place)] = k;
            const Real t = x.input_points[at(k)].on_edge;
            fraction[at(place)] = along ? t : 1 - t;
        }
        merge_nodes(x, ordered, fraction, x.middle_paths.first[at(e)], x.middle_paths.first[at(e) + 1], out);
        out.first.push_back(static_cast<Index>(out.node.size()));
    }
    out.stretch.resize(out.node.size() + at(c.edge_count));
    for (Index e = 0; e < c.edge_count; ++e) {
        const Index h = out.halfedge[at(e)];
        const std::span<const EdgeNode> nodes{out.node.data() + out.first[at(e)], at(out.count(e))};
        const std::span<EdgeStretch> stretches{out.stretch.data() + out.first[at(e)] + e, nodes.size() + 1};
        if (x.last_along[at(h)] >= 0) {
            shared_stretches(x, h, nodes, u, stretches);
        } else {
            crossing_stretches(anchors_of(x, e, c.tail[at(h)], c.head(h), u), nodes, stretches);
        }
    }
    return out;
}

std::vector<Point> node_points(const Crossings& x, const EdgeNodes& nodes, std::span<const Point> point) {
    const auto between_points = [](const Point& a, const Point& b, Real t) {
        Point p{};
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = static_cast<double>((1 - t) * static_cast<Real>(a[k]) + t * static_cast<Real>(b[k]));
        return p;
    };
    std::vector<Point> result(nodes.node.size());
    const std::vector<Index> input_halfedge = edge_halfedges(*x.input);
    for (Index e = 0; e < x.input->edge_count; ++e) {
        const Index h = input_halfedge[at(e)];
        for (Index k = x.input_paths.first[at(e)]; k < x.input_paths.first[at(e) + 1]; ++k)
            result[at(nodes.node_of_input[at(k)])] = between_points(
                point[at(x.input->tail[at(h)])], point[at(x.input->head(h))], x.input_points[at(k)].on_curve);
    }
    // A crossing with a final edge lies on the straight piece of the middle edge inside one input face.
    for (Index e = 0; e < x.middle->edge_count; ++e) {
        const Index h = nodes.halfedge[at(e)];
        Point from = point[at(x.middle->tail[at(h)])];
        Real start = 0;
        for (Index n = nodes.first[at(e)]; n < nodes.first[at(e) + 1]; ++n) {
            if (!nodes.node[at(n)].final_edge) {
                from = result[at(n)];
                start = nodes.node[at(n)].fraction;
                continue;
            }
            Index m = n + 1;
            while (m < nodes.first[at(e) + 1] && nodes.node[at(m)].final_edge) ++m;
            const bool end = m == nodes.first[at(e) + 1];
            const Real stop = end ? 1 : nodes.node[at(m)].fraction;
            const Point& to = end ? point[at(x.middle->head(h))] : result[at(m)];
            const Real t = stop > start ? (nodes.node[at(n)].fraction - start) / (stop - start) : Real(0.5);
            result[at(n)] = between_points(from, to, t);
        }
    }
    return result;
}

}  // namespace ricci
