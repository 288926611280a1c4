#include "engine/structure/surface_structure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "engine/flow/cancellation.h"
#include "engine/layout/final_metric.inl"
#include "engine/layout/polished_scales.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

class Stopwatch {
  public:
    /// Seconds since the last call.
    double lap() {
        const auto now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - last_).count();
        last_ = now;
        return seconds;
    }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_ = Clock::now();
};

/// From scales solved in more digits where there are any.
FinalMetric<double> rounded_metric(int kappa, const CommonRefinement& refinement, PolishedScales& scales) {
    if (scales.scale.empty()) return make_final_metric(kappa, refinement);
    const std::vector<long double> half = scales.solve<long double>(refinement).metric.half_chord;
    return make_final_metric<double>(kappa, std::vector<double>(half.begin(), half.end()));
}

}  // namespace

std::vector<Index> cone_vertices(const SurfaceMesh& mesh, const FlowResult& flow) {
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity),
                                    used = used_vertices(mesh.connectivity);
    std::vector<Index> cones;
    for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v] && !boundary[v] && std::abs(flow.target_curvature[v]) > 1e-9)
            cones.push_back(static_cast<Index>(v));
    return cones;
}

std::vector<double> final_edge_lengths(const SurfaceMesh& mesh, std::span<const double> u, int kappa) {
    const Connectivity& c = mesh.connectivity;
    std::vector<double> length(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const double chord =
            mesh.edge_length[at(h)] * std::exp((u[at(c.tail[at(h)])] + u[at(c.head(h))]) / 2);
        length[at(h)] = kappa == 0
                            ? chord
                            : 2 * (kappa < 0 ? std::asinh(chord / 2) : std::asin(std::min(1.0, chord / 2)));
        const Index t = c.twin[at(h)];
        if (t != kNoTwin && t < h) length[at(h)] = length[at(t)];
    }
    return length;
}

CommonRefinement refinement_of_flow(const SurfaceMesh& mesh, const FlowResult& flow, bool delaunay,
                                    double log_scale) {
    const int kappa = curvature_sign(flow.geometry);
    if (flow.packing) {
        // The circles' lengths as chords on the input's own triangulation.
        std::vector<double> log_chord;
        for (const double length : flow.edge_length) {
            const double chord =
                kappa == 0 ? length : 2 * (kappa < 0 ? std::sinh(length / 2) : std::sin(length / 2));
            log_chord.push_back(std::log(chord) + log_scale);
        }
        return trivial_refinement(mesh, log_chord);
    }
    std::vector<double> u = flow.conformal_factor;
    for (double& value : u) value += log_scale;
    return make_common_refinement(mesh, u, flow.doubled, delaunay);
}

SurfaceStructure make_surface_structure(const SurfaceMesh& mesh, const StructureOptions& options) {
    Stopwatch watch;
    FlowResult flow = solve_flow(mesh, options.flow);
    const double seconds = watch.lap();
    SurfaceStructure s = make_surface_structure(mesh, std::move(flow), options);
    s.seconds.flow = seconds;
    return s;
}

SurfaceStructure make_surface_structure(const SurfaceMesh& mesh, FlowResult flow,
                                        const StructureOptions& options) {
    SurfaceStructure s;
    Stopwatch watch;
    s.flow = std::move(flow);
    s.kappa = curvature_sign(s.flow.geometry);
    cancellation_point();
    if (s.flow.outcome.status != Status::converged) return s;
    if (s.kappa == 0) s.log_scale = -0.5 * std::log(s.flow.area);
    s.refinement.emplace(refinement_of_flow(mesh, s.flow, options.flow.delaunay, s.log_scale));
    s.seconds.refinement = watch.lap();
    cancellation_point();
    const std::vector<double> length =
        s.flow.packing ? s.flow.edge_length : final_edge_lengths(mesh, s.flow.conformal_factor, s.kappa);
    s.basis.emplace(
        make_homotopy_basis(mesh.connectivity, length, {options.base, cone_vertices(mesh, s.flow)}));
    s.canonical = make_canonical_basis(s.basis->relator(), s.basis->loops(), s.basis->punctures());
    s.cut = make_cut_graph(mesh.connectivity, *s.basis);
    s.seconds.topology = watch.lap();
    cancellation_point();
    PolishedScales scales;
    // The metric is solved anew in more digits where it is to be smooth everywhere.
    const bool smooth = std::all_of(s.flow.target_curvature.begin(), s.flow.target_curvature.end(),
                                    [](double k) { return k == 0.0; });
    const bool closed = s.flow.doubled || s.flow.triangulation.twin.end() ==
                                              std::find(s.flow.triangulation.twin.begin(),
                                                        s.flow.triangulation.twin.end(), kNoTwin);
    const int digits = smooth && closed && !s.flow.packing ? options.max_digits : 16;
    s.group = make_surface_group(s.kappa, *s.refinement, mesh.connectivity, *s.basis, s.canonical,
                                 {options.goal, digits, &scales});
    s.seconds.group = watch.lap();
    cancellation_point();
    s.layout = make_surface_layout(s.kappa, *s.refinement, mesh.connectivity, *s.basis, s.cut,
                                   {options.seed_face, options.goal, digits, &scales});
    count_orientations(*s.refinement, s.layout);
    s.metric.emplace(rounded_metric(s.kappa, *s.refinement, scales));
    s.seconds.layout = watch.lap();
    return s;
}

}  // namespace ricci
