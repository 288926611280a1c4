#include "engine/app/shape_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

#include "engine/flow/cancellation.h"
#include "engine/remesh/resample.h"

namespace ricci::app {
namespace {

ShapeRecord make_record(const SurfaceMesh& mesh, ShapeDescriptor shape) {
    ShapeRecord record;
    const Topology topology = topology_of(mesh.connectivity);
    record.status = static_cast<std::uint8_t>(shape.status);
    record.message = std::move(shape.message);
    record.genus = topology.genus;
    record.boundaries = topology.boundaries;
    record.vertices = topology.vertices;
    record.faces = topology.faces;
    record.fingerprint = std::move(shape.fingerprint);
    record.coordinates = std::move(shape.coordinates);
    record.names = std::move(shape.names);
    record.lengths = std::move(shape.lengths);
    record.primitive = std::move(shape.primitive);
    record.complete_up_to = shape.complete_up_to;
    record.marking_gap = shape.marking_gap;
    record.residual_max = shape.accuracy.residual_max;
    record.gauss_bonnet_error = shape.accuracy.gauss_bonnet_error;
    record.precision_digits = shape.accuracy.precision_digits;
    record.seconds = {shape.seconds.flow, shape.seconds.surface, shape.seconds.spectrum,
                      shape.seconds.coordinates};
    return record;
}

bool converged(const ShapeRecord& record) {
    return record.status == static_cast<std::uint8_t>(Status::converged);
}

ShapeRecord failed(Status status, const std::string& message) {
    ShapeRecord record;
    record.status = static_cast<std::uint8_t>(status);
    record.message = message;
    return record;
}

ShapeRecord describe_one(const SurfaceMesh& mesh, const ShapeOptions& options) {
    ShapeRecord record = make_record(mesh, describe_shape(mesh, options));
    const bool finite = std::all_of(record.fingerprint.begin(), record.fingerprint.end(),
                                    [](double v) { return std::isfinite(v); });
    if (converged(record) && (record.fingerprint.empty() || !finite))
        return failed(Status::not_finite, "the fingerprint is empty or not finite");
    return record;
}

/// Throws std::invalid_argument for a resolution that cannot be had.
ShapeRecord describe_all(const SurfaceMesh& mesh, const ShapeOptions& options,
                         const std::vector<Index>& resolutions) {
    std::vector<ShapeRecord> records;
    for (const Index faces : resolutions) {
        records.push_back(faces > 0 ? describe_one(resample(mesh, faces).mesh, options)
                                    : describe_one(mesh, options));
        if (converged(records.back())) continue;
        if (resolutions.size() > 1)
            records.back().message =
                fmt::format("at {} faces: {}", faces > 0 ? faces : mesh.connectivity.face_count(),
                            records.back().message);
        return records.back();
    }
    std::stable_sort(records.begin(), records.end(),
                     [](const ShapeRecord& a, const ShapeRecord& b) { return a.faces < b.faces; });
    ShapeRecord finest = records.back();
    if (records.size() == 1) return finest;
    finest.seconds = {};
    for (const ShapeRecord& record : records) {
        const bool comparable = record.coordinates.size() == finest.coordinates.size();
        finest.resolutions.push_back(
            {record.faces, record.fingerprint, comparable ? record.coordinates : std::vector<double>()});
        for (std::size_t k = 0; k < finest.seconds.size(); ++k) finest.seconds[k] += record.seconds[k];
    }
    return finest;
}

}  // namespace

ShapeRecord describe_to_record(const SurfaceMesh& mesh, const ShapeOptions& options,
                               const std::vector<Index>& resolutions) {
    try {
        return describe_all(mesh, options, resolutions);
    } catch (const Cancelled& e) {
        return failed(Status::cancelled, e.what());
    } catch (const std::invalid_argument& e) {
        return failed(Status::invalid_input, e.what());
    } catch (const std::bad_alloc&) {
        return failed(Status::out_of_memory, "memory ran out");
    } catch (const std::exception& e) {
        return failed(Status::internal_error, e.what());
    }
}

}  // namespace ricci::app
