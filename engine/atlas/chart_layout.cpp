#include "engine/atlas/chart_layout.h"

#include <algorithm>
#include <cmath>

#include "engine/atlas/simple_polygon.h"
#include "engine/quality/piece_image.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The middle of a piece in the frame of its final face.
std::array<double, 3> middle_of(const FinalMetric<double>& metric, const CommonRefinement& r, Index piece) {
    std::array<double, 3> sum{};
    for (Index c = r.first[at(piece)]; c < r.first[at(piece) + 1]; ++c) {
        const auto x = piece_point(metric, r, c);
        for (std::size_t k = 0; k < 3; ++k) sum[k] += x[k];
    }
    const double norm = std::sqrt(sum[2] * sum[2] + metric.kappa * (sum[0] * sum[0] + sum[1] * sum[1]));
    for (double& value : sum) value /= norm;
    return sum;
}

/// The plane, Klein's disk: where geodesics are straight.
std::array<double, 2> straight_point(const std::array<double, 3>& x) {
    return {x[0] / x[2], x[1] / x[2]};
}

}  // namespace

ChartLayout::ChartLayout(const CommonRefinement& refinement, const FinalMetric<double>& metric,
                         AtlasKind kind)
    : r_(refinement),
      metric_(metric),
      kind_(kind),
      star_size_(at(refinement.vertex_count), 0),
      frame_(at(refinement.piece_count())),
      piece_in_(at(refinement.piece_count()), 0),
      known_(at(refinement.piece_count()), 0),
      position_(at(refinement.input_vertices)),
      about_(at(refinement.vertex_count), 0) {
    Index faces = 0;
    for (const Index f : r_.input_face) faces = std::max(faces, f + 1);
    pieces_of_face_.assign(at(faces), 0);
    for (const Index f : r_.input_face) ++pieces_of_face_[at(f)];
    for (const Index v : r_.vertex) ++star_size_[at(v)];
}

std::optional<Chart> ChartLayout::lay_out(std::span<const Index> pieces) {
    std::fill(piece_in_.begin(), piece_in_.end(), std::uint8_t{0});
    std::fill(known_.begin(), known_.end(), std::uint8_t{0});
    for (const Index p : pieces) piece_in_[at(p)] = 1;
    Chart chart;
    chart.seed_face = r_.input_face[at(pieces.front())];
    carry_frames(pieces.front(), chart);
    if (metric_.kappa <= 0 && !rim_is_simple(chart)) return std::nullopt;
    list_faces(chart);
    list_inside(chart);
    place_vertices(chart);
    for (const Index p : chart.pieces) chart.frame.push_back(frame_[at(p)]);
    return chart;
}

void ChartLayout::carry_frames(Index root, Chart& chart) {
    const Connectivity& last = r_.final_triangulation.connectivity;
    std::vector<Index>& queue = chart.pieces;
    queue.assign(1, root);
    known_[at(root)] = 1;
    frame_[at(root)] = inverse(motion_to(metric_.kappa, middle_of(metric_, r_, root)));
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Index p = queue[i];
        for (Index c = r_.first[at(p)]; c < r_.first[at(p) + 1]; ++c) {
            if (r_.twin[at(c)] < 0) continue;
            const Index q = r_.piece[at(r_.twin[at(c)])], g = r_.final_halfedge[at(c)];
            if (piece_in_[at(q)] == 0 || known_[at(q)] != 0) continue;
            known_[at(q)] = 1;
            frame_[at(q)] =
                g < 0 ? frame_[at(p)] : compose(metric_.kappa, frame_[at(p)], metric_.crossing(last, g));
            // Charts do not reach far, so the norm is known to all digits.
            if (i % 16 == 0) normalise(metric_.kappa, frame_[at(q)]);
            queue.push_back(q);
        }
    }
    std::sort(queue.begin(), queue.end());
}

void ChartLayout::list_faces(Chart& chart) const {
    std::vector<Index> face;
    for (const Index p : chart.pieces) face.push_back(r_.input_face[at(p)]);
    std::sort(face.begin(), face.end());
    for (std::size_t i = 0; i < face.size();) {
        std::size_t j = i;
        while (j < face.size() && face[j] == face[i]) ++j;
        if (static_cast<Index>(j - i) == pieces_of_face_[at(face[i])]) chart.faces.push_back(face[i]);
        i = j;
    }
}

void ChartLayout::list_inside(const Chart& chart) {
    inside_.clear();
    std::fill(about_.begin(), about_.end(), 0);
    for (const Index p : chart.pieces)
        for (Index c = r_.first[at(p)]; c < r_.first[at(p) + 1]; ++c) {
            const Index v = r_.vertex[at(c)];
            if (++about_[at(v)] == star_size_[at(v)]) inside_.push_back(v);
        }
}

void ChartLayout::place_vertices(Chart& chart) {
    constexpr std::array<double, 3> kNowhere{};  // t = 0
    std::fill(position_.begin(), position_.end(), kNowhere);
    for (const Index p : chart.pieces)
        for (Index c = r_.first[at(p)]; c < r_.first[at(p) + 1]; ++c) {
            const Index v = r_.vertex[at(c)];
            if (v >= r_.input_vertices) continue;
            const auto x = apply(metric_.kappa, frame_[at(p)], piece_point(metric_, r_, c));
            auto& known = position_[at(v)];
            if (known == kNowhere) {
                known = x;
                chart.vertices.push_back(v);
            }
            const double apart = point_distance(metric_.kappa, known, x);
            if (apart > chart.closing_error || std::isnan(apart)) chart.closing_error = apart;
        }
    std::sort(chart.vertices.begin(), chart.vertices.end());
    for (const Index v : chart.vertices) {
        const auto& x = position_[at(v)];
        chart.inside.push_back(about_[at(v)] == star_size_[at(v)] ? 1 : 0);
        chart.radius = std::max(chart.radius, point_distance(metric_.kappa, {0.0, 0.0, 1.0}, x));
        const std::array<double, 3> m = model_point(kind_, x);
        chart.point.insert(chart.point.end(), m.begin(), m.begin() + (kind_ == AtlasKind::spherical ? 3 : 2));
    }
}

bool ChartLayout::rim_is_simple(const Chart& chart) const {
    std::vector<RimSegment> rim;
    for (const Index p : chart.pieces)
        for (Index c = r_.first[at(p)]; c < r_.first[at(p) + 1]; ++c) {
            const Index t = r_.twin[at(c)];
            if (t >= 0 && piece_in_[at(r_.piece[at(t)])] != 0) continue;
            const auto place = [&](Index corner) {
                return straight_point(apply(metric_.kappa, frame_[at(p)], piece_point(metric_, r_, corner)));
            };
            rim.push_back({place(c), place(r_.next(c)), r_.vertex[at(c)], r_.vertex[at(r_.next(c))]});
        }
    return is_simple(std::move(rim));
}

}  // namespace ricci
