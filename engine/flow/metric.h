// A metric that a flow moves: conformal factor in, curvature and its derivatives out.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/flow/flow_surface.h"
#include "engine/flow/scheme.h"
#include "kernels/face_kernels.h"

namespace ricci {

/// One surface under one scheme. The V conformal factors are those of the input's vertices.
class Metric {
  public:
    virtual ~Metric() = default;

    /// Moves to conformal factor `u` (V), restoring Delaunay by flips where the scheme flips. Returns false
    /// if the flips did not end. The low part is read where the metric has more digits than a double.
    virtual bool move_to(ConformalFactor u) = 0;
    /// Remembers the triangulation, so that a rejected step can be taken back.
    virtual void save() {}
    virtual void restore() {}
    /// Evaluates curvature and area where it stands, and the derivatives where asked. False: some face is no
    /// triangle, or a number is not finite (curvature() is then the continuous extension or NaN).
    virtual bool evaluate(bool derivatives) = 0;

    /// Adds the curvature of orbit v. // V, radians, of the half for a doubled surface; 0 for unused vertices
    [[nodiscard]] std::span<const double> curvature() const { return curvature_; }
    [[nodiscard]] double area() const { return area_; }  // of the half for a doubled surface
    [[nodiscard]] std::span<const double> off() const { return off_; }
    [[nodiscard]] std::span<const double> diagonal() const { return diagonal_; }
    [[nodiscard]] virtual const Connectivity& connectivity() const = 0;
    [[nodiscard]] const FlowSurface& surface() const { return *surface_; }
    [[nodiscard]] std::int64_t flips() const { return flips_; }  // since construction or reset
    /// Length of every halfedge of the current triangulation in the background geometry. // 3F
    [[nodiscard]] virtual std::vector<double> edge_lengths() const = 0;
    /// Decimal digits of the arithmetic of lengths: 16, 19 or 50.
    [[nodiscard]] virtual int digits() const { return 16; }
    /// About how much the curvature may be off by the rounding of lengths, from the derivatives last
    /// evaluated: the largest cotangent times the rounding of the logarithms. 0: not known.
    [[nodiscard]] virtual double rounding_floor() const { return 0.0; }

    /// Faces touched by flips since the last call.
    std::vector<Index> take_touched_faces() { return std::exchange(touched_faces_, {}); }

  protected:
    Metric(const FlowSurface& surface, Geometry geometry, bool parallel);

    /// Folds angle sums into curvature_. Returns whether all are finite.
    template <class Real>
    bool fold_curvature(std::span<const Real> total);

    const FlowSurface* surface_;
    Geometry geometry_;
    bool parallel_;
    std::int64_t flips_ = 0;
    double area_ = 0.0;
    std::vector<double> u_;  // per vertex of the triangulation
    std::vector<double> curvature_, off_, diagonal_;
    std::vector<Index> touched_faces_;
};

/// Vertex scaling with Ptolemy flips; `Real` is the type of lengths, of u + its low part, and, as far as
/// TriangleReal goes, of angles. double, long double or WideReal.
template <class Real>
class ScaledMetric final : public Metric {
  public:
    /// `surface` must outlive the metric.
    ScaledMetric(const FlowSurface& surface, Geometry geometry,
                 bool parallel) requires(std::is_floating_point_v<Real>);
    /// From `start`, the surface's triangulation in Real.
    ScaledMetric(const FlowSurface& surface, IntrinsicTriangulation<Real> start, Geometry geometry,
                 bool parallel);

    bool move_to(ConformalFactor u) override;
    void save() override;
    void restore() override;
    bool evaluate(bool derivatives) override;
    [[nodiscard]] const Connectivity& connectivity() const override { return triangulation_.connectivity; }
    [[nodiscard]] std::vector<double> edge_lengths() const override;
    [[nodiscard]] int digits() const override;
    [[nodiscard]] double rounding_floor() const override;

    /// Back to the start triangulation (which `start` must be a copy of), for the next solve on the same
    /// surface.
    void reset(const IntrinsicTriangulation<Real>& start);

  private:
    [[nodiscard]] ConformalFactor factor() const { return {u_, low_}; }

    IntrinsicTriangulation<Real> triangulation_, saved_;
    std::vector<double> low_;  // as u_; empty: 0
    std::int64_t saved_flips_ = 0;
    std::size_t saved_touched_ = 0;
    DelaunayWorkspace workspace_;
    std::vector<TriangleReal<Real>> angle_, total_, face_area_;
};

/// Vertex scaling in at least so many decimal digits: 16, 19, 50. `mesh`: what the surface was made of.
std::unique_ptr<Metric> make_scaled_metric(const SurfaceMesh& mesh, const FlowSurface& surface,
                                           Geometry geometry, bool parallel, int digits);

/// Circle packing on the fixed triangulation of the surface.
class PackedMetric final : public Metric {
  public:
    PackedMetric(const FlowSurface& surface, const CirclePacking& packing, Geometry geometry, bool parallel);

    bool move_to(ConformalFactor u) override;
    bool evaluate(bool derivatives) override;
    [[nodiscard]] const Connectivity& connectivity() const override {
        return surface_->triangulation.connectivity;
    }
    [[nodiscard]] std::vector<double> edge_lengths() const override;
    [[nodiscard]] std::span<const double> face_areas() const { return face_area_; }

  private:
    [[nodiscard]] PackedCircles circles() const;

    std::vector<double> eps_, eta_, angle_, total_, face_area_;
};

}  // namespace ricci
