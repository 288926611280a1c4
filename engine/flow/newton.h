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
    double tolerance = 1e-10;  // on max |K - target|, radians
    std::int32_t max_iterations = 200;
    bool convex = true;  // the energy is convex: step control by its directional derivative; else by the residual
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
    std::int32_t symbolic_analyses = 0;       // those made inside the loop, because flips changed the pattern
    std::vector<IterationLog> log;
};

/// Newton for many solves on one surface: the fill-reducing ordering is chosen once, a symbolic analysis is repeated
/// (under that ordering) only when flips put an entry outside the pattern. One per thread.
class NewtonSolver {
  public:
    /// `target` decides the unknowns; its curvature may differ from solve to solve.
    NewtonSolver(const FlowSurface& surface, const CurvatureTarget& target, Definiteness definiteness,
                 Ordering ordering);

    /// Solves K(u) = target from `u` (V), which becomes the solution. `metric` must stand at the start triangulation.
    /// At an unsuccessful end `u` is the last accepted iterate.
    SolveOutcome solve(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                       std::vector<double>& u);

    /// Factorises the Hessian at `u` once; later solves that start at the same `u` use it for their first step.
    void prepare_first_factor(Metric& metric, const std::vector<double>& u);

    /// Bytes of one factor.
    [[nodiscard]] std::int64_t factor_bytes() const { return solver_->factor_bytes(); }
    [[nodiscard]] Index pinned() const { return pinned_; }

  private:
    bool factorize(Metric& metric, SolveOutcome& outcome);
    bool find_direction(Metric& metric, const CurvatureTarget& target, bool first, SolveOutcome& outcome);
    void return_to_base();

    Definiteness definiteness_;
    std::unique_ptr<SymmetricSolver> solver_, first_;
    std::vector<double> first_start_;  // u of the prepared factor
    HessianAssembler base_, assembler_;
    bool at_base_ = true;     // solver_ is analysed for base_'s pattern
    bool analysed_ = true;    // solver_ is analysed for assembler_'s pattern
    Index pinned_ = -1;       // unknown held during a scale-free solve
    std::vector<double> values_, rhs_, direction_, trial_;
};

/// Gradient descent du/dt = target - K (thesis section 4.3.1, equation 30, with u = log gamma) by explicit Euler steps.
/// The time step grows while the energy's directional derivative stays negative and halves where it turns.
SolveOutcome gradient_descent(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                              std::vector<double>& u);

/// max |K - target| over the vertices with an unknown.
double residual_max(std::span<const double> curvature, const CurvatureTarget& target);

}  // namespace ricci
