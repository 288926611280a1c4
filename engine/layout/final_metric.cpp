#include "engine/layout/final_metric.inl"

namespace ricci {
namespace final_metric {

FactorizedHessian::FactorizedHessian(const CommonRefinement& r)
    : solver_(make_symmetric_solver(Definiteness::positive)) {
    const IntrinsicTriangulation<double> t = rounded(r.final_triangulation);
    const std::size_t halfedges = t.log_chord.size();
    std::vector<double> angle(halfedges), off(halfedges), diagonal(halfedges);
    const ScaledChords<double> chords{t.connectivity.tail, t.log_chord, r.u};
    evaluate_faces<double>(Geometry::hyperbolic, chords, {angle, off, diagonal, {}}, false);
    std::vector<Index> unknown(at(t.connectivity.vertex_count), -1);
    const std::vector<std::uint8_t> used = used_vertices(t.connectivity);
    Index count = 0;
    for (std::size_t v = 0; v < unknown.size(); ++v)
        if (used[v]) unknown[v] = count++;
    HessianAssembler assembler;
    assembler.build(t.connectivity, unknown, count);
    std::vector<double> values;
    assembler.assemble(t.connectivity, off, diagonal, -1, values);
    solver_->choose_ordering(assembler.pattern(), Ordering::minimum_degree);
    if (!solver_->factorize(values))
        throw std::runtime_error("the Hessian of the hyperbolic metric is not positive definite");
    unknown_ = std::move(unknown);
    packed_.resize(static_cast<std::size_t>(count));
}

void FactorizedHessian::solve(std::vector<double>& values) {
    for (std::size_t v = 0; v < values.size(); ++v)
        if (unknown_[v] >= 0) packed_[at(unknown_[v])] = values[v];
    solver_->solve(packed_, packed_);
    for (std::size_t v = 0; v < values.size(); ++v)
        values[v] = unknown_[v] >= 0 ? packed_[at(unknown_[v])] : 0.0;
}

}  // namespace final_metric

FinalMetric<double> make_final_metric(int kappa, const CommonRefinement& r) {
    const Connectivity& c = r.final_triangulation.connectivity;
    std::vector<double> half(c.tail.size());
    std::vector<double> u(r.u.size());
    for (std::size_t v = 0; v < u.size(); ++v) u[v] = 0.5 * r.u[v];
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[final_metric::at(h)];
        if (t != kNoTwin && t < h) {
            half[final_metric::at(h)] = half[final_metric::at(t)];
            continue;
        }
        const double ends = u[final_metric::at(c.tail[final_metric::at(h)])] + u[final_metric::at(c.head(h))];
        half[final_metric::at(h)] =
            0.5 * std::exp(static_cast<double>(r.final_triangulation.log_chord[final_metric::at(h)]) + ends);
    }
    return make_final_metric<double>(kappa, std::move(half));
}

template struct FinalMetric<double>;

}  // namespace ricci
