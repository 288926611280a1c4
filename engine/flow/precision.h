// Solves that need more digits than a double has, and how one finds out.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/flow/newton.h"

namespace ricci {

/// automatic: double, and more digits where double stalls or where its rounding could hide more than the
/// tolerance; plain: double alone; extended: more digits from the start.
enum class Precision : std::uint8_t { automatic, plain, extended };
std::string_view name_of(Precision precision);  // auto, double, extended

/// For people, where a solve converged but its rounding is not small.
std::string rounding_note(int digits, double rounding_floor);

/// A solve by vertex scaling, as far as it has come.
struct ScalingSolve {
    std::vector<double> u;    // V, in and out: where to start, the solution
    std::vector<double> low;  // V: u + low is the factor; empty: 0
    SolveOutcome outcome;     // of all levels together; residual_max is that of u + low
    int digits = 16;  // decimal digits of the lengths in which residual_max was measured: 16, 19 or 50
    double rounding_floor = 0.0;    // what their rounding may change the residual by (Metric::rounding_floor)
    Metric* metric = nullptr;       // stands at u + low
    std::unique_ptr<Metric> finer;  // holds it where it has more digits than a double
};

/// What a solve on one surface needs to know.
struct ScalingProblem {
    const SurfaceMesh* mesh = nullptr;  // what the surface was made of
    const FlowSurface* surface = nullptr;
    Geometry geometry = Geometry::euclidean;
    const CurvatureTarget* target = nullptr;
    bool parallel = false;
    SolveOptions options;
    Precision precision = Precision::automatic;
    double tolerated_rounding = 1e-11;  // more digits where the rounding floor is above
    /// Newton's method or another, from u (+ *low where not null), which becomes the solution.
    std::function<SolveOutcome(Metric& metric, const CurvatureTarget& target, const SolveOptions& options,
                               std::vector<double>& u, std::vector<double>* low)>
        solve;
};

/// Curvature moves by up to the largest cotangent times a change of u, and triangles of conformal metrics
/// become needles: a vertex far smaller than its neighbours is seen from them under an angle of 1e-6.
/// Logarithms of lengths in double are then too coarse however good the step is: the solve stalls, or ends at
/// a residual that is the rounding's. So lengths, and u itself, go on in long double and then in 50 digits
/// (u: in 32, the sum of two doubles) from where the level below stopped; steps stay double, the Hessian too.
/// The last level is the first whose rounding is tolerated; a factor that is good enough when rounded to
/// double is rounded.
///
/// `first`: stands at the start triangulation, in double. Scale-free solutions are shifted to mean
/// zero before the residual is measured. Euclidean, hyperbolic; spherical where only rounding is left to win.
void solve_by_scaling(const ScalingProblem& problem, Metric& first, ScalingSolve& solve);

}  // namespace ricci
