// A coarse surface in fifty digits, for products of many steps.
#pragma once

#include "engine/shape_space/coarse_surface.h"
#include "kernels/extended.h"

namespace ricci {

using Exact = Extended<50>;

/// Products along long paths lose e^(2R) of rounding where they come to lie R away. So one scale per vertex
/// is solved for until all angle sums are right to fifty digits: lengths change by what they were uncertain
/// by anyhow, and the surface is then a hyperbolic one, however long the path. (Few vertices make this cheap
/// where it is not for the fine triangulation.)
class ExactSurface {
  public:
    /// Throws std::runtime_error where the angle sums do not converge.
    explicit ExactSurface(const CoarseSurface& surface);

    [[nodiscard]] const CoarseSurface& coarse() const { return *surface_; }
    /// From the frame where a step ends to that where it starts.
    [[nodiscard]] Isometry<Exact> along(CoarseStep step) const {
        return step >= 0 ? step_[static_cast<std::size_t>(step)]
                         : inverse(step_[static_cast<std::size_t>(~step)]);
    }
    /// The product of a path, from the frame where it ends to that where it starts.
    [[nodiscard]] Isometry<Exact> along(const CoarsePath& path) const;
    /// The exact isometry that `target` is an approximation of: one that takes the frame of some vertex to
    /// that of a lift, as seen from `from`. Throws std::runtime_error where it leads to no vertex.
    [[nodiscard]] Isometry<Exact> exact(Index from, const Isometry<double>& target) const;

  private:
    const CoarseSurface* surface_;
    std::vector<Isometry<Exact>> step_;
};

/// Edges from a vertex to the lift at the end of `target`, each towards it. Throws as ExactSurface::exact.
CoarsePath path_towards(const CoarseSurface& surface, Index from, const Isometry<double>& target);

}  // namespace ricci
