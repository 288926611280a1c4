// Newton's method and gradient descent for prescribed curvature.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/flow/hessian.h"
#include "engine/flow/metric.h"
#include "engine/flow/status.h"
#include "engine/linear/conjugate_gradient.h"

namespace ricci {

/// What is prescribed. Vertices with unknown -1 (fixed u, or unused) have no prescribed curvature.
struct CurvatureTarget {
    std::vector<double> curvature;  // V, radians
    std::vector<Index> unknown;     // V -> unknown or -1
    Index unknown_count = 0;
    bool scale_free = false;  // u and u + const are the same solution (Euclidean, nothing fixed)
};

/// One line of the convergence log.
struct IterationLog {
    std::int32_t iteration = 0;
    double residual_max = 0.0;  // after the iteration
    double step = 0.0;          // length of the step taken along the direction (gradient: the time step)
    std::int64_t flips = 0;     // so far
    double seconds = 0.0;       // since the start of the solve
};

struct SolveOptions {
    double tolerance = 1e-10;           // on max |K - target|, radians
    std::int32_t max_iterations = 200;  // 0: measure only
    bool convex =
        true;  // the energy is convex: step control by its directional derivative; else by the residual
    /// Factorise at every step. Otherwise, once the residual is small, a step is solved by conjugate
    /// gradients with the last factor as preconditioner where a few back-solves suffice, which is cheaper
    /// than a factorisation.
    bool factorize_always = false;
    /// Steps at the rounding floor (or below 1e-6) that do not halve the residual, until the solve has
    /// stalled.
    std::int32_t patience = 3;
    /// Asked between steps; a status (timeout, cancelled) ends the solve.
    std::function<std::optional<Status>()> interrupted;
    std::function<void(const IterationLog&)> progress;
};

struct SolveOutcome {
    Status status = Status::internal_error;
    std::int32_t iterations = 0;
    double residual_max = 0.0;
    std::int64_t flips = 0;
    std::int32_t shifted_factorizations = 0;  // matrices that needed a diagonal shift to be positive definite
    std::int32_t symbolic_analyses = 0;       // the first, and those made because flips left the pattern
    std::int32_t factorizations = 0, conjugate_gradient_iterations = 0;
    std::vector<IterationLog> log;
};

/// Newton for many solves on one surface: the fill-reducing ordering is chosen once; under that ordering, a
/// solve is analysed once with room for the flips expected near its cones, and again only where a flip leaves
/// that room. One per thread.
class NewtonSolver {
  public:
    /// `target` decides the unknowns; its curvature may differ from solve to solve.
    /// One solve: minimum degree, analysed once. `many`: nested dissection, and every solve starts from an
    /// analysis of the base pattern by the same call, so that its bits do not depend on what was solved
    /// before. `ordering`: one chosen by another solver for the same surface and unknowns, to save choosing
    /// it again.
    NewtonSolver(const FlowSurface& surface, const CurvatureTarget& target, Definiteness definiteness,
                 bool many, std::span<const Index> ordering = {});

    [[nodiscard]] std::span<const Index> ordering() const { return solver_->ordering(); }

    /// Solves K(u) = target from `u` (V), which becomes the solution. `metric` must stand at the start
    /// triangulation. At an unsuccessful end `u` is the last accepted iterate. `low` (V, or null): u is the
    /// unevaluated sum u + low, for metrics of more digits; a step is then still a double, and the steps add
    /// up.
    SolveOutcome solve(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                       std::vector<double>& u, std::vector<double>* low = nullptr);

    /// Factorises the Hessian at `u` once; later solves that start at the same `u` use it for their first
    /// step.
    void prepare_first_factor(Metric& metric, const std::vector<double>& u);

    /// Bytes of one factor.
    [[nodiscard]] std::int64_t factor_bytes() const { return solver_->factor_bytes(); }
    [[nodiscard]] Index pinned() const { return pinned_; }

  private:
    bool factorize(SolveOutcome& outcome);
    bool iterate_with_last_factor(double residual, const SolveOptions& options, SolveOutcome& outcome);
    bool find_direction(Metric& metric, const CurvatureTarget& target, bool first, double residual,
                        const SolveOptions& options, SolveOutcome& outcome);
    void start_from_base(const Metric& metric, const CurvatureTarget& target);

    Definiteness definiteness_;
    std::unique_ptr<SymmetricSolver> solver_, first_;
    std::vector<double> first_start_;  // u of the prepared factor
    HessianAssembler base_, assembler_;
    bool ordered_ = false;         // solver_ has a fill-reducing ordering
    bool at_base_ = false;         // solver_ is analysed for base_'s pattern
    bool analysed_ = false;        // solver_ is analysed for assembler_'s pattern
    bool factor_is_near_ = false;  // solver_ holds an unshifted factor of this solve
    ConjugateGradient conjugate_gradient_;
    Index pinned_ = -1;  // unknown held during a scale-free solve
    std::vector<double> values_, rhs_, direction_, trial_, trial_low_;
};

/// Gradient descent du/dt = target - K (thesis section 4.3.1, equation 30, with u = log gamma) by explicit
/// Euler steps. The time step grows while the energy's directional derivative stays negative and halves where
/// it turns.
SolveOutcome gradient_descent(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                              std::vector<double>& u);

/// Adds `value` to the unevaluated sum high + low (Knuth's two-sum): exact but for the rounding of low.
void add_to(double value, double& high, double& low);

/// max |K - target| over the vertices with an unknown.
double residual_max(std::span<const double> curvature, const CurvatureTarget& target);

}  // namespace ricci
