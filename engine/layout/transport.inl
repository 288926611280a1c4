// Definitions of transport.h; included by sources only.
#pragma once

#include "engine/layout/final_metric.inl"
#include "engine/layout/transport.h"

namespace ricci {

template <class Real>
Isometry<Real> Holonomy<Real>::product(std::span<const Index> crossed) const {
    const Connectivity& c = refinement_->final_triangulation.connectivity;
    Isometry<Real> result;
    for (const Index g : crossed) {
        const Isometry<Real> move = g >= 0 ? metric_->crossing(c, g) : inverse(metric_->crossing(c, ~g));
        result = compose(metric_->kappa, result, move);
    }
    return result;
}

template <class Real>
Isometry<Real> Holonomy<Real>::walk(Index h) const {
    std::vector<Index> crossed;
    walks_.append_walk(h, crossed);
    return product(crossed);
}

/// Frame at v, carried along the tree path from the base.
template <class Real>
const Isometry<Real>& Holonomy<Real>::frame(Index v) {
    std::vector<Index> open;
    for (Index w = v; !known_[final_metric::at(w)];
         w = step_tail(*input_, basis_->tree().arriving[final_metric::at(w)]))
        open.push_back(w);
    for (; !open.empty(); open.pop_back()) {
        const Index w = open.back();
        const Step step = basis_->tree().arriving[final_metric::at(w)];
        const Isometry<Real>& from = frames_[final_metric::at(step_tail(*input_, step))];
        // Into a cone along the right side of the edge, where its directions begin; against a boundary
        // halfedge, too.
        const Step back = reversed_step(*input_, step);
        const bool right = step < 0 || cone_of_[final_metric::at(w)] >= 0;
        frames_[final_metric::at(w)] =
            compose(metric_->kappa, from, right ? inverse(walk(halfedge_of(back))) : walk(step));
        normalise(metric_->kappa, frames_[final_metric::at(w)]);
        known_[final_metric::at(w)] = 1;
    }
    return frames_[final_metric::at(v)];
}

/// Deck transformation of the loop base -> tail, step, head -> base.
template <class Real>
Isometry<Real> Holonomy<Real>::element(Step step) {
    const Isometry<Real> move = step >= 0 ? walk(step) : inverse(walk(~step));
    const Isometry<Real> tail = frame(step_tail(*input_, step)), head = frame(step_head(*input_, step));
    return compose(metric_->kappa, compose(metric_->kappa, tail, move), inverse(head));
}

template <class Real>
Holonomy<Real>::Holonomy(const FinalMetric<Real>& metric, const CommonRefinement& refinement,
                         const Connectivity& input, const HomotopyBasis& basis)
    : metric_(&metric),
      refinement_(&refinement),
      input_(&input),
      basis_(&basis),
      walks_(refinement, input, basis),
      cone_of_(final_metric::at(input.vertex_count), -1),
      frames_(final_metric::at(input.vertex_count)),
      known_(final_metric::at(input.vertex_count), 0) {
    for (std::size_t i = 0; i < basis.cones().size(); ++i)
        cone_of_[final_metric::at(basis.cones()[i])] = static_cast<Index>(i);
    known_[final_metric::at(basis.base())] = 1;
    const int kappa = metric.kappa;
    for (Index k = 0; k < basis.loops(); ++k) letters_.push_back(element(basis.loop_halfedge(k)));
    for (Index j = 0; j < basis.boundaries(); ++j) {
        Isometry<Real> around;
        std::vector<Index> crossed;
        const std::vector<Index> cycle = basis.boundary_walk(j);
        for (const Index h : cycle) around = compose(kappa, around, walk(h));
        const Isometry<Real>& start = frame(input.tail[final_metric::at(cycle.front())]);
        letters_.push_back(compose(kappa, compose(kappa, start, around), inverse(start)));
    }
    for (const Index v : basis.cones()) {
        std::vector<Index> crossed;
        walks_.append_turn(v, crossed);
        const Isometry<Real>& start = frame(v);
        letters_.push_back(compose(kappa, compose(kappa, start, product(crossed)), inverse(start)));
    }
}

template <class Real>
Isometry<Real> Holonomy<Real>::of(std::span<const Index> word, Real* reach) const {
    Isometry<Real> result;
    for (const Index letter : word) {
        const Isometry<Real>& element = letters_[final_metric::at(generator_of(letter))];
        result = compose(metric_->kappa, result, letter > 0 ? element : inverse(element));
        if (reach == nullptr) continue;
        const Real size = squared(result.a) + squared(result.b);
        if (size > *reach) *reach = size;
    }
    return result;
}

}  // namespace ricci
