#include "engine/shape_space/coarse_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "engine/layout/final_metric.inl"
#include "engine/shape_space/thinning.h"
#include "engine/topology/boundary_loops.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Vertices so chosen that each has one within `spacing` along edges.
std::vector<std::uint8_t> spaced_vertices(const HyperbolicTriangulation& fine,
                                          const std::vector<Index>& first_out, double spacing) {
    const Connectivity& c = fine.connectivity;
    const std::size_t count = first_out.size();
    std::vector<double> distance(count, std::numeric_limits<double>::infinity());
    std::vector<std::uint8_t> chosen(count, 0);
    using Front = std::pair<double, Index>;
    std::priority_queue<Front, std::vector<Front>, std::greater<>> front;
    const auto reach = [&](Index v, double d) {
        if (d > spacing || d >= distance[at(v)]) return;
        distance[at(v)] = d;
        front.emplace(d, v);
    };
    for (std::size_t v = 0; v < count; ++v) {
        if (first_out[v] == kNoTwin || distance[v] <= spacing) continue;
        chosen[v] = 1;
        reach(static_cast<Index>(v), 0.0);
        while (!front.empty()) {
            const auto [d, w] = front.top();
            front.pop();
            if (d > distance[at(w)]) continue;
            for (Index h = first_out[at(w)];;) {
                reach(c.head(h), d + 2 * std::asinh(fine.half_chord[at(h)]));
                const Index in = prev_halfedge(h);
                if (c.twin[at(in)] == kNoTwin)
                    reach(c.tail[at(in)], d + 2 * std::asinh(fine.half_chord[at(in)]));
                h = c.twin[at(in)];
                if (h == kNoTwin || h == first_out[at(w)]) break;
            }
        }
    }
    return chosen;
}

void locate_vertices(const HyperbolicTriangulation& fine, CoarseSurface& s) {
    for (const Index h : s.reference) {
        s.final_face.push_back(h == kNoTwin ? -1 : fine.final_face[at(face_of(h))]);
        s.in_final_face.emplace_back();
        if (h == kNoTwin) continue;
        const auto first = fine.half_chord.begin() + 3 * face_of(h);
        const FinalMetric<double> triangle =
            make_final_metric<double>(-1, std::vector<double>(first, first + 3));
        s.in_final_face.back() = compose(-1, fine.frame[at(face_of(h))], triangle.to_halfedge(h % 3));
    }
}

/// Boundary components keep their vertices in common with the fine triangulation, which knows the input's.
void name_boundaries(const HyperbolicTriangulation& fine, CoarseSurface& s) {
    std::vector<Index> input_vertex(at(fine.connectivity.vertex_count), -1);
    for (const std::vector<Index>& loop : boundary_loops(fine.connectivity)) {
        Index source = -1;
        for (const Index h : loop)
            source = std::max(source, fine.source_vertex[at(fine.connectivity.tail[at(h)])]);
        for (const Index h : loop) input_vertex[at(fine.connectivity.tail[at(h)])] = source;
    }
    for (const std::vector<Index>& loop : boundary_loops(s.connectivity)) {
        Index source = -1;
        for (const Index h : loop)
            if (const Index f = s.fine_vertex[at(s.connectivity.tail[at(h)])]; f >= 0)
                source = input_vertex[at(f)];
        s.boundary_vertex.push_back(source);
    }
}

/// Numbers what is left, and gives every halfedge its frame.
class Compaction {
  public:
    explicit Compaction(const Thinning& thin)
        : thin_(thin), number_(thin.connectivity().tail.size(), kNoTwin) {}

    CoarseSurface compact() {
        number_faces();
        set_steps();
        set_radii();
        return std::move(s_);
    }

  private:
    void number_faces() {
        const Connectivity& c = thin_.connectivity();
        std::vector<Index> old, vertex(at(c.vertex_count), kNoTwin), tail, twin;
        for (Index v = 0; v < c.vertex_count; ++v)
            if (thin_.outgoing(v) != kNoTwin) {
                vertex[at(v)] = static_cast<Index>(s_.fine_vertex.size());
                s_.fine_vertex.push_back(thin_.reference(v) == kNoTwin ? kNoTwin : v);
                s_.reference.push_back(thin_.reference(v));
            }
        for (Index h = 0; h < c.halfedge_count(); ++h)
            if (thin_.alive(face_of(h))) {
                number_[at(h)] = static_cast<Index>(old.size());
                if (h % 3 == 0) old_face_.push_back(face_of(h));
                old.push_back(h);
            }
        for (const Index h : old) {
            tail.push_back(vertex[at(c.tail[at(h)])]);
            const Index t = c.twin[at(h)];
            twin.push_back(t == kNoTwin ? kNoTwin : number_[at(t)]);
            s_.half_chord.push_back(thin_.half_chord(h));
            angle_.push_back(thin_.angle(h));
            s_.direction.push_back(thin_.direction(h));
        }
        for (Index v = 0; v < c.vertex_count; ++v)
            if (thin_.outgoing(v) != kNoTwin) s_.outgoing.push_back(number_[at(thin_.outgoing(v))]);
        s_.connectivity = connectivity_from_gluing(std::move(tail), std::move(twin),
                                                   static_cast<Index>(s_.fine_vertex.size()));
        const Topology topology = topology_of(s_.connectivity);
        s_.genus = topology.genus;
        s_.boundaries = topology.boundaries;
    }

    /// Angles about a vertex, scaled to their exact sum, counted from its first halfedge.
    void set_steps() {
        for (const Index first : s_.outgoing) {
            std::vector<Index> around;
            double sum = 0;
            for (Index h = first; h != kNoTwin;) {
                around.push_back(h);
                sum += std::atan2(angle_[at(h)].im, angle_[at(h)].re);
                h = s_.turned(h);
                if (h == first) break;
            }
            const bool inner = s_.turned(around.back()) != kNoTwin;
            const double whole = (inner ? 2 : 1) * std::numbers::pi;
            s_.angle_error = std::max(s_.angle_error, std::abs(sum - whole));
            double direction = s_.direction[at(first)];
            for (const Index h : around) {
                s_.direction[at(h)] = direction;
                direction += std::atan2(angle_[at(h)].im, angle_[at(h)].re) * whole / sum;
            }
            if (inner) continue;
            last_direction_.resize(s_.outgoing.size());
            last_direction_[at(s_.connectivity.tail[at(first)])] = direction;
        }
        for (Index h = 0; h < s_.connectivity.halfedge_count(); ++h) s_.step.push_back(step_along(h));
    }

    Isometry<double> step_along(Index h) const {
        const Index t = s_.connectivity.twin[at(h)];
        const double out = s_.direction[at(h)] / 2,
                     back =
                         (t != kNoTwin ? s_.direction[at(t)] : last_direction_[at(s_.connectivity.head(h))]) /
                         2;
        const double s = s_.half_chord[at(h)];
        const Isometry<double> turn{{std::cos(out), std::sin(out)}, {}},
            undo{{std::cos(back), -std::sin(back)}, {}};
        return compose(-1, compose(-1, turn, translation_and_turn(s, std::sqrt(1 + s * s))), undo);
    }

    void set_radii() {
        s_.radius.assign(s_.fine_vertex.size(), 0.0);
        for (Index h = 0; h < s_.connectivity.halfedge_count(); h += 3) {
            const double radius = thin_.covering_radius(old_face_[at(face_of(h))]);
            for (Index k = h; k < h + 3; ++k) {
                double& r = s_.radius[at(s_.connectivity.tail[at(k)])];
                r = std::max(r, radius);
            }
        }
    }

    const Thinning& thin_;
    std::vector<Index> number_, old_face_;
    std::vector<Complex<double>> angle_;
    std::vector<double> last_direction_;  // per boundary vertex: of the boundary edge that arrives, backwards
    CoarseSurface s_;
};

}  // namespace

CoarseSurface make_coarse_surface(const HyperbolicTriangulation& fine, const CoarseOptions& options) {
    Thinning thin(fine);
    std::vector<Index> first_out(at(fine.connectivity.vertex_count));
    for (Index v = 0; v < fine.connectivity.vertex_count; ++v) first_out[at(v)] = thin.outgoing(v);
    const std::vector<std::uint8_t> keep = spaced_vertices(fine, first_out, options.spacing);
    thin.make_delaunay();
    for (Index v = 0; v < fine.connectivity.vertex_count; ++v)
        if (!keep[at(v)]) thin.remove(v);
    thin.limit_radius(options.largest_radius);
    CoarseSurface surface = Compaction(thin).compact();
    locate_vertices(fine, surface);
    name_boundaries(fine, surface);
    return surface;
}

}  // namespace ricci
