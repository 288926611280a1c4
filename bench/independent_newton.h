// The honest baseline of sweeps and single solves: Newton's method with the same flips, one CHOLMOD
// factorisation per step under a nested dissection that is chosen once per mesh, nothing else shared.
#pragma once

#include <memory>
#include <numbers>
#include <vector>

#include "bench/surfaces.h"
#include "engine/flow/newton.h"
#include "engine/flow/target.h"

namespace ricci::bench {

/// One vertex after the other as the only cone, each on its own.
class IndependentNewton {
  public:
    IndependentNewton(const SurfaceMesh& mesh, double tolerance)
        : surface_(make_flow_surface(mesh, true, true)),
          start_(rounded(surface_.triangulation)),
          cone_(2.0 * std::numbers::pi * surface_.topology.euler_characteristic) {
        FlowOptions options;
        options.geometry = Geometry::euclidean;
        target_ = make_target(surface_, options, Geometry::euclidean, Boundary::geodesic);
        newton_ = std::make_unique<NewtonSolver>(surface_, target_, Definiteness::positive, true);
        metric_ = std::make_unique<ScaledMetric<double>>(surface_, Geometry::euclidean, false);
        options_.tolerance = tolerance;
        options_.factorize_always = true;
    }

    SolveOutcome solve(Index vertex, std::vector<double>& u) {
        u.assign(target_.curvature.size(), 0.0);
        target_.curvature[at(vertex)] = cone_;
        metric_->reset(start_);
        SolveOutcome outcome = newton_->solve(*metric_, target_, options_, u);
        target_.curvature[at(vertex)] = 0.0;
        return outcome;
    }

  private:
    FlowSurface surface_;
    IntrinsicTriangulation<double> start_;
    double cone_;
    CurvatureTarget target_;
    std::unique_ptr<NewtonSolver> newton_;
    std::unique_ptr<ScaledMetric<double>> metric_;
    SolveOptions options_;
};

}  // namespace ricci::bench
