#include "engine/app/index_vectors.h"

#include <fmt/format.h>

#include "engine/app/console.h"

namespace ricci::app {

ShapeMetric parse_shape_metric(const std::string& text) {
    for (const ShapeMetric metric : {ShapeMetric::spectrum, ShapeMetric::coordinates})
        if (text == name_of(metric)) return metric;
    throw UsageError(fmt::format("metric '{}' is not one of spectrum, coordinates", text));
}

Linkage parse_linkage(const std::string& text) {
    for (const Linkage linkage : {Linkage::average, Linkage::single, Linkage::complete})
        if (text == name_of(linkage)) return linkage;
    throw UsageError(fmt::format("linkage '{}' is not one of average, single, complete", text));
}

ShapeVectors shape_vectors(const IndexBucket& bucket, ShapeMetric metric) {
    const bool spectrum = metric == ShapeMetric::spectrum;
    return {bucket.genus, bucket.boundaries, metric,
            spectrum ? bucket.fingerprint_size : bucket.coordinate_count,
            spectrum ? bucket.fingerprint : bucket.coordinates};
}

}  // namespace ricci::app
