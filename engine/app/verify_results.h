// Rebuilding stored solutions: nobody has to believe a self-reported residual.
#pragma once

#include <string>
#include <vector>

#include "io/store/run_store.h"

namespace ricci::app {

/// One stored solution, rebuilt from mesh/ and its conformal factor alone.
struct RecomputedSolution {
    std::string item, what;  // "best (vertex 17)", "flow", …
    double residual_stored = 0.0, residual_recomputed = 0.0;
    double gauss_bonnet_stored = 0.0, gauss_bonnet_recomputed = 0.0;  // stored: NaN where the file lacks it
    int digits = 19;                                                  // of the recomputation's arithmetic
    double distortion_stored = 0.0, distortion_recomputed = 0.0;      // NaN for flows
    std::int64_t flips = 0;
    bool sound = false;
    std::string message;  // why not
};

/// Rebuilds every stored sweep solution and flow (vertex scaling: from scratch by engine/verify; circle
/// packings: from the initial packing and u) and compares. Solutions run in parallel; the result is in file
/// order.
std::vector<RecomputedSolution> recompute_solutions(const StoredRun& run, int threads);

}  // namespace ricci::app
