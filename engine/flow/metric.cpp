#include "engine/flow/metric.h"

#include <cmath>
#include <numeric>
#include <type_traits>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Sums in fixed order; faces are too few for the order to cost anything.
template <class Real>
double sum_of(std::span<const Real> values) {
    return static_cast<double>(std::accumulate(values.begin(), values.end(), Real(0)));
}

template <class Real>
IntrinsicTriangulation<Real> start_of(const FlowSurface& surface) {
    if constexpr (std::is_same_v<Real, double>) {
        return rounded(surface.triangulation);
    } else {
        return surface.triangulation;
    }
}

}  // namespace

Metric::Metric(const FlowSurface& surface, Geometry geometry, bool parallel)
    : surface_(&surface),
      geometry_(geometry),
      parallel_(parallel),
      u_(surface.orbit.size(), 0.0),
      curvature_(at(surface.vertex_count()), 0.0) {
    const std::size_t halfedges = surface.triangulation.log_chord.size();
    off_.resize(halfedges);
    diagonal_.resize(halfedges);
}

template <class Real>
bool Metric::fold_curvature(std::span<const Real> total) {
    // In Real until the end: 2 pi minus an angle sum must not lose what extended precision gained. The
    // constant full angle is pi or 2 pi exactly; its double value is corrected by the long double one.
    std::vector<Real> sum(curvature_.size(), Real(0));
    for (std::size_t s = 0; s < total.size(); ++s) {
        const Real full =
            surface_->full_angle[s] > 4.0 ? Real(2) * std::numbers::pi_v<Real> : std::numbers::pi_v<Real>;
        sum[at(surface_->orbit[s])] += full - total[s];
    }
    bool finite = true;
    for (std::size_t v = 0; v < sum.size(); ++v) {
        curvature_[v] = surface_->used[v] ? static_cast<double>(Real(surface_->side) * sum[v]) : 0.0;
        finite = finite && std::isfinite(curvature_[v]);
    }
    return finite;
}

template <class Real>
ScaledMetric<Real>::ScaledMetric(const FlowSurface& surface, Geometry geometry, bool parallel)
    : Metric(surface, geometry, parallel),
      triangulation_(start_of<Real>(surface)),
      angle_(triangulation_.log_chord.size()),
      total_(surface.orbit.size()),
      face_area_(angle_.size() / 3) {}

template <class Real>
bool ScaledMetric<Real>::move_to(std::span<const double> u) {
    for (std::size_t s = 0; s < u_.size(); ++s) u_[s] = u[at(surface_->orbit[s])];
    const FlipCount count = make_delaunay<Real>(triangulation_, u_, FlipRule::ptolemy, workspace_);
    flips_ += count.flips;
    touched_faces_.insert(touched_faces_.end(), workspace_.touched_faces.begin(),
                          workspace_.touched_faces.end());
    return count.finished;
}

template <class Real>
void ScaledMetric<Real>::save() {
    saved_ = triangulation_;
    saved_flips_ = flips_;
    saved_touched_ = touched_faces_.size();
}

template <class Real>
void ScaledMetric<Real>::restore() {
    if (flips_ == saved_flips_) return;
    triangulation_ = saved_;
    flips_ = saved_flips_;
    touched_faces_.resize(saved_touched_);
}

template <class Real>
bool ScaledMetric<Real>::evaluate(bool derivatives) {
    const ScaledChords<Real> chords{triangulation_.connectivity.tail, triangulation_.log_chord, u_};
    FaceFields<Real> fields{angle_, {}, {}, face_area_};
    if (derivatives) {
        fields.off = off_;
        fields.diagonal = diagonal_;
    }
    const std::int64_t broken = evaluate_faces<Real>(geometry_, chords, fields, parallel_);
    sum_corners<Real>(triangulation_.connectivity.tail, angle_, total_);
    area_ = surface_->side * sum_of<Real>(face_area_);
    return fold_curvature<Real>(total_) && broken == 0;
}

template <class Real>
std::vector<double> ScaledMetric<Real>::edge_lengths() const {
    const Connectivity& c = triangulation_.connectivity;
    std::vector<double> length(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Real sum = Real(u_[at(c.tail[at(h)])]) + Real(u_[at(c.head(h))]);
        const Real chord = std::exp(triangulation_.log_chord[at(h)] + Real(0.5) * sum);
        const Real value = geometry_ == Geometry::euclidean
                               ? chord
                               : (geometry_ == Geometry::hyperbolic ? Real(2) * std::asinh(chord / Real(2))
                                                                    : Real(2) * std::asin(chord / Real(2)));
        length[at(h)] = static_cast<double>(value);
    }
    return length;
}

template <class Real>
void ScaledMetric<Real>::reset(const IntrinsicTriangulation<Real>& start) {
    triangulation_ = start;
    flips_ = 0;
    touched_faces_.clear();
}

template class ScaledMetric<double>;
template class ScaledMetric<long double>;

PackedMetric::PackedMetric(const FlowSurface& surface, const CirclePacking& packing, Geometry geometry,
                           bool parallel)
    : Metric(surface, geometry, parallel),
      eps_(surface.orbit.size()),
      eta_(packing.eta),
      angle_(packing.eta.size()),
      total_(surface.orbit.size()),
      face_area_(packing.eta.size() / 3) {
    for (std::size_t s = 0; s < eps_.size(); ++s) eps_[s] = packing.eps[s];
}

PackedCircles PackedMetric::circles() const {
    return {connectivity().tail, eta_, eps_, u_};
}

bool PackedMetric::move_to(std::span<const double> u) {
    for (std::size_t s = 0; s < u_.size(); ++s) u_[s] = u[at(surface_->orbit[s])];
    return true;
}

bool PackedMetric::evaluate(bool derivatives) {
    FaceFields<double> fields{angle_, {}, {}, face_area_};
    if (derivatives) {
        fields.off = off_;
        fields.diagonal = diagonal_;
    }
    const std::int64_t broken = evaluate_faces(geometry_, circles(), fields, parallel_);
    sum_corners<double>(connectivity().tail, angle_, total_);
    area_ = surface_->side * sum_of<double>(face_area_);
    return fold_curvature<double>(total_) && broken == 0;
}

std::vector<double> PackedMetric::edge_lengths() const {
    std::vector<double> length(eta_.size());
    packed_edge_lengths(geometry_, circles(), length);
    return length;
}

}  // namespace ricci
