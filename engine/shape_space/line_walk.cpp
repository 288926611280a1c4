#include "engine/shape_space/line_walk.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/quality/piece_image.h"

namespace ricci {
namespace {

using Vector = std::array<double, 3>;

constexpr double kTouching = 1e-8;  // of a piece's extent: a corner so near to the line lies on it

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The combination of the final face's corners that a piece's corner is, at the scale of its weights.
Vector weighted(const CommonRefinement& r, Index corner, const std::array<Vector, 3>& vertex) {
    const Vector& w = r.weight[at(corner)];
    Vector x{};
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < 3; ++i) x[i] += w[k] * vertex[k][i];
    return x;
}

double weight_sum(const CommonRefinement& r, Index corner) {
    const Vector& w = r.weight[at(corner)];
    return w[0] + w[1] + w[2];
}

/// The combination `w` of the corners of final face f as a point. The norm comes from lengths, as in
/// piece_image.cpp.
Vector face_point(const FinalMetric<double>& metric, Index f, const Vector& w) {
    const auto vertex = metric.corners(f);
    double mixed = 0.0;
    Vector x{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double s = metric.half_chord[3 * at(f) + k];
        mixed += w[k] * w[(k + 1) % 3] * s * s;
        for (std::size_t i = 0; i < 3; ++i) x[i] += w[k] * vertex[k][i];
    }
    const double sum = w[0] + w[1] + w[2], norm = std::sqrt(sum * sum - 4.0 * metric.kappa * mixed);
    for (double& value : x) value /= norm;
    return x;
}

}  // namespace

void LineWalk::measure(Index piece, const LineNormal& normal, bool touching_left) {
    const CommonRefinement& r = *refinement_;
    const auto vertex = metric_->corners(r.final_face[at(piece)]);
    side_.clear();
    left_.clear();
    Vector low{}, high{};
    for (Index c = r.first[at(piece)]; c < r.first[at(piece) + 1]; ++c) {
        const Vector x = weighted(r, c, vertex);
        side_.push_back(line_side(metric_->kappa, normal, x));
        const double sum = weight_sum(r, c);
        for (std::size_t k = 0; k < 2; ++k) {
            low[k] = side_.size() == 1 ? x[k] / sum : std::min(low[k], x[k] / sum);
            high[k] = side_.size() == 1 ? x[k] / sum : std::max(high[k], x[k] / sum);
        }
    }
    const double touching = kTouching * std::hypot(high[0] - low[0], high[1] - low[1]);
    for (Index c = r.first[at(piece)]; c < r.first[at(piece) + 1]; ++c)
        left_.push_back(side_[left_.size()] > (touching_left ? -touching : touching) * weight_sum(r, c));
}

/// Where the line crosses the side of a corner of the measured piece.
SidePoint LineWalk::crossing(Index corner) const {
    const CommonRefinement& r = *refinement_;
    const Index first = r.first[at(r.piece[at(corner)])];
    const double p = side_[at(corner - first)], q = side_[at(r.next(corner) - first)];
    // What was decided elsewhere may contradict these by a rounding.
    const double along = p == q ? 0.5 : std::clamp(p / (p - q), 0.0, 1.0);
    return {corner, along};
}

/// The first side counterclockwise after `entry` that runs from the right of the line to its left.
std::optional<Index> LineWalk::exit_after(Index entry) const {
    const CommonRefinement& r = *refinement_;
    const Index first = r.first[at(r.piece[at(entry)])];
    for (Index c = r.next(entry); c != entry; c = r.next(c))
        if (!left_[at(c - first)] && left_[at(r.next(c) - first)]) return c;
    return std::nullopt;
}

std::optional<Passage> LineWalk::through(Index piece, const LineNormal& normal, bool touching_left) {
    const CommonRefinement& r = *refinement_;
    measure(piece, normal, touching_left);
    const Index first = r.first[at(piece)];
    for (Index c = first; c < r.first[at(piece) + 1]; ++c) {
        if (!left_[at(c - first)] || left_[at(r.next(c) - first)]) continue;
        const std::optional<Index> exit = exit_after(c);
        Passage passage{crossing(c), crossing(*exit), 0.0, normal};
        passage.length = distance(passage.entry, passage.exit);
        return passage;
    }
    return std::nullopt;
}

Passage LineWalk::from(const SidePoint& entry, const LineNormal& normal, bool touching_left) {
    const CommonRefinement& r = *refinement_;
    const Index first = r.first[at(r.piece[at(entry.corner)])];
    measure(r.piece[at(entry.corner)], normal, touching_left);
    left_[at(entry.corner - first)] = 1;
    left_[at(r.next(entry.corner) - first)] = 0;
    Passage passage{entry, crossing(*exit_after(entry.corner)), 0.0, normal};
    passage.length = distance(passage.entry, passage.exit);
    return passage;
}

Passage LineWalk::next(const Passage& passage, bool touching_left) {
    const Index corner = passage.exit.corner;
    if (refinement_->twin[at(corner)] < 0)
        throw LeavesSurface("a geodesic leaves the surface " + place_of(corner));
    return from(across(passage.exit), across(corner, passage.normal), touching_left);
}

LineNormal LineWalk::across(Index corner, const LineNormal& normal) const {
    const Index g = refinement_->final_halfedge[at(corner)];
    if (g < 0) return normal;
    const Connectivity& c = refinement_->final_triangulation.connectivity;
    const Isometry<double> back = inverse(metric_->crossing(c, g));
    return unit_normal(metric_->kappa, moved_line(metric_->kappa, back, normal));
}

SidePoint LineWalk::across(const SidePoint& point) const {
    return {refinement_->twin[at(point.corner)], 1.0 - point.along};
}

Vector LineWalk::position(const SidePoint& point) const {
    const CommonRefinement& r = *refinement_;
    const Index f = r.final_face[at(r.piece[at(point.corner)])];
    const Vector &p = r.weight[at(point.corner)], &q = r.weight[at(r.next(point.corner))];
    Vector w{};
    for (std::size_t k = 0; k < 3; ++k) w[k] = (1.0 - point.along) * p[k] + point.along * q[k];
    return face_point(*metric_, f, w);
}

Vector LineWalk::middle(Index piece) const {
    const CommonRefinement& r = *refinement_;
    Vector w{};
    for (Index c = r.first[at(piece)]; c < r.first[at(piece) + 1]; ++c)
        for (std::size_t k = 0; k < 3; ++k) w[k] += r.weight[at(c)][k];
    return face_point(*metric_, r.final_face[at(piece)], w);
}

Point LineWalk::in_space(const SidePoint& point) const {
    const CommonRefinement& r = *refinement_;
    const Point &p = r.points[at(r.vertex[at(point.corner)])],
                &q = r.points[at(r.vertex[at(r.next(point.corner))])];
    Point x{};
    for (std::size_t k = 0; k < 3; ++k) x[k] = (1.0 - point.along) * p[k] + point.along * q[k];
    return x;
}

double LineWalk::distance(const SidePoint& p, const SidePoint& q) const {
    return point_distance(metric_->kappa, position(p), position(q));
}

/// "at the boundary edge between vertices 3 and 17".
std::string LineWalk::place_of(Index corner) const {
    const CommonRefinement& r = *refinement_;
    // Along the boundary to the input's vertices on either side.
    Index back = corner, ahead = r.next(corner);
    const auto crossing = [&](Index c) { return r.vertex[at(c)] >= r.input_vertices; };
    while (crossing(back)) {
        back = r.previous(back);
        while (r.twin[at(back)] >= 0) back = r.previous(r.twin[at(back)]);
    }
    while (crossing(ahead)) {
        while (r.twin[at(ahead)] >= 0) ahead = r.next(r.twin[at(ahead)]);
        ahead = r.next(ahead);
    }
    return "at the boundary edge between vertices " + std::to_string(r.vertex[at(back)]) + " and " +
           std::to_string(r.vertex[at(ahead)]);
}

}  // namespace ricci
