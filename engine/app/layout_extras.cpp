#include "engine/app/layout_extras.h"

#include <limits>

#include "engine/app/quality_record.h"

namespace ricci::app {

LayoutExtras make_layout_extras(const SurfaceMesh& mesh, const SurfaceStructure& s,
                                const LayoutExtrasOptions& wanted) {
    LayoutExtras extras;
    if (!s.refinement || (!wanted.quality && wanted.atlas.empty())) return extras;
    const FinalMetric<double>& metric = *s.metric;
    if (wanted.quality) extras.quality = measure_conformality(mesh, *s.refinement, metric);
    if (wanted.atlas.empty()) return extras;
    AtlasOptions options;
    options.kind = parse_atlas_kind(wanted.atlas, s.kappa);
    options.charts = wanted.charts;
    options.cones = s.basis->cones();
    extras.atlas = make_atlas(mesh.connectivity, *s.refinement, metric, options);
    extras.checks = check_atlas(*s.refinement, *extras.atlas, options.cones);
    return extras;
}

std::vector<Isometry<double>> tessellation_of(const SurfaceStructure& s, std::int64_t copies,
                                              double distance) {
    if (copies == 0 || !s.refinement) return {};
    const double farthest = s.kappa < 0 ? distance : std::numeric_limits<double>::infinity();
    return tessellate(s.layout, static_cast<std::size_t>(copies), farthest);
}

}  // namespace ricci::app
