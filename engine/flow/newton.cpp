#include "engine/flow/newton.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

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
double slope(std::span<const double> curvature, const CurvatureTarget& target,
             std::span<const double> direction) {
    double sum = 0.0;
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if (target.unknown[v] >= 0)
            sum += direction[at(target.unknown[v])] * (curvature[v] - target.curvature[v]);
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

void step_along(const std::vector<double>& u, const CurvatureTarget& target,
                std::span<const double> direction, double step, std::vector<double>& result) {
    result = u;
    for (std::size_t v = 0; v < u.size(); ++v)
        if (target.unknown[v] >= 0) result[v] += step * direction[at(target.unknown[v])];
}

/// The same where u has a low part; `result` and `result_low` hold u.
void step_along_split(const CurvatureTarget& target, std::span<const double> direction, double step,
                      std::vector<double>& result, std::vector<double>& result_low) {
    for (std::size_t v = 0; v < result.size(); ++v)
        if (target.unknown[v] >= 0) add_to(step * direction[at(target.unknown[v])], result[v], result_low[v]);
}

/// Where a step is compared with: the state it starts from.
struct Standing {
    double slope, residual, square;
};

/// Whether a trial point is good enough. Convex energy: its derivative along the step has not turned
/// positive, or the residual halved (near the rounding floor the sign of the derivative is noise).
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

void add_to(double value, double& high, double& low) {
    const double sum = high + value, back = sum - high;
    const double error = (high - (sum - back)) + (value - back);
    const double rest = low + error;
    high = sum + rest;
    low = rest - (high - sum);
}

double residual_max(std::span<const double> curvature, const CurvatureTarget& target) {
    double largest = 0.0;
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if (target.unknown[v] >= 0) largest = std::max(largest, std::abs(curvature[v] - target.curvature[v]));
    return largest;
}

NewtonSolver::NewtonSolver(const FlowSurface& surface, const CurvatureTarget& target,
                           Definiteness definiteness, bool many, std::span<const Index> ordering)
    : definiteness_(definiteness), solver_(make_symmetric_solver(definiteness)) {
    base_.build(surface.triangulation.connectivity, unknowns_of_surface(surface, target),
                target.unknown_count);
    if (many) {
        if (ordering.empty()) {
            solver_->choose_ordering(base_.pattern(), Ordering::nested_dissection);
        } else {
            solver_->use_ordering(ordering);
        }
        solver_->analyze(base_.pattern());
        ordered_ = at_base_ = true;
    }
    if (target.scale_free) pinned_ = 0;
    rhs_.resize(at(target.unknown_count));
    direction_.resize(at(target.unknown_count));
}

void NewtonSolver::start_from_base(const Metric& metric, const CurvatureTarget& target) {
    assembler_ = base_;
    analysed_ = at_base_;
    factor_is_near_ = false;
    // Edges will flip where the curvature is to change most: around the cones.
    constexpr double kCone = 1.0;       // radians
    constexpr int kNear = 3, kFar = 6;  // rings; measured: fewer re-analyses against more fill
    std::vector<Index> cones;
    const auto curvature = metric.curvature();
    for (std::size_t v = 0; v < curvature.size(); ++v)
        if (target.unknown[v] >= 0 && std::abs(target.curvature[v] - curvature[v]) > kCone)
            cones.push_back(static_cast<Index>(v));  // an orbit's first vertex has its number
    if (cones.empty() || cones.size() > 64) return;
    if (assembler_.reserve(likely_flips(metric.surface().triangulation.connectivity, cones, kNear, kFar)))
        analysed_ = false;
}

bool NewtonSolver::factorize(SolveOutcome& outcome) {
    if (!analysed_) {
        if (ordered_) {
            solver_->analyze(assembler_.pattern());
        } else {
            solver_->choose_ordering(assembler_.pattern(), Ordering::minimum_degree);
            ordered_ = true;
        }
        analysed_ = true;
        at_base_ = assembler_.pattern() == base_.pattern();
        ++outcome.symbolic_analyses;
    }
    ++outcome.factorizations;
    factor_is_near_ = solver_->factorize(values_);
    if (factor_is_near_) return true;
    // Not numerically definite: shift the diagonal, ever more, up to a gradient-like step.
    double scale = 0.0;
    for (const Index p : assembler_.diagonal_positions()) scale = std::max(scale, std::abs(values_[at(p)]));
    const std::vector<double> unshifted = values_;
    double shift = 1e-14;
    for (int attempt = 0; attempt < 8; ++attempt, shift *= 100.0) {
        values_ = unshifted;
        for (const Index p : assembler_.diagonal_positions()) values_[at(p)] += shift * scale;
        if (!solver_->factorize(values_)) continue;
        ++outcome.shifted_factorizations;
        return true;
    }
    return false;
}

bool NewtonSolver::iterate_with_last_factor(double residual, const SolveOptions& options,
                                            SolveOutcome& outcome) {
    // Far from the solution the Hessian near the cones changes too much from step to step for it to pay.
    constexpr double kClose = 0.5;  // radians
    constexpr int kBackSolves = 8;  // cost about half a factorisation
    if (options.factorize_always || !options.convex || !factor_is_near_ || residual > kClose) return false;
    // Newton squares the residual: a step solved to this accuracy keeps up with it, and the last one need not
    // go beyond the tolerance.
    const double accuracy =
        std::max(std::clamp(0.1 * residual, 1e-7, 1e-2), 0.1 * options.tolerance / residual);
    const bool solved = conjugate_gradient_.solve(assembler_.pattern(), values_, *solver_, rhs_, accuracy,
                                                  kBackSolves, direction_);
    outcome.conjugate_gradient_iterations += conjugate_gradient_.iterations();
    return solved;
}

bool NewtonSolver::find_direction(Metric& metric, const CurvatureTarget& target, bool first, double residual,
                                  const SolveOptions& options, SolveOutcome& outcome) {
    const std::vector<Index> touched = metric.take_touched_faces();
    if (assembler_.follow_flips(metric.connectivity(), touched)) analysed_ = false;
    // side * H_folded d = target - K
    const double scale = 1.0 / metric.surface().side;
    for (std::size_t v = 0; v < target.unknown.size(); ++v) {
        if (target.unknown[v] < 0) continue;
        rhs_[at(target.unknown[v])] = scale * (target.curvature[v] - metric.curvature()[v]);
    }
    if (pinned_ >= 0) rhs_[at(pinned_)] = 0.0;
    if (first) {
        first_->solve(rhs_, direction_);
    } else {
        assembler_.assemble(metric.connectivity(), metric.off(), metric.diagonal(), pinned_, values_);
        if (!iterate_with_last_factor(residual, options, outcome)) {
            if (!factorize(outcome)) return false;
            solver_->solve(rhs_, direction_);
        }
    }
    if (target.scale_free) {
        const double mean = std::accumulate(direction_.begin(), direction_.end(), 0.0) /
                            static_cast<double>(direction_.size());
        for (double& d : direction_) d -= mean;
    }
    return std::all_of(direction_.begin(), direction_.end(), [](double d) { return std::isfinite(d); });
}

void NewtonSolver::prepare_first_factor(Metric& metric, const std::vector<double>& u) {
    first_.reset();
    if (!metric.move_to(u) || metric.flips() > 0 || !metric.evaluate(true)) return;
    assembler_ = base_;
    analysed_ = true;
    SolveOutcome ignored;
    auto own = std::move(solver_);
    solver_ = make_symmetric_solver(definiteness_);
    if (own->ordering().empty()) {
        solver_->choose_ordering(base_.pattern(), Ordering::nested_dissection);
    } else {
        solver_->use_ordering(own->ordering());
    }
    solver_->analyze(base_.pattern());
    assembler_.assemble(metric.connectivity(), metric.off(), metric.diagonal(), pinned_, values_);
    if (factorize(ignored) && ignored.shifted_factorizations == 0) {
        first_ = std::move(solver_);
        first_start_ = u;
    }
    solver_ = std::move(own);
}

SolveOutcome NewtonSolver::solve(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                                 std::vector<double>& u, std::vector<double>* low) {
    SolveOutcome outcome;
    const auto here = [&] { return low ? ConformalFactor(u, *low) : ConformalFactor(u); };
    Recorder recorder(outcome, options);
    const auto finish = [&](Status status) {
        outcome.status = status;
        outcome.flips = metric.flips();
        return outcome;
    };
    if (!metric.move_to(here())) return finish(Status::internal_error);
    if (!metric.evaluate(true)) {
        outcome.residual_max = residual_max(metric.curvature(), target);
        return finish(std::isfinite(outcome.residual_max) ? Status::inadmissible_metric : Status::not_finite);
    }
    start_from_base(metric, target);
    double residual = residual_max(metric.curvature(), target);
    recorder.record(0, residual, 0.0, metric.flips());
    double best = residual;
    int no_progress = 0;
    for (std::int32_t iteration = 1;; ++iteration) {
        if (residual <= options.tolerance) return finish(Status::converged);
        if (iteration > options.max_iterations) return finish(Status::max_iterations);
        if (no_progress >= options.patience) return finish(Status::stalled);
        if (options.interrupted) {
            if (const auto status = options.interrupted()) return finish(*status);
        }
        const bool first = iteration == 1 && first_ && u == first_start_;
        if (!find_direction(metric, target, first, residual, options, outcome))
            return finish(Status::factorization_failed);
        const Standing before{slope(metric.curvature(), target, direction_), residual,
                              residual_square(metric.curvature(), target)};
        double step = 1.0;
        bool accepted = false;
        metric.save();
        for (int attempt = 0; attempt < 50; ++attempt) {
            if (attempt > 0 && options.interrupted) {
                if (const auto status = options.interrupted()) {
                    if (!metric.move_to(here()) || !metric.evaluate(true))
                        return finish(Status::internal_error);
                    return finish(*status);
                }
            }
            ConformalFactor trial;
            if (low) {
                trial_ = u;
                trial_low_ = *low;
                step_along_split(target, direction_, step, trial_, trial_low_);
                trial = {trial_, trial_low_};
            } else {
                step_along(u, target, direction_, step, trial_);
                trial = trial_;
            }
            // A step so long that the flips do not end is too long.
            accepted = metric.move_to(trial) && metric.evaluate(true) &&
                       acceptable(metric, target, direction_, before, step, options.convex);
            if (accepted) break;
            metric.restore();
            step *= 0.5;
        }
        if (!accepted) {
            // Leave the metric where u is, so that callers see the last accepted state.
            if (!metric.move_to(here()) || !metric.evaluate(true)) return finish(Status::internal_error);
            return finish(Status::stalled);
        }
        std::swap(u, trial_);
        if (low) std::swap(*low, trial_low_);
        const double reached = residual_max(metric.curvature(), target);
        // Against the best so far: at the rounding floor the residual itself goes up and down for ever.
        const bool halved = reached <= 0.5 * best;
        no_progress = !halved && best < std::max(1e-6, metric.rounding_floor()) ? no_progress + 1 : 0;
        best = std::min(best, reached);
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
            if (halving > 0 && options.interrupted) {
                if (const auto status = options.interrupted()) {
                    if (!metric.move_to(u) || !metric.evaluate(false)) return finish(Status::internal_error);
                    return finish(*status);
                }
            }
            step_along(u, target, direction, taken, trial);
            accepted = metric.move_to(trial) && metric.evaluate(false) &&
                       acceptable(metric, target, direction, before, taken, options.convex);
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
