#include "engine/layout/transport.h"

#include <stdexcept>

#include "engine/layout/transport.inl"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

PieceWalks::PieceWalks(const CommonRefinement& r, const Connectivity& input, const HomotopyBasis& basis)
    : refinement_(&r), home_(at(input.vertex_count), -1), start_(input.tail.size(), -1) {
    for (Index c = 0; c < r.corner_count(); ++c) {
        const Index v = r.vertex[at(c)];
        if (v >= r.input_vertices) continue;
        if (home_[at(v)] < 0 || r.twin[at(c)] < 0) home_[at(v)] = c;
        const Index h = r.input_halfedge[at(c)];
        if (h >= 0 && input.tail[at(h)] == v) start_[at(h)] = c;
    }
    for (std::size_t i = 0; i < basis.cones().size(); ++i) {
        const Index into = basis.cone_halfedge(static_cast<Index>(i));
        home_[at(basis.cones()[i])] = start_[at(input.twin[at(into)])];
    }
}

void PieceWalks::append_turn_between(Index from, Index to, std::vector<Index>& crossed) const {
    for (Index c = from; c != to;) {
        const Index side = refinement_->previous(c);
        if (refinement_->final_halfedge[at(side)] >= 0)
            crossed.push_back(refinement_->final_halfedge[at(side)]);
        c = refinement_->twin[at(side)];
        if (c < 0) throw std::logic_error("a walk about a vertex leaves the surface");
    }
}

void PieceWalks::append_walk(Index h, std::vector<Index>& crossed) const {
    const CommonRefinement& r = *refinement_;
    Index c = start(h);
    append_turn_between(home(r.vertex[at(c)]), c, crossed);
    for (;;) {
        c = r.next(c);
        if (r.vertex[at(c)] < r.input_vertices) break;
        while (r.input_halfedge[at(c)] != h) {  // clockwise about a crossing, to where h goes on
            if (r.final_halfedge[at(c)] >= 0) crossed.push_back(r.final_halfedge[at(c)]);
            c = r.next(r.twin[at(c)]);
        }
    }
    // From the head's home counterclockwise to here, backwards.
    std::vector<Index> turn;
    append_turn_between(home(r.vertex[at(c)]), c, turn);
    for (auto g = turn.rbegin(); g != turn.rend(); ++g) crossed.push_back(~*g);
}

void PieceWalks::append_turn(Index v, std::vector<Index>& crossed) const {
    const Index home = home_[at(v)], side = refinement_->previous(home);
    if (refinement_->final_halfedge[at(side)] >= 0) crossed.push_back(refinement_->final_halfedge[at(side)]);
    append_turn_between(refinement_->twin[at(side)], home, crossed);
}

template class Holonomy<double>;

}  // namespace ricci
