#include "engine/shape_space/path_holonomy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/shape_space/closed_geodesic.h"

namespace ricci {

PathHolonomy::PathHolonomy(const SurfaceStructure& structure, const Connectivity& input)
    : structure_(&structure), walks_(*structure.refinement, input, *structure.basis) {}

void PathHolonomy::append(Step step, Isometry<double>& product) const {
    const FinalMetric<double>& metric = *structure_->metric;
    const Connectivity& c = structure_->refinement->final_triangulation.connectivity;
    std::vector<Index> crossed;
    walks_.append_walk(halfedge_of(step), crossed);
    if (step < 0) {
        std::reverse(crossed.begin(), crossed.end());
        for (Index& g : crossed) g = ~g;
    }
    for (const Index g : crossed)
        product =
            compose(metric.kappa, product, g >= 0 ? metric.crossing(c, g) : inverse(metric.crossing(c, ~g)));
}

Isometry<double> PathHolonomy::of(std::span<const Step> path, std::size_t first) const {
    Isometry<double> product;
    for (std::size_t k = 0; k < path.size(); ++k) append(path[(first + k) % path.size()], product);
    return product;
}

PathLength PathHolonomy::length_of(std::span<const Step> path) const {
    const double here = translation_length(of(path)), there = translation_length(of(path, path.size() / 2));
    if (!(here > 0) || !(there > 0)) return {};
    return {here, std::abs(here - there) / here};
}

}  // namespace ricci
