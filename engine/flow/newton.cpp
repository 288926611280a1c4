#include "engine/flow/newton.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

namespace ricci {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using Clock = std::chrono::steady_clock;

/// Writes the log and keeps the time.
class Recorder {
  public:
    Recorder(SolveOutcome& outcome, const SolveOptions& options) : outcome_(&outcome), options_(&options) {}

    void record(std::int32_t iteration, double residual, double step, std::int64_t flips) {
        outcome_->iterations = iteration;
        outcome_->residual_max = residual;
        outcome_->flips = flips;
        const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
        outcome_->log.push_back({iteration, residual, step, flips, seconds});
        if (options_->progress) options_->progress(outcome_->log.back());
    }

  private:
    SolveOutcome* outcome_;
    const SolveOptions* options_;
    Clock::time_point start_ = Clock::now();
};

/// Directional derivative of the energy along `direction` (per unknown) where the metric stands.
double slope(std::span<const double> curvature, const CurvatureTarget& target, std::span<const double> direction) {
    double sum = 0.0;
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if (target.unknown[v] >= 0) sum += direction[at(target.unknown[v])] * (curvature[v] - target.curvature[v]);
    return sum;
}

double residual_square(std::span<const double> curvature, const CurvatureTarget& target) {
    double sum = 0.0;
    for (std::size_t v = 0; v < curvature.size(); ++v) {
        if (target.unknown[v] < 0) continue;
        const double r = curvature[v] - target.curvature[v];
        sum += r * r;
    }
    return sum;
}

void step_along(const std::vector<double>& u, const CurvatureTarget& target, std::span<const double> direction,
                double step, std::vector<double>& result) {
    result = u;
    for (std::size_t v = 0; v < u.size(); ++v)
        if (target.unknown[v] >= 0) result[v] += step * direction[at(target.unknown[v])];
}

/// Where a step is compared with: the state it starts from.
struct Standing {
    double slope, residual, square;
};

/// Whether a trial point is good enough. Convex energy: its derivative along the step has not turned positive, or the
/// residual halved (near the rounding floor the sign of the derivative is noise).
bool acceptable(const Metric& metric, const CurvatureTarget& target, std::span<const double> direction,
                const Standing& before, double step, bool convex) {
    const double residual = residual_max(metric.curvature(), target);
    if (!convex) return residual_square(metric.curvature(), target) < (1.0 - 1e-4 * step) * before.square;
    return slope(metric.curvature(), target, direction) <= 0.0 || residual <= 0.5 * before.residual;
}

std::vector<Index> unknowns_of_surface(const FlowSurface& surface, const CurvatureTarget& target) {
    std::vector<Index> unknown(surface.orbit.size());
    for (std::size_t s = 0; s < unknown.size(); ++s) unknown[s] = target.unknown[at(surface.orbit[s])];
    return unknown;
}

}  // namespace

double residual_max(std::span<const double> curvature, const CurvatureTarget& target) {
    double largest = 0.0;
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if (target.unknown[v] >= 0) largest = std::max(largest, std::abs(curvature[v] - target.curvature[v]));
    return largest;
}

NewtonSolver::NewtonSolver(const FlowSurface& surface, const CurvatureTarget& target, Definiteness definiteness,
                           Ordering ordering)
    : definiteness_(definiteness), solver_(make_symmetric_solver(definiteness)) {
    base_.build(surface.triangulation.connectivity, unknowns_of_surface(surface, target), target.unknown_count);
    solver_->choose_ordering(base_.pattern(), ordering);
    if (target.scale_free) pinned_ = 0;
    rhs_.resize(at(target.unknown_count));
    direction_.resize(at(target.unknown_count));
}

void NewtonSolver::return_to_base() {
    assembler_ = base_;
    if (!at_base_) {
        solver_->analyze(base_.pattern());
        at_base_ = true;
    }
    analysed_ = true;
}

bool NewtonSolver::factorize(Metric& metric, SolveOutcome& outcome) {
    if (!analysed_) {
        solver_->analyze(assembler_.pattern());
        analysed_ = true;
        at_base_ = false;
        ++outcome.symbolic_analyses;
    }
    assembler_.assemble(metric.connectivity(), metric.off(), metric.diagonal(), pinned_, values_);
    if (solver_->factorize(values_)) return true;
    // Not numerically definite: shift the diagonal, ever more, up to a gradient-like step.
    double scale = 0.0;
    for (const Index p : assembler_.diagonal_positions()) scale = std::max(scale, std::abs(values_[at(p)]));
    const std::vector<double> unshifted = values_;
    for (double shift = 1e-14; shift <= 1.0; shift *= 100.0) {
        values_ = unshifted;
        for (const Index p : assembler_.diagonal_positions()) values_[at(p)] += shift * scale;
        if (!solver_->factorize(values_)) continue;
        ++outcome.shifted_factorizations;
        return true;
    }
    return false;
}

bool NewtonSolver::find_direction(Metric& metric, const CurvatureTarget& target, bool first, SolveOutcome& outcome) {
    const std::vector<Index> touched = metric.take_touched_faces();
    if (assembler_.follow_flips(metric.connectivity(), touched)) analysed_ = false;
    SymmetricSolver* solver = solver_.get();
    if (first) {
        solver = first_.get();
    } else if (!factorize(metric, outcome)) {
        return false;
    }
    // side * H_folded d = target - K
    const double scale = 1.0 / metric.surface().side;
    for (std::size_t v = 0; v < target.unknown.size(); ++v) {
        if (target.unknown[v] < 0) continue;
        rhs_[at(target.unknown[v])] = scale * (target.curvature[v] - metric.curvature()[v]);
    }
    if (pinned_ >= 0) rhs_[at(pinned_)] = 0.0;
    solver->solve(rhs_, direction_);
    if (target.scale_free) {
        const double mean = std::accumulate(direction_.begin(), direction_.end(), 0.0) /
                            static_cast<double>(direction_.size());
        for (double& d : direction_) d -= mean;
    }
    return std::all_of(direction_.begin(), direction_.end(), [](double d) { return std::isfinite(d); });
}

void NewtonSolver::prepare_first_factor(Metric& metric, const std::vector<double>& u) {
    return_to_base();
    first_.reset();
    if (!metric.move_to(u) || metric.flips() > 0 || !metric.evaluate(true)) return;
    SolveOutcome ignored;
    auto own = std::move(solver_);
    solver_ = make_symmetric_solver(definiteness_);
    solver_->choose_ordering(base_.pattern(), Ordering::nested_dissection);
    if (factorize(metric, ignored) && ignored.shifted_factorizations == 0) {
        first_ = std::move(solver_);
        first_start_ = u;
    }
    solver_ = std::move(own);
}

SolveOutcome NewtonSolver::solve(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                                 std::vector<double>& u) {
    SolveOutcome outcome;
    Recorder recorder(outcome, options);
    return_to_base();
    const auto finish = [&](Status status) {
        outcome.status = status;
        outcome.flips = metric.flips();
        return outcome;
    };
    if (!metric.move_to(u)) return finish(Status::internal_error);
    if (!metric.evaluate(true)) {
        outcome.residual_max = residual_max(metric.curvature(), target);
        return finish(std::isfinite(outcome.residual_max) ? Status::inadmissible_metric : Status::not_finite);
    }
    double residual = residual_max(metric.curvature(), target);
    recorder.record(0, residual, 0.0, metric.flips());
    int no_progress = 0;
    for (std::int32_t iteration = 1;; ++iteration) {
        if (residual <= options.tolerance) return finish(Status::converged);
        if (iteration > options.max_iterations) return finish(Status::max_iterations);
        if (no_progress >= 2) return finish(Status::stalled);
        if (options.interrupted) {
            if (const auto status = options.interrupted()) return finish(*status);
        }
        const bool first = iteration == 1 && first_ && u == first_start_;
        if (!find_direction(metric, target, first, outcome)) return finish(Status::factorization_failed);
        const Standing before{slope(metric.curvature(), target, direction_), residual,
                              residual_square(metric.curvature(), target)};
        double step = 1.0;
        bool accepted = false;
        metric.save();
        for (int halving = 0; halving < 50; ++halving, step *= 0.5) {
            step_along(u, target, direction_, step, trial_);
            if (!metric.move_to(trial_)) return finish(Status::internal_error);
            accepted = metric.evaluate(true) &&
                       acceptable(metric, target, direction_, before, step, options.convex);
            if (accepted) break;
            metric.restore();
        }
        if (!accepted) {
            // Leave the metric where u is, so that callers see the last accepted state.
            if (!metric.move_to(u) || !metric.evaluate(true)) return finish(Status::internal_error);
            return finish(Status::stalled);
        }
        std::swap(u, trial_);
        const double reached = residual_max(metric.curvature(), target);
        no_progress = step == 1.0 && reached > 0.5 * residual && residual < 1e-6 ? no_progress + 1 : 0;
        residual = reached;
        recorder.record(iteration, residual, step, metric.flips());
    }
}

SolveOutcome gradient_descent(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                              std::vector<double>& u) {
    SolveOutcome outcome;
    Recorder recorder(outcome, options);
    const auto finish = [&](Status status) {
        outcome.status = status;
        outcome.flips = metric.flips();
        return outcome;
    };
    if (!metric.move_to(u)) return finish(Status::internal_error);
    if (!metric.evaluate(false)) return finish(Status::inadmissible_metric);
    double residual = residual_max(metric.curvature(), target);
    recorder.record(0, residual, 0.0, metric.flips());
    std::vector<double> direction(at(target.unknown_count)), trial;
    double step = 0.1;
    for (std::int32_t iteration = 1;; ++iteration) {
        if (residual <= options.tolerance) return finish(Status::converged);
        if (iteration > options.max_iterations) return finish(Status::max_iterations);
        if (options.interrupted) {
            if (const auto status = options.interrupted()) return finish(*status);
        }
        for (std::size_t v = 0; v < u.size(); ++v)
            if (target.unknown[v] >= 0)
                direction[at(target.unknown[v])] = target.curvature[v] - metric.curvature()[v];
        const Standing before{slope(metric.curvature(), target, direction), residual,
                              residual_square(metric.curvature(), target)};
        bool accepted = false;
        double taken = step;
        metric.save();
        for (int halving = 0; halving < 60; ++halving, taken *= 0.5) {
            step_along(u, target, direction, taken, trial);
            if (!metric.move_to(trial)) return finish(Status::internal_error);
            accepted = metric.evaluate(false) && acceptable(metric, target, direction, before, taken, options.convex);
            if (accepted) break;
            metric.restore();
        }
        if (!accepted) {
            if (!metric.move_to(u) || !metric.evaluate(false)) return finish(Status::internal_error);
            return finish(Status::stalled);
        }
        step = 1.1 * taken;
        std::swap(u, trial);
        residual = residual_max(metric.curvature(), target);
        recorder.record(iteration, residual, taken, metric.flips());
    }
}

}  // namespace ricci
