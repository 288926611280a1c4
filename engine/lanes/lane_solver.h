// The sweep's solver: kLanes singularities at a time on one surface.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "engine/flow/status.h"
#include "engine/lanes/lane_surface.h"
#include "engine/lanes/owned_region.h"
#include "kernels/lane_vectors.h"

namespace ricci {

struct LaneOptions {
    double cone_curvature = 0.0;  // radians, added at the cone
    double tolerance = 1e-10;     // on max |K - target|
    int lanes = kLanes;           // lanes in use, 1 … kLanes; the bits do not depend on it
    int rings = 0;                // of the patch; 0: by the cone's curvature
    int history = 3;              // of the acceleration
    int max_steps = 60;           // global steps; then the lane gives up
};

/// What became of one singularity.
struct LaneSolve {
    Index vertex = 0;
    bool converged = false;  // else: `conformal_factor` is where it stood; somebody else must go on
    std::optional<Status> interrupted;
    double residual_max = 0.0;
    double gauss_bonnet_error = 0.0;  // |sum K - 2 pi chi|, K as measured
    int steps = 0;                    // back-solves
    int patch_steps = 0;              // Newton steps on the patch
    std::int64_t flips = 0;
    std::vector<double> conformal_factor;  // V; mean zero where the solution is scale-free
};

/// Where singularities come from and results go.
struct LaneStream {
    std::function<std::optional<Index>()> next;  // a vertex of the input with an unknown; nothing: no more
    std::function<void(LaneSolve)> finished;
    /// Asked once per global step and lane, with the seconds since the lane began; a status ends it.
    std::function<std::optional<Status>(double)> interrupted;
};

/// Solves K(u) = target + cone at one vertex for every vertex of a stream, several at a time; one per thread.
///
/// A global step of all lanes: u changes by the step found before; the passes give the curvature; each lane's
/// region flips, relaxes its patch and adds its part (OwnedRegion); one blocked back-solve with the shared
/// factor of the Hessian at u = 0 preconditions the residual; Anderson's acceleration in that factor's norm,
/// which for a linear problem is a Krylov method, combines it with the last steps. Everything global is
/// judged in double by the residual itself; directions are single precision.
///
/// A solve's bits depend on its vertex alone: lanes share no arithmetic.
class LaneSolver {
  public:
    LaneSolver(std::shared_ptr<const LaneSurface> surface, Index vertex_count, const LaneOptions& options);
    ~LaneSolver();

    void run(const LaneStream& stream);

    /// Bytes that one solver allocates at first, without what its regions grow by.
    static std::int64_t predicted_bytes(Index rows, Index faces, const LaneOptions& options);

  private:
    struct Lane;
    using Clock = std::chrono::steady_clock;

    void fill(Lane& lane, const LaneStream& stream);
    void finish(Lane& lane, const LaneStream& stream, bool converged, std::optional<Status> interrupted);
    /// Clears what a lane that did not converge leaves behind: the next one's weight for it is 0, but 0 times
    /// infinity is not.
    void forget(const Lane& lane);
    void follow_lanes();
    void shorten_step(const Lane& lane);
    void measure();
    void judge(const LaneStream& stream);
    void precondition();
    void step();
    [[nodiscard]] bool any_active() const;

    std::shared_ptr<const LaneSurface> surface_;
    LaneOptions options_;
    Index vertex_count_;
    std::vector<Index> row_of_vertex_;

    LaneArray<double> u_, shrink_, residual_;
    LaneArray<float> step_, right_, previous_right_, solution_, previous_solution_;
    LaneHistory history_;
    std::vector<LaneMask> owned_;
    std::vector<LaneFlip> flips_;
    std::vector<std::unique_ptr<Lane>> lanes_;
    LaneMask broken_ = 0;
};

}  // namespace ricci
