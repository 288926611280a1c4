// One surface, every vertex in turn as the only cone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/flow/newton.h"
#include "engine/lanes/lane_solver.h"

namespace ricci {

/// lanes: several vertices at a time share one factor, and Newton's method takes over where that fails or
/// does not apply (circle packings, surfaces that make_lane_surface() refuses). newton: one vertex at a time.
/// Both converge to the same metric, to the tolerance.
enum class SweepSolverKind : std::uint8_t { lanes, newton };
std::string_view name_of(SweepSolverKind solver);

struct SweepOptions {
    Scheme scheme = Scheme::vertex_scaling;
    Boundary boundary = Boundary::geodesic;  // free: u = 0 there, the boundary takes what the cone leaves
    std::optional<double> cone_curvature;    // radians; unset: 2 pi chi
    bool delaunay = true;
    bool densify = false;  // circle packings: refine around the cone and raise its valence first
    double tolerance = 1e-10;
    std::int32_t max_iterations = 0;             // 0: 500
    Precision precision = Precision::automatic;  // of Newton's method, by vertex scaling; extended: no lanes
    SweepSolverKind solver = SweepSolverKind::lanes;
    int lanes = kLanes;  // vertices at a time, 1 … kLanes; the bits do not depend on it
};

/// Why no vertex of such a surface can be the only cone, with what to do instead; empty when it can.
std::string explain_inadmissible(const Topology& topology, const SweepOptions& options);

/// The outcome for one vertex.
struct SweepSolve {
    Index vertex = 0;
    Status status = Status::internal_error;
    double area_distortion = 0.0;  // NaN unless converged
    double residual_max = 0.0;
    std::int32_t newton_iterations = 0;  // of a solve in lanes: its global steps, a back-solve each
    std::int64_t flips = 0;
    /// The worker's time that went into it: where n solves run in lanes, a second counts 1/n for each.
    double seconds = 0.0;
    int precision_digits = 16;        // of the lengths in which the residual was measured: 16, 19 or 50
    double gauss_bonnet_error = 0.0;  // |sum K - 2 pi chi|
    std::string message;
    std::vector<double> conformal_factor;  // V
};

/// Where a worker's vertices come from and their solves go.
struct SweepStream {
    std::function<std::optional<Index>()> next;  // one of the surface's candidates; nothing: no more for now
    std::function<void(SweepSolve)> finished;    // in any order
    /// Asked between the steps of a solve, with the seconds since it began; a status (timeout, cancelled)
    /// ends it. May be empty.
    std::function<std::optional<Status>(double)> interrupted;
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
    /// Vertices that a worker solves at a time; 0: no lanes, one by Newton's method.
    [[nodiscard]] int lanes() const { return lane_surface_ ? options_.lanes : 0; }
    /// Predicted bytes of one worker with so many lanes, and of the shared part.
    [[nodiscard]] std::int64_t worker_bytes(int lanes) const;
    [[nodiscard]] std::int64_t worker_bytes() const { return worker_bytes(lanes()); }
    [[nodiscard]] std::int64_t shared_bytes() const;

  private:
    friend class SweepWorker;

    [[nodiscard]] LaneOptions lane_options(int lanes) const;

    SurfaceMesh mesh_;
    SweepOptions options_;
    Topology topology_;
    double cone_curvature_ = 0.0;
    std::string inadmissible_;
    std::vector<Index> candidates_;
    std::vector<double> area_;                         // F, of the input
    FlowSurface surface_;                              // vertex scaling
    IntrinsicTriangulation<double> start_;             // rounded once for all
    CurvatureTarget target_;                           // no cone yet
    std::vector<Index> ordering_;                      // fill-reducing, of the unknowns
    std::shared_ptr<const LaneSurface> lane_surface_;  // where lanes apply
    std::optional<CirclePacking> packing_;             // circle packings
};

/// Solves on one surface; one per thread. A solve's bits depend on its vertex alone.
class SweepWorker {
  public:
    /// `lanes`: at most so many where the surface is solved in lanes; 0: as its options say.
    explicit SweepWorker(std::shared_ptr<const SweepSurface> surface, int lanes = 0);
    ~SweepWorker();

    /// Solves what `stream` gives until it gives no more. A vertex whose lane does not converge is solved
    /// again by solve(); where memory runs out, so are those under way, or they end as out_of_memory. Throws
    /// std::invalid_argument for a vertex that is no candidate; the stream's exceptions come through, and
    /// solves under way are lost then.
    void run(const SweepStream& stream);

    /// One vertex by Newton's method, whatever the options. `vertex`: one of the surface's candidates
    /// (std::invalid_argument otherwise).
    SweepSolve solve(Index vertex, const std::function<std::optional<Status>()>& interrupted);

  private:
    class LaneFeed;
    struct Start;

    void run_lanes(LaneFeed& feed);
    SweepSolve solve_alone(const Start& start, const SweepStream& stream);
    void make_newton();
    void drop_newton();
    void solve_scaling(SweepSolve& result, const SolveOptions& options);
    void solve_packing(SweepSolve& result, const SolveOptions& options);
    void solve_densified(SweepSolve& result, const SolveOptions& options);

    std::shared_ptr<const SweepSurface> shared_;
    int lanes_;
    std::unique_ptr<LaneSolver> lane_solver_;
    // Newton's method; made when it is needed first.
    CurvatureTarget target_;
    std::unique_ptr<NewtonSolver> newton_;
    std::unique_ptr<ScaledMetric<double>> metric_;
    std::unique_ptr<PackedMetric> packed_;
};

}  // namespace ricci
