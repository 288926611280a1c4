// Vector algebra on lanes: one pass over memory for each step of the sweep's solver.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernels/lanes.h"

namespace ricci {

/// Changes remembered at most.
inline constexpr int kLaneHistory = 6;

/// out = base in every lane.
void lane_broadcast(std::span<const double> base, LaneArray<double>& out);

/// Rounds the first `rows` rows to single precision. Returns the largest absolute value of each lane; NaN
/// where one is.
LaneRow<double> lane_round(const LaneArray<double>& values, Index rows, LaneArray<float>& rounded);

/// What the acceleration works on; newest change first.
struct LaneHistory {
    std::vector<LaneArray<float>> right, point;  // changes of the residual and of the preconditioned point
};

/// Scalar products, per lane.
struct LaneProducts {
    std::array<LaneRow<double>, kLaneHistory> change;  // <right change, solution>
    LaneRow<double> newest_before{};                   // <newest right change, solution before>
    LaneRow<double> sum{};                             // of the solution
};

/// Writes right - right_before into the history's newest change and takes the products with all of them, over
/// the first `rows` rows.
LaneProducts lane_products(Index rows, const LaneArray<float>& right, const LaneArray<float>& right_before,
                           const LaneArray<float>& solution, const LaneArray<float>& solution_before,
                           LaneHistory& history);

/// newest point change = step + solution - solution_before; then
/// step = solution - mean - sum of weight * point change; then u += step. Lanes outside of `active` get
/// step 0. First `rows` rows.
void lane_step(Index rows, LaneMask active, const LaneArray<float>& solution,
               const LaneArray<float>& solution_before, const LaneRow<float>& mean,
               std::span<const LaneRow<float>> weight, LaneHistory& history, LaneArray<float>& step,
               LaneArray<double>& u);

}  // namespace ricci
