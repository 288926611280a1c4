#include "engine/shape_space/handle_cocycles.h"

#include <cmath>

#include "engine/topology/homotopy_basis.h"

namespace ricci {

std::vector<Cocycle> handle_cocycles(const CoarseSurface& surface) {
    const Connectivity& c = surface.connectivity;
    std::vector<Cocycle> cocycles;
    if (surface.genus == 0) return cocycles;
    std::vector<double> length;
    for (const double s : surface.half_chord) length.push_back(2 * std::asinh(s));
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[static_cast<std::size_t>(h)];
        if (t != kNoTwin && t < h) length[static_cast<std::size_t>(h)] = length[static_cast<std::size_t>(t)];
    }
    const HomotopyBasis basis = make_homotopy_basis(c, length);
    cocycles.assign(static_cast<std::size_t>(basis.loops()), Cocycle(c.tail.size(), 0));
    for (Index h = 0; h < c.halfedge_count(); ++h)
        for (const Index letter : basis.word_of(h))
            if (generator_of(letter) < basis.loops())
                cocycles[static_cast<std::size_t>(generator_of(letter))][static_cast<std::size_t>(h)] +=
                    letter > 0 ? 1 : -1;
    return cocycles;
}

}  // namespace ricci
