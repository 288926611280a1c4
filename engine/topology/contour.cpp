#include "engine/topology/contour.h"

#include <utility>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A face or polygon whose sides are being read.
struct Visit {
    Index edge;       // dual tree edge by which it was entered; -1 at the root
    Index polygon;    // boundary component, or -1: a face
    Index side;       // halfedge of the mesh at the next side
    Index remaining;  // sides still to be read
};

/// Depth-first walk over the dual tree that writes the contour.
class ContourTracer {
  public:
    ContourTracer(const Connectivity& c, const TreeCotree& trees, std::span<const Index> cones)
        : c_(c), trees_(trees) {
        letter_.assign(at(c.edge_count), 0);
        cone_letter_.assign(at(c.vertex_count), 0);
        before_.assign(c.tail.size(), -1);
        Index letter = 0;
        for (const Index h : trees.loop_halfedges) letter_[at(c.edge[at(h)])] = ++letter;
        first_boundary_letter_ = letter + 1;
        letter += static_cast<Index>(trees.boundary.size());
        for (const Index v : cones) cone_letter_[at(v)] = ++letter;
        for (const std::vector<Index>& loop : trees.boundary)
            for (std::size_t i = 0; i < loop.size(); ++i) before_[at(loop[(i + 1) % loop.size()])] = loop[i];
        result_.begin.assign(at(c.edge_count), 0);
        result_.end.assign(at(c.edge_count), 0);
        result_.inverse.assign(c.tail.size(), 0);
        result_.entrance.assign(trees.boundary.size(), -1);
    }

    Contour trace() {
        stack_.push_back({-1, -1, 0, 3});
        while (!stack_.empty()) {
            if (stack_.back().remaining == 0) {
                leave();
                continue;
            }
            Visit& visit = stack_.back();
            const Index side = visit.side;
            const bool polygon = visit.polygon >= 0;
            visit.side = polygon ? before_[at(side)] : next_halfedge(side);
            --visit.remaining;
            if (polygon) {
                read_polygon_side(side);
            } else {
                read_face_side(side);
            }
        }
        return std::move(result_);
    }

  private:
    [[nodiscard]] Index size() const { return static_cast<Index>(result_.word.size()); }

    void leave() {
        const Visit visit = stack_.back();
        stack_.pop_back();
        // word(h) = rest * C for the halfedge h that leads into a polygon.
        if (visit.polygon >= 0) result_.word.push_back(first_boundary_letter_ + visit.polygon);
        if (visit.edge >= 0) result_.end[at(visit.edge)] = size();
    }

    void read_letter(Index edge, bool forwards) {
        if (forwards) {
            result_.begin[at(edge)] = size();
            result_.end[at(edge)] = size() + 1;
        }
        result_.word.push_back(forwards ? letter_[at(edge)] : -letter_[at(edge)]);
    }

    void read_face_side(Index h) {
        const Index e = c_.edge[at(h)];
        switch (trees_.role[at(e)]) {
            case EdgeRole::tree: {
                const Index cone = cone_letter_[at(c_.head(h))];
                if (cone != 0 && trees_.tree.arriving[at(c_.head(h))] == h) result_.word.push_back(-cone);
                break;
            }
            case EdgeRole::loop: {
                const bool forwards = trees_.loop_halfedges[at(generator_of(letter_[at(e)]))] == h;
                result_.inverse[at(h)] = forwards ? 0 : 1;
                read_letter(e, forwards);
                break;
            }
            case EdgeRole::cotree:
                enter_from_face(h, e);
                break;
        }
    }

    void enter_from_face(Index h, Index e) {
        const Index t = c_.twin[at(h)];
        result_.begin[at(e)] = size();
        if (t != kNoTwin) {
            result_.inverse[at(t)] = 1;
            stack_.push_back({e, -1, next_halfedge(t), 2});
            return;
        }
        const Index polygon = trees_.component_of_halfedge[at(h)];
        const auto sides = static_cast<Index>(trees_.boundary[at(polygon)].size());
        result_.entrance[at(polygon)] = h;
        stack_.push_back({e, polygon, before_[at(h)], sides - 1});
    }

    /// The polygon's side runs against the mesh's halfedge h.
    void read_polygon_side(Index h) {
        const Index e = c_.edge[at(h)];
        if (trees_.role[at(e)] == EdgeRole::loop) {
            // The lone halfedge of the edge bears the letter; its face reads it forwards.
            read_letter(e, false);
        } else if (trees_.role[at(e)] == EdgeRole::cotree) {
            result_.begin[at(e)] = size();
            result_.inverse[at(h)] = 1;
            stack_.push_back({e, -1, next_halfedge(h), 2});
        }
    }

    const Connectivity& c_;
    const TreeCotree& trees_;
    std::vector<Index> letter_;       // E, letter of a loop edge, else 0
    std::vector<Index> cone_letter_;  // V, letter of a cone, else 0
    std::vector<Index> before_;       // 3F, boundary halfedge before this one
    Index first_boundary_letter_ = 1;
    std::vector<Visit> stack_;
    Contour result_;
};

}  // namespace

Contour trace_contour(const Connectivity& connectivity, const TreeCotree& trees,
                      std::span<const Index> cones) {
    return ContourTracer(connectivity, trees, cones).trace();
}

}  // namespace ricci
