// The scales of a hyperbolic metric as far as they have been solved, handed from one level of precision to
// the next.
#pragma once

#include <vector>

#include "engine/flow/cancellation.h"
#include "engine/layout/final_metric.h"
#include "kernels/extended.h"

namespace ricci {

using FinestReal = Extended<800>;

struct PolishedScales {
    std::vector<FinestReal> scale;  // per vertex of the final triangulation; empty: none yet

    /// Solves on in `Real`.
    template <class Real>
    PolishedMetric<Real> solve(const CommonRefinement& refinement) {
        std::vector<Real> start;
        for (const FinestReal& s : scale) start.push_back(static_cast<Real>(s));
        PolishedMetric<Real> polished = polish_hyperbolic<Real>(refinement, std::move(start));
        scale.assign(polished.scale.begin(), polished.scale.end());
        return polished;
    }
};

/// Calls level(digits, Real()) from coarse to fine until it returns false or `max_digits` are used up.
template <class Level>
void climb_precision(int max_digits, Level&& level) {
    const auto step = [&]<class Real>(int digits, Real) {
        cancellation_point();
        return digits <= max_digits && level(digits, Real());
    };
    step(19, 0.0L) && step(50, Extended<50>()) && step(100, Extended<100>()) && step(200, Extended<200>()) &&
        step(400, Extended<400>()) && step(800, FinestReal());
}

}  // namespace ricci
