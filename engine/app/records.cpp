#include "engine/app/records.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <limits>

#include "engine/app/commands.h"
#include "engine/app/version.h"

namespace ricci::app {

RunInfo make_run_info(const std::string& config, const std::string& fingerprint, int threads) {
    RunInfo info;
    info.software_version = ricci_version();
    info.git = ricci_git();
    info.command = command_line();
    info.config = config;
    info.fingerprint = fingerprint;
    std::array<char, 256> host{};
    if (gethostname(host.data(), host.size() - 1) == 0) info.host = host.data();
    info.threads = threads;
    for (const std::string_view name : kStatusNames) info.status.names.emplace_back(name);
    return info;
}

std::string item_name(const std::string& stem, Index faces) {
    return fmt::format("{}@{}", stem, faces);
}

ItemRecord make_item(const std::string& name, const std::string& source, std::uint64_t hash,
                     const SurfaceMesh& mesh, const std::vector<Index>& source_vertex) {
    const Topology topology = topology_of(mesh.connectivity);
    ItemRecord item;
    item.name = name;
    item.source = source;
    item.source_hash = fmt::format("{:016x}", hash);
    item.units = "";
    item.vertices = topology.vertices;
    item.faces = topology.faces;
    item.genus = topology.genus;
    item.boundaries = topology.boundaries;
    item.euler_characteristic = topology.euler_characteristic;
    item.points = mesh.points;
    item.triangles = triangles_of(mesh.connectivity);
    item.source_vertex = source_vertex.empty() ? mesh.input_vertex : source_vertex;
    if (mesh.intrinsic()) {
        item.twin = mesh.connectivity.twin;
        item.edge_length = mesh.edge_length;
    }
    return item;
}

SurfaceMesh surface_of(const ItemRecord& item) {
    try {
        if (item.twin.empty()) return make_surface_mesh(item.points, item.triangles);
        SurfaceMesh mesh;
        std::vector<Index> tail;
        for (const Triangle& t : item.triangles) tail.insert(tail.end(), t.begin(), t.end());
        mesh.connectivity = connectivity_from_gluing(std::move(tail), item.twin,
                                                     static_cast<Index>(item.source_vertex.size()));
        if (const char* broken = check_connectivity(mesh.connectivity); *broken != '\0')
            throw std::invalid_argument(broken);
        mesh.edge_length = item.edge_length;
        mesh.input_vertex = item.source_vertex;
        return mesh;
    } catch (const std::invalid_argument& error) {
        throw FileError(item.name + "/mesh: no surface: " + error.what());
    }
}

FlowRecord make_flow_record(const std::string& item, const FlowResult& result, const FlowOptions& options,
                            double seconds) {
    FlowRecord record;
    record.item = item;
    record.geometry = name_of(result.geometry);
    record.scheme = name_of(options.scheme);
    record.method = name_of(options.method);
    record.boundary = name_of(result.boundary);
    record.status = static_cast<std::uint8_t>(result.outcome.status);
    record.newton_iterations = result.outcome.iterations;
    record.flips = static_cast<std::int32_t>(result.outcome.flips);
    record.residual_max = result.outcome.residual_max;
    record.gauss_bonnet_error = result.gauss_bonnet_error;
    record.seconds = seconds;
    record.precision_digits = result.precision_digits;
    record.conformal_factor_low = result.conformal_factor_low;
    record.doubled = result.doubled;
    record.conformal_factor = result.conformal_factor;
    record.target_curvature = result.target_curvature;
    record.curvature = result.curvature;
    record.triangles = triangles_of(result.triangulation);
    record.twin = result.triangulation.twin;
    record.edge_length = result.edge_length;
    for (const IterationLog& line : result.outcome.log) {
        record.log_residual_max.push_back(line.residual_max);
        record.log_step.push_back(line.step);
        record.log_flips.push_back(static_cast<std::int32_t>(line.flips));
        record.log_seconds.push_back(line.seconds);
    }
    return record;
}

SweepRow make_row(const SweepSolve& solve) {
    SweepRow row;
    row.vertex = solve.vertex;
    row.status = static_cast<std::uint8_t>(solve.status);
    row.area_distortion = solve.area_distortion;
    row.newton_iterations = static_cast<std::uint16_t>(
        std::min<std::int32_t>(solve.newton_iterations, std::numeric_limits<std::uint16_t>::max()));
    row.residual_max = solve.residual_max;
    row.flips = static_cast<std::int32_t>(
        std::min<std::int64_t>(solve.flips, std::numeric_limits<std::int32_t>::max()));
    row.seconds = static_cast<float>(solve.seconds);
    row.gauss_bonnet_error = solve.gauss_bonnet_error;
    row.precision_digits = solve.precision_digits;
    return row;
}

}  // namespace ricci::app
