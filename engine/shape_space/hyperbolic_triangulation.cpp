#include "engine/shape_space/hyperbolic_triangulation.h"

#include <cmath>
#include <numeric>

#include "engine/quality/piece_image.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// sinh of half the distance of two points of the hyperboloid.
double half_chord_between(const std::array<double, 3>& p, const std::array<double, 3>& q) {
    const double x = p[0] - q[0], y = p[1] - q[1], t = p[2] - q[2];
    return std::sqrt(std::max(0.0, x * x + y * y - t * t)) / 2;
}

/// The isometry that takes the origin to p and the x axis into the direction of q.
Isometry<double> frame_at(const std::array<double, 3>& p, const std::array<double, 3>& q) {
    const Isometry<double> move = motion_to(-1, p);
    const std::array<double, 3> seen = apply(-1, inverse(move), q);
    const double half = std::atan2(seen[1], seen[0]) / 2;
    return compose(-1, move, Isometry<double>{{std::cos(half), std::sin(half)}, {}});
}

/// Cuts the final faces into what lies on this side of the mirror.
class HalfBuilder {
  public:
    HalfBuilder(const CommonRefinement& refinement, const FinalMetric<double>& metric)
        : r_(refinement), metric_(metric), side_of_(refinement.vertex.size(), kNone) {}

    HyperbolicTriangulation build() {
        vertex_.assign(at(r_.vertex_count), kNone);
        for (Index c = 0; c < r_.corner_count(); ++c)
            if (is_outer(c) && starts_side(c) && side_of_[at(c)] == kNone) add_polygon(c);
        std::vector<Index> twin(tail_.size(), kNoTwin);
        for (std::size_t h = 0; h < tail_.size(); ++h) twin[h] = twin_of(h);
        out_.connectivity =
            connectivity_from_gluing(tail_, std::move(twin), static_cast<Index>(out_.source_vertex.size()));
        return std::move(out_);
    }

  private:
    static constexpr Index kNone = -1;

    bool is_outer(Index c) const { return r_.final_halfedge[at(c)] >= 0 || r_.twin[at(c)] < 0; }
    /// Whether the side starts where the outline of its final face's part turns, or another one begins.
    bool starts_side(Index c) const {
        if (r_.vertex[at(c)] < r_.input_vertices) return true;
        return (r_.twin[at(previous_outer(c))] < 0) != (r_.twin[at(c)] < 0);
    }
    /// The outer side that ends where c's begins, of the same part.
    Index previous_outer(Index c) const {
        Index p = r_.previous(c);
        while (!is_outer(p)) p = r_.previous(r_.twin[at(p)]);
        return p;
    }
    Index next_outer(Index c) const {
        Index n = r_.next(c);
        while (!is_outer(n)) n = r_.next(r_.twin[at(n)]);
        return n;
    }
    Index vertex_of(Index c) {
        Index& v = vertex_[at(r_.vertex[at(c)])];
        if (v == kNone) {
            v = static_cast<Index>(out_.source_vertex.size());
            out_.source_vertex.push_back(r_.vertex[at(c)] < r_.input_vertices ? r_.vertex[at(c)] : kNone);
        }
        return v;
    }

    /// The convex part of a final face whose outline passes through `first`, as a fan.
    void add_polygon(Index first) {
        std::vector<Index> corners;
        Index c = first;
        do {
            if (starts_side(c)) corners.push_back(c);
            c = next_outer(c);
        } while (c != first);
        for (std::size_t k = 0; k < corners.size(); ++k) side_of_[at(corners[k])] = 0;
        const std::size_t n = corners.size();
        for (std::size_t k = 1; k + 1 < n; ++k) {
            const std::array<Index, 3> triangle{corners[0], corners[k], corners[k + 1]};
            std::array<std::array<double, 3>, 3> p;
            for (std::size_t i = 0; i < 3; ++i) p[i] = piece_point(metric_, r_, triangle[i]);
            const auto h = static_cast<Index>(tail_.size());
            for (std::size_t i = 0; i < 3; ++i) {
                tail_.push_back(vertex_of(triangle[i]));
                out_.half_chord.push_back(half_chord_between(p[i], p[(i + 1) % 3]));
            }
            // Sides of the part by the corner that starts them; diagonals by the neighbour in the fan.
            side_.insert(side_.end(),
                         {k == 1 ? corners[0] : kNone, corners[k], k + 2 == n ? corners[k + 1] : kNone});
            diagonal_.insert(diagonal_.end(), {k == 1 ? kNone : h - 1, kNone, k + 2 == n ? kNone : h + 3});
            if (k == 1) side_of_[at(corners[0])] = h;
            side_of_[at(corners[k])] = h + 1;
            if (k + 2 == n) side_of_[at(corners[k + 1])] = h + 2;
            out_.final_face.push_back(r_.final_face[at(r_.piece[at(triangle[0])])]);
            out_.frame.push_back(frame_at(p[0], p[1]));
        }
    }

    Index twin_of(std::size_t h) const {
        if (diagonal_[h] != kNone) return diagonal_[h];
        // The neighbour's side runs the other way: it starts where this one ends. Follow this one's last
        // stretch across, and back to the start of the side it belongs to.
        Index last = side_[h];
        if (r_.twin[at(last)] < 0) return kNoTwin;
        Index n = next_outer(last);
        while (!starts_side(n)) {
            last = n;
            n = next_outer(n);
        }
        return side_of_[at(r_.twin[at(last)])];
    }

    const CommonRefinement& r_;
    const FinalMetric<double>& metric_;
    HyperbolicTriangulation out_;
    std::vector<Index> vertex_;                  // of the refinement -> new number
    std::vector<Index> tail_, side_, diagonal_;  // per new halfedge
    std::vector<Index> side_of_;                 // per corner that starts a side: its halfedge
};

}  // namespace

HyperbolicTriangulation closed_triangulation(const Connectivity& final_triangulation,
                                             std::vector<double> half_chord) {
    HyperbolicTriangulation out;
    out.connectivity = final_triangulation;
    out.half_chord = std::move(half_chord);
    out.source_vertex.resize(at(final_triangulation.vertex_count));
    std::iota(out.source_vertex.begin(), out.source_vertex.end(), 0);
    out.final_face.resize(at(final_triangulation.face_count()));
    std::iota(out.final_face.begin(), out.final_face.end(), 0);
    out.frame.assign(out.final_face.size(), Isometry<double>{});
    return out;
}

HyperbolicTriangulation half_triangulation(const CommonRefinement& refinement,
                                           const FinalMetric<double>& metric) {
    return HalfBuilder(refinement, metric).build();
}

}  // namespace ricci
