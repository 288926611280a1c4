#include "engine/topology/cut_graph.h"

#include <algorithm>
#include <numeric>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Number of cut edge-ends at every vertex; a loop counts twice. // V
std::vector<Index> cut_degrees(const Connectivity& c, std::span<const std::uint8_t> cut) {
    std::vector<Index> degree(at(c.vertex_count), 0);
    for (Index h = 0; h < c.halfedge_count(); ++h)  // either end of an edge is the tail of one halfedge
        if (cut[at(c.edge[at(h)])] != 0) ++degree[at(c.tail[at(h)])];
    return degree;
}

class Cutter {
  public:
    Cutter(const Connectivity& c, const HomotopyBasis& basis)
        : c_(c),
          basis_(basis),
          halfedge_(edge_halfedges(c)),
          stays_(boundary_vertices(c)),
          cut_(at(c.edge_count), 0) {
        for (const Index v : basis.cones()) stays_[at(v)] = 1;
    }

    std::vector<std::uint8_t> cut() {
        mark();
        join_pieces();
        prune();
        return std::move(cut_);
    }

  private:
    void mark_edge(Step step) {
        const Index h = halfedge_of(step);
        if (c_.twin[at(h)] != kNoTwin) cut_[at(c_.edge[at(h)])] = 1;
    }

    void mark_path_to(Index v) {
        for (const Step s : basis_.tree_path(v)) mark_edge(s);
    }

    void mark() {
        for (Index k = 0; k < basis_.loops(); ++k) {
            const Index h = basis_.loop_halfedge(k);
            mark_edge(h);
            mark_path_to(c_.tail[at(h)]);
            mark_path_to(c_.head(h));
        }
        const std::vector<double>& distance = basis_.tree().distance;
        for (Index j = 0; j < basis_.boundaries(); ++j) {
            Index nearest = -1;
            for (const Index h : basis_.boundary_walk(j)) {
                const Index v = c_.tail[at(h)];
                const bool nearer = nearest == -1 || distance[at(v)] < distance[at(nearest)] ||
                                    (distance[at(v)] == distance[at(nearest)] && v < nearest);
                if (nearer) nearest = v;
            }
            mark_path_to(nearest);
        }
        for (const Index v : basis_.cones()) mark_path_to(v);
    }

    Index find(std::vector<Index>& parent, Index f) const {
        while (parent[at(f)] != f) {
            parent[at(f)] = parent[at(parent[at(f)])];
            f = parent[at(f)];
        }
        return f;
    }

    /// True where the faces on both sides of the edge were in different pieces, which then are one.
    bool unite_sides(std::vector<Index>& piece, Index e) const {
        const Index h = halfedge_[at(e)];
        const Index a = find(piece, face_of(h)), b = find(piece, face_of(c_.twin[at(h)]));
        piece[at(std::max(a, b))] = std::min(a, b);
        return a != b;
    }

    /// Heals cut edges between different pieces, the farthest from the base first, until one is left.
    void join_pieces() {
        std::vector<Index> piece(at(c_.face_count()));
        std::iota(piece.begin(), piece.end(), Index{0});
        std::vector<Index> cut_edges;
        for (Index e = 0; e < c_.edge_count; ++e) {
            if (c_.twin[at(halfedge_[at(e)])] == kNoTwin) continue;
            if (cut_[at(e)] != 0) {
                cut_edges.push_back(e);
            } else {
                unite_sides(piece, e);
            }
        }
        const std::vector<double>& d = basis_.tree().distance;
        const auto reach = [&](Index e) {
            const Index h = halfedge_[at(e)];
            return d[at(c_.tail[at(h)])] + d[at(c_.head(h))];
        };
        std::stable_sort(cut_edges.begin(), cut_edges.end(),
                         [&](Index e, Index f) { return reach(e) > reach(f); });
        for (const Index e : cut_edges) {
            if (unite_sides(piece, e)) cut_[at(e)] = 0;
        }
    }

    /// Removes chains that end neither on the boundary nor at a cone.
    void prune() {
        const VertexStars stars = vertex_stars(c_);
        std::vector<Index> degree = cut_degrees(c_, cut_);
        for (Index start = 0; start < c_.vertex_count; ++start) {
            Index v = start;
            while (degree[at(v)] == 1 && stays_[at(v)] == 0) {
                const auto leaving = stars.leaving(v);
                const Step s = *std::find_if(leaving.begin(), leaving.end(), [this](Step step) {
                    return cut_[at(c_.edge[at(halfedge_of(step))])] != 0;
                });
                cut_[at(c_.edge[at(halfedge_of(s))])] = 0;
                --degree[at(v)];
                v = step_head(c_, s);
                --degree[at(v)];
            }
        }
    }

    const Connectivity& c_;
    const HomotopyBasis& basis_;
    std::vector<Index> halfedge_;      // E
    std::vector<std::uint8_t> stays_;  // V, 1 where a cut may end
    std::vector<std::uint8_t> cut_;    // E
};

/// Reads the boundary of the disk and groups it into sides.
class SideReader {
  public:
    SideReader(const Connectivity& c, const HomotopyBasis& basis, std::span<const std::uint8_t> cut)
        : c_(c), cut_(cut), node_(boundary_vertices(c)), component_(c.tail.size(), -1) {
        const std::vector<Index> degree = cut_degrees(c, cut);
        for (std::size_t v = 0; v < node_.size(); ++v)
            if (degree[v] != 2) node_[v] = 1;
        node_[at(basis.base())] = 1;
        for (const Index v : basis.cones()) node_[at(v)] = 1;
        for (Index j = 0; j < basis.boundaries(); ++j)
            for (const Index h : basis.boundary_walk(j)) component_[at(h)] = j;
        base_ = basis.base();
    }

    std::vector<CutSide> read() const {
        const std::vector<Index> rim = disk_boundary();
        std::vector<CutSide> sides;
        std::vector<Index> side_of(c_.tail.size(), -1);
        for (std::size_t i = 0; i < rim.size(); ++i) {
            if (i == 0 || breaks(rim[i - 1], rim[i])) {
                sides.emplace_back();
                sides.back().boundary = component_[at(rim[i])];
            }
            sides.back().halfedges.push_back(rim[i]);
            side_of[at(rim[i])] = static_cast<Index>(sides.size()) - 1;
        }
        for (CutSide& side : sides)
            if (side.boundary == -1) side.partner = side_of[at(c_.twin[at(side.halfedges.back())])];
        name(sides);
        return sides;
    }

  private:
    [[nodiscard]] bool on_rim(Index h) const {
        return c_.twin[at(h)] == kNoTwin || cut_[at(c_.edge[at(h)])] != 0;
    }

    [[nodiscard]] Index next_on_rim(Index h) const {
        Index n = next_halfedge(h);
        while (!on_rim(n)) n = next_halfedge(c_.twin[at(n)]);
        return n;
    }

    /// Whether a side ends between h and its successor n on the rim. Two boundary edges that follow each
    /// other have no cut between them.
    [[nodiscard]] bool breaks(Index h, Index n) const {
        const bool h_cut = c_.twin[at(h)] != kNoTwin, n_cut = c_.twin[at(n)] != kNoTwin;
        return h_cut != n_cut || (h_cut && node_[at(c_.tail[at(n)])] != 0);
    }

    /// All halfedges of the rim in order, from the start of a side: at the base if the rim passes it.
    [[nodiscard]] std::vector<Index> disk_boundary() const {
        Index first = -1, start = -1;
        for (Index h = c_.halfedge_count() - 1; h >= 0; --h)
            if (on_rim(h)) first = h;
        if (first == -1) return {};
        std::vector<Index> rim = {first};
        for (Index h = next_on_rim(first); h != first; h = next_on_rim(h)) rim.push_back(h);
        const auto better = [this](Index h, Index than) {
            const bool h_at_base = c_.tail[at(h)] == base_, than_at_base = c_.tail[at(than)] == base_;
            return h_at_base != than_at_base ? h_at_base : h < than;
        };
        for (std::size_t i = 0; i < rim.size(); ++i) {
            const Index before = rim[i == 0 ? rim.size() - 1 : i - 1];
            if (breaks(before, rim[i]) && (start == -1 || better(rim[i], start))) start = rim[i];
        }
        if (start != -1) std::rotate(rim.begin(), std::find(rim.begin(), rim.end(), start), rim.end());
        return rim;
    }

    void name(std::vector<CutSide>& sides) const {
        Index count = 0;
        for (CutSide& side : sides) {
            if (side.boundary >= 0) {
                side.name = "c" + std::to_string(side.boundary + 1);
            } else if (side.name.empty()) {
                side.name = "s" + std::to_string(++count);
                sides[at(side.partner)].name = side.name + "^-1";
            }
        }
    }

    const Connectivity& c_;
    std::span<const std::uint8_t> cut_;
    std::vector<std::uint8_t> node_;  // V
    std::vector<Index> component_;    // 3F, boundary component, else -1
    Index base_ = 0;
};

}  // namespace

CutGraph make_cut_graph(const Connectivity& connectivity, const HomotopyBasis& basis) {
    CutGraph graph;
    graph.cut = Cutter(connectivity, basis).cut();
    graph.sides = SideReader(connectivity, basis, graph.cut).read();
    return graph;
}

Index euler_characteristic_after(const Connectivity& connectivity, std::span<const std::uint8_t> cut) {
    const Connectivity& c = connectivity;
    const std::vector<Index> degree = cut_degrees(c, cut);
    const std::vector<std::uint8_t> used = used_vertices(c), boundary = boundary_vertices(c);
    Index characteristic = c.face_count() - c.edge_count;
    for (Index v = 0; v < c.vertex_count; ++v) {
        if (used[at(v)] != 0)
            characteristic += boundary[at(v)] != 0 ? 1 + degree[at(v)] : std::max(Index{1}, degree[at(v)]);
    }
    for (const std::uint8_t is_cut : cut) characteristic -= is_cut;
    return characteristic;
}

}  // namespace ricci
