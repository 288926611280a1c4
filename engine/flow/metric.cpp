#include "engine/flow/metric.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <type_traits>

#include "kernels/extended.h"

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
    } else if constexpr (std::is_same_v<Real, long double>) {
        return surface.triangulation;
    } else {
        // Nobody can call it; clang 14 instantiates constrained constructors all the same.
        throw std::logic_error("a start in more digits is made from the mesh");
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
ScaledMetric<Real>::ScaledMetric(const FlowSurface& surface, Geometry geometry,
                                 bool parallel) requires(std::is_floating_point_v<Real>)
    : ScaledMetric(surface, start_of<Real>(surface), geometry, parallel) {}

template <class Real>
ScaledMetric<Real>::ScaledMetric(const FlowSurface& surface, IntrinsicTriangulation<Real> start,
                                 Geometry geometry, bool parallel)
    : Metric(surface, geometry, parallel),
      triangulation_(std::move(start)),
      angle_(triangulation_.log_chord.size()),
      total_(surface.orbit.size()),
      face_area_(angle_.size() / 3) {}

template <class Real>
bool ScaledMetric<Real>::move_to(ConformalFactor u) {
    for (std::size_t s = 0; s < u_.size(); ++s) u_[s] = u.high[at(surface_->orbit[s])];
    if constexpr (!std::is_same_v<Real, double>) {
        low_.resize(u.low.empty() ? 0 : u_.size());
        for (std::size_t s = 0; s < low_.size(); ++s) low_[s] = u.low[at(surface_->orbit[s])];
    }
    const FlipCount count = make_delaunay<Real>(triangulation_, factor(), FlipRule::ptolemy, workspace_);
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
    const ScaledChords<Real> chords{triangulation_.connectivity.tail, triangulation_.log_chord, factor()};
    FaceFields<TriangleReal<Real>> fields{angle_, {}, {}, face_area_};
    if (derivatives) {
        fields.off = off_;
        fields.diagonal = diagonal_;
    }
    const std::int64_t broken = evaluate_faces<Real>(geometry_, chords, fields, parallel_);
    sum_corners<TriangleReal<Real>>(triangulation_.connectivity.tail, angle_, total_);
    area_ = surface_->side * sum_of<TriangleReal<Real>>(face_area_);
    return fold_curvature<TriangleReal<Real>>(total_) && broken == 0;
}

template <class Real>
int ScaledMetric<Real>::digits() const {
    return std::is_same_v<Real, double> ? 16 : (std::is_same_v<Real, long double> ? 19 : 50);
}

template <class Real>
double ScaledMetric<Real>::rounding_floor() const {
    // A chord's logarithm has gone through the flips of its neighbourhood: some ten roundings.
    constexpr double kRoundings = 16.0;
    double largest = 0.0;
    for (std::size_t h = 0; h < off_.size(); ++h) {
        const auto i = at(triangulation_.connectivity.tail[h]);
        const double size =
            std::abs(static_cast<double>(triangulation_.log_chord[h])) + std::abs(u_[i]) + 1.0;
        largest = std::max(largest, std::abs(off_[h]) * size);
    }
    // Wider numbers: u is the sum of two doubles.
    const double epsilon = std::max(static_cast<double>(std::numeric_limits<Real>::epsilon()), 0x1p-106);
    return kRoundings * epsilon * largest;
}

template <class Real>
std::vector<double> ScaledMetric<Real>::edge_lengths() const {
    using Length = TriangleReal<Real>;
    const Connectivity& c = triangulation_.connectivity;
    std::vector<double> length(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Real sum = factor().template at<Real>(c.tail[at(h)]) + factor().template at<Real>(c.head(h));
        const Real log_chord = triangulation_.log_chord[at(h)] + Real(0.5) * sum;
        const Length chord = std::exp(static_cast<Length>(log_chord));
        const Length value =
            geometry_ == Geometry::euclidean
                ? chord
                : (geometry_ == Geometry::hyperbolic ? Length(2) * std::asinh(chord / Length(2))
                                                     : Length(2) * std::asin(chord / Length(2)));
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
template class ScaledMetric<WideReal>;

std::unique_ptr<Metric> make_scaled_metric(const SurfaceMesh& mesh, const FlowSurface& surface,
                                           Geometry geometry, bool parallel, int digits) {
    if (digits <= 16) return std::make_unique<ScaledMetric<double>>(surface, geometry, parallel);
    if (digits <= 19) return std::make_unique<ScaledMetric<long double>>(surface, geometry, parallel);
    return std::make_unique<ScaledMetric<WideReal>>(surface, start_triangulation<WideReal>(mesh, surface),
                                                    geometry, parallel);
}

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

bool PackedMetric::move_to(ConformalFactor u) {
    for (std::size_t s = 0; s < u_.size(); ++s) u_[s] = u.high[at(surface_->orbit[s])];
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
