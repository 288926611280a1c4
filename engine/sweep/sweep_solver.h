// One surface, every vertex in turn as the only cone.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/flow/newton.h"

namespace ricci {

struct SweepOptions {
    Scheme scheme = Scheme::vertex_scaling;
    Boundary boundary = Boundary::geodesic;  // free: u = 0 there, the boundary takes what the cone leaves
    std::optional<double> cone_curvature;    // radians; unset: 2 pi chi
    bool delaunay = true;
    bool densify = false;  // circle packings: refine around the cone and raise its valence first
    double tolerance = 1e-10;
    std::int32_t max_iterations = 0;  // 0: 200
};

/// The outcome for one vertex.
struct SweepSolve {
    Index vertex = 0;
    Status status = Status::internal_error;
    double area_distortion = 0.0;  // NaN unless converged
    double residual_max = 0.0;
    std::int32_t newton_iterations = 0;
    std::int64_t flips = 0;
    double seconds = 0.0;
    bool extended_precision = false;
    std::string message;
    std::vector<double> conformal_factor;  // V
};

/// What all solves on one surface share; read-only once made.
class SweepSurface {
  public:
    SweepSurface(SurfaceMesh mesh, const SweepOptions& options);

    /// Why no vertex of this surface can be the only cone, with what to do instead; empty when it can.
    [[nodiscard]] const std::string& inadmissible() const { return inadmissible_; }
    /// Interior vertices, ascending.
    [[nodiscard]] const std::vector<Index>& candidates() const { return candidates_; }
    [[nodiscard]] const SurfaceMesh& mesh() const { return mesh_; }
    [[nodiscard]] const Topology& topology() const { return topology_; }
    [[nodiscard]] const SweepOptions& options() const { return options_; }
    /// Predicted bytes of one worker, and of the shared part.
    [[nodiscard]] std::int64_t worker_bytes() const;
    [[nodiscard]] std::int64_t shared_bytes() const;

  private:
    friend class SweepWorker;

    SurfaceMesh mesh_;
    SweepOptions options_;
    Topology topology_;
    double cone_curvature_ = 0.0;
    std::string inadmissible_;
    std::vector<Index> candidates_;
    std::vector<double> area_;              // F, of the input
    FlowSurface surface_;                   // vertex scaling
    IntrinsicTriangulation<double> start_;  // rounded once for all
    CurvatureTarget target_;                // no cone yet
    std::vector<Index> ordering_;           // fill-reducing, of the unknowns
    std::optional<CirclePacking> packing_;  // circle packings
};

/// Solves on one surface, one vertex after the other; one per thread. A solve's bits depend on its vertex
/// alone.
class SweepWorker {
  public:
    explicit SweepWorker(std::shared_ptr<const SweepSurface> surface);
    ~SweepWorker();

    /// `vertex`: one of the surface's candidates (std::invalid_argument otherwise).
    SweepSolve solve(Index vertex, const std::function<std::optional<Status>()>& interrupted);

  private:
    void solve_scaling(SweepSolve& result, const SolveOptions& options);
    void solve_packing(SweepSolve& result, const SolveOptions& options);
    void solve_densified(SweepSolve& result, const SolveOptions& options);

    std::shared_ptr<const SweepSurface> shared_;
    CurvatureTarget target_;
    std::unique_ptr<NewtonSolver> newton_;
    std::unique_ptr<ScaledMetric<double>> metric_;
    std::unique_ptr<ScaledMetric<long double>> extended_;
    std::unique_ptr<PackedMetric> packed_;
};

}  // namespace ricci
