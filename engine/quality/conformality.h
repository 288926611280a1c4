// How nearly conformal the map from an input surface to its final metric is (thesis, section 8.3).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/layout/final_metric.h"
#include "engine/quality/distribution.h"

namespace ricci {

/// regular: counted. curved: at an input vertex whose angle sum the map changes by more than 5 % of 2 pi (its
/// curvature, where the image is flat), so that no map could keep its angles. unresolved: rounding alone
/// could change the ratio by 1e-3, or the piece has no area.
enum class CornerKind : std::uint8_t { regular, curved, unresolved };

/// Ratios of angles, image over input; shares of those within 1 % and 5 % of 1, by number and by area.
struct AngleSummary {
    Distribution ratio;
    double within_1 = 0.0, within_5 = 0.0;
    double area_within_1 = 0.0, area_within_5 = 0.0;
};

struct AngleRatios {
    std::vector<double> ratio;  // per corner; NaN where unresolved
    std::vector<CornerKind> kind;
    AngleSummary regular, curved;
    std::int64_t unresolved = 0;
};

struct ConformalityReport {
    AngleRatios pieces;  // C, at the corners of the pieces; their weight is the piece's area
    AngleRatios faces;   // 3F, at the corners of the input's faces: angle between the images of the two edges
    /// sigma1 / sigma2 >= 1 of the map's derivative, averaged over the piece, in a conformal chart centred on
    /// it; NaN where the piece is degenerate. // P
    std::vector<double> distortion;
    Distribution distortion_by_area;  // mean and quantiles weighted by the input's area
    std::int64_t degenerate = 0;      // pieces whose area, here or there, is not above rounding
    std::int64_t flipped = 0;         // pieces whose area is below it: turned over

    std::vector<double> image_area;      // F, of the input's faces in the final metric
    std::vector<double> log_area_ratio;  // F, log of share of the image's area over share of the input's; NaN
                                         // where the image has no area
    Distribution log_area;               // of log_area_ratio
    double area_distortion = 0.0;        // its mean square
    double total_image_area = 0.0;
};

/// `metric`: of the refinement, which was made of `mesh`. Images of straight sides are geodesics.
ConformalityReport measure_conformality(const SurfaceMesh& mesh, const CommonRefinement& refinement,
                                        const FinalMetric<double>& metric);

}  // namespace ricci
