#include "engine/remesh/resample.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/remesh/nearest_vertex.h"
#include "engine/remesh/openmesh.h"

namespace ricci {
namespace {

/// Whether `faces` is within 1 % of `target`.
bool close_enough(Index faces, Index target) {
    const std::int64_t difference = static_cast<std::int64_t>(faces) - target;
    return 100 * std::abs(difference) <= target;
}

/// Decimates until within 1 %. A collapse that was illegal when its turn came is lost to one pass, so that a
/// further pass may find more.
SurfaceMesh decimate_to(SurfaceMesh mesh, Index target) {
    while (!close_enough(mesh.connectivity.face_count(), target)) {
        const Index before = mesh.connectivity.face_count();
        mesh = decimate(mesh, target);
        if (mesh.connectivity.face_count() < before) continue;
        throw std::invalid_argument("resample: " + std::to_string(target) + " faces cannot be reached: at " +
                                    std::to_string(before) +
                                    " no edge is left whose collapse would keep topology and faces sound");
    }
    return mesh;
}

void check_result(const SurfaceMesh& result, const SurfaceMesh& source) {
    const Topology now = topology_of(result.connectivity), before = topology_of(source.connectivity);
    if (now.components != before.components || now.boundaries != before.boundaries ||
        now.genus != before.genus) {
        throw std::runtime_error("resample: decimation changed the topology");
    }
    const std::vector<double> areas = face_areas(result);
    const auto flat = std::find_if(areas.begin(), areas.end(), [](double area) { return !(area > 0.0); });
    if (flat != areas.end()) {
        throw std::runtime_error("resample: face " + std::to_string(flat - areas.begin()) + " of " +
                                 std::to_string(areas.size()) + " has no area");
    }
}

}  // namespace

ResampledMesh resample(const SurfaceMesh& mesh, Index target_faces) {
    constexpr Index kFewestFaces = 4;
    if (mesh.intrinsic())
        throw std::invalid_argument("resample: an intrinsic surface keeps its triangulation");
    if (target_faces < kFewestFaces) throw std::invalid_argument("resample: a target is at least 4 faces");
    ResampledMesh result{mesh, {}};
    while (result.mesh.connectivity.face_count() < target_faces &&
           !close_enough(result.mesh.connectivity.face_count(), target_faces)) {
        result.mesh = subdivide_midpoint(result.mesh);
    }
    result.mesh = decimate_to(std::move(result.mesh), target_faces);
    check_result(result.mesh, mesh);
    result.source_vertex = nearest_vertices(mesh, result.mesh.points);
    return result;
}

}  // namespace ricci
