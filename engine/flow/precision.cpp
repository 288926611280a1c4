#include "engine/flow/precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace ricci {
namespace {

/// Mean zero, so that a scale-free solution is one and not a family (thesis section 3.5: sum u_i = 0).
void centre(const CurvatureTarget& target, ScalingSolve& s) {
    double sum = 0.0, count = 0.0;
    for (std::size_t v = 0; v < s.u.size(); ++v) {
        if (target.unknown[v] < 0) continue;
        sum += s.u[v];
        count += 1.0;
    }
    const double mean = sum / count;
    for (std::size_t v = 0; v < s.u.size(); ++v) {
        if (target.unknown[v] < 0) continue;
        if (s.low.empty()) {
            s.u[v] -= mean;
        } else {
            add_to(-mean, s.u[v], s.low[v]);
        }
    }
}

/// The residual of u + low in the arithmetic of `metric`; with derivatives also what its rounding may be.
double measure(Metric& metric, const CurvatureTarget& target, const ScalingSolve& s,
               bool derivatives = false) {
    const bool sound = metric.move_to({s.u, s.low}) && metric.evaluate(derivatives);
    return sound ? residual_max(metric.curvature(), target) : std::numeric_limits<double>::infinity();
}

/// Appends what a level did to what the levels below did.
void append(SolveOutcome second, SolveOutcome& outcome) {
    const std::int32_t before = outcome.iterations;
    const double seconds = outcome.log.empty() ? 0.0 : outcome.log.back().seconds;
    for (IterationLog line : second.log) {
        if (line.iteration == 0 && before > 0) continue;
        line.iteration += before;
        line.seconds += seconds;
        line.flips += outcome.flips;
        outcome.log.push_back(line);
    }
    second.log = std::move(outcome.log);
    second.iterations += before;
    second.flips += outcome.flips;
    second.shifted_factorizations += outcome.shifted_factorizations;
    second.symbolic_analyses += outcome.symbolic_analyses;
    second.factorizations += outcome.factorizations;
    second.conjugate_gradient_iterations += outcome.conjugate_gradient_iterations;
    outcome = std::move(second);
}

bool stopped_by_caller(Status status) {
    return status == Status::cancelled || status == Status::timeout || status == Status::out_of_memory;
}

/// Whether more digits may help: the level below met its rounding, or what looks like it.
bool worth_more_digits(const ScalingProblem& p, const ScalingSolve& s) {
    if (stopped_by_caller(s.outcome.status)) return false;
    // Where a non-convex energy has no descent, digits do not help.
    if (p.geometry == Geometry::spherical && !(s.outcome.residual_max < 1e-6)) return false;
    const bool coarse = s.rounding_floor > p.tolerated_rounding;
    if (s.outcome.status == Status::converged) return coarse;
    return s.outcome.status != Status::max_iterations;
}

/// What a level that gained nothing has cost, and that the caller stopped it.
void account_for(SolveOutcome given_up, SolveOutcome& outcome) {
    given_up.residual_max = outcome.residual_max;
    given_up.flips = outcome.flips;
    if (!stopped_by_caller(given_up.status)) given_up.status = outcome.status;
    outcome = std::move(given_up);
}

void settle(const ScalingProblem& p, ScalingSolve& s) {
    s.digits = s.metric->digits();
    if (!(s.metric->rounding_floor() > 0.0)) measure(*s.metric, *p.target, s, true);  // gradient descent
    s.rounding_floor = s.metric->rounding_floor();
    if (!p.target->scale_free) return;
    centre(*p.target, s);
    s.outcome.residual_max = measure(*s.metric, *p.target, s);
    s.outcome.flips = std::max(s.outcome.flips, s.metric->flips());
    if (s.outcome.status == Status::converged && s.outcome.residual_max > p.options.tolerance)
        s.outcome.status = Status::stalled;
}

/// One level of more digits, from where `s` stands. Keeps what was there where nothing is gained.
void solve_level(const ScalingProblem& p, int digits, ScalingSolve& s) {
    if (p.options.interrupted)
        if (const auto status = p.options.interrupted()) {
            s.outcome.status = *status;
            return;
        }
    ScalingSolve next;
    next.u = s.u;
    next.low = s.low.empty() ? std::vector<double>(s.u.size(), 0.0) : s.low;
    next.finer = make_scaled_metric(*p.mesh, *p.surface, p.geometry, p.parallel, digits);
    next.metric = next.finer.get();
    const double here = measure(*next.metric, *p.target, next, true);
    if (here <= p.options.tolerance && s.outcome.status == Status::converged) {
        next.outcome = s.outcome;  // double was right: nothing to solve
        next.outcome.residual_max = here;
    } else {
        next.outcome = s.outcome;
        SolveOptions options = p.options;
        options.factorize_always = true;  // the double Hessian is all that holds the convergence up
        options.patience = 8;
        options.max_iterations = std::max(0, options.max_iterations - next.outcome.iterations);
        append(p.solve(*next.metric, *p.target, options, next.u, &next.low), next.outcome);
    }
    settle(p, next);
    // A residual below the level's own rounding says no more than that rounding.
    const bool better = next.outcome.status == Status::converged || s.outcome.status == Status::converged ||
                        std::max(next.outcome.residual_max, next.rounding_floor) <
                            std::max(s.outcome.residual_max, s.rounding_floor);
    if (better)
        s = std::move(next);
    else
        account_for(std::move(next.outcome), s.outcome);
}

/// Drops the low part where u alone is as good.
void round_where_possible(const ScalingProblem& p, ScalingSolve& s) {
    if (s.low.empty() || s.outcome.status != Status::converged) return;
    std::vector<double> low = std::exchange(s.low, {});
    const double rounded = measure(*s.metric, *p.target, s);
    if (rounded <= p.options.tolerance) {
        s.outcome.residual_max = rounded;
        return;
    }
    s.low = std::move(low);
    measure(*s.metric, *p.target, s);
}

}  // namespace

std::string_view name_of(Precision precision) {
    switch (precision) {
        case Precision::plain:
            return "double";
        case Precision::extended:
            return "extended";
        case Precision::automatic:
            break;
    }
    return "auto";
}

std::string rounding_note(int digits, double rounding_floor) {
    return fmt::format("the rounding of {} digits may hide a residual of {:.2g}", digits, rounding_floor);
}

void solve_by_scaling(const ScalingProblem& p, Metric& first, ScalingSolve& s) {
    constexpr int kDigits[] = {19, 50};
    s.low.clear();
    if (p.precision == Precision::extended) {
        s.finer = make_scaled_metric(*p.mesh, *p.surface, p.geometry, p.parallel, kDigits[0]);
        s.metric = s.finer.get();
        s.low.assign(s.u.size(), 0.0);
        s.outcome = p.solve(*s.metric, *p.target, p.options, s.u, &s.low);
    } else {
        s.metric = &first;
        s.outcome = p.solve(*s.metric, *p.target, p.options, s.u, nullptr);
    }
    settle(p, s);
    if (p.precision == Precision::plain) return;
    for (const int digits : kDigits) {
        if (digits <= s.digits || !worth_more_digits(p, s)) continue;
        // Straight to the level whose rounding is small enough.
        constexpr double kFiner = 0x1p-11;  // long double against double
        const bool enough = s.rounding_floor * kFiner <= p.tolerated_rounding;
        if (digits == 19 && !enough) continue;
        solve_level(p, digits, s);
    }
    round_where_possible(p, s);
}

}  // namespace ricci
