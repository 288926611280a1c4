#include "engine/topology/boundary_loops.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

Index next_on_boundary(const Connectivity& connectivity, Index h) {
    Index n = next_halfedge(h);
    while (connectivity.twin[at(n)] != kNoTwin) n = next_halfedge(connectivity.twin[at(n)]);
    return n;
}

std::vector<std::vector<Index>> boundary_loops(const Connectivity& connectivity) {
    std::vector<std::vector<Index>> loops;
    std::vector<std::uint8_t> seen(connectivity.tail.size(), 0);
    for (Index start = 0; start < connectivity.halfedge_count(); ++start) {
        if (connectivity.twin[at(start)] != kNoTwin || seen[at(start)] != 0) continue;
        std::vector<Index>& loop = loops.emplace_back();
        for (Index h = start; seen[at(h)] == 0; h = next_on_boundary(connectivity, h)) {
            seen[at(h)] = 1;
            loop.push_back(h);
        }
    }
    return loops;
}

}  // namespace ricci
