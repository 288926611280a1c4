// The quadrilateral skin of a row of square blocks with holes: the pattern from which handle surfaces are
// made.
//
//     +---+---+---+---+---+      genus 2, seen from above: each coarse cell is a cube; the solid is the
//     |   |   |   |   |   |      plate (2g+1) x 3 x 1 without the g hole cells. Its skin has 18 g + 14
//     +---+---+---+---+---+      coarse squares, each cut into n x n quads.
//     |   | o |   | o |   |
//     +---+---+---+---+---+      Positions are integers in units of half a quad, centred at the origin,
//     |   |   |   |   |   |      so the reflections of the pattern are changes of sign.
//     +---+---+---+---+---+
#pragma once

#include <array>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

using LatticePoint = std::array<Index, 3>;
using Quad = std::array<Index, 4>;  // vertices, counterclockwise from outside

/// One coarse square: lattice position of its corner (0,0) and the steps of one quad along its two sides.
struct BlockSquare {
    LatticePoint corner, first_step, second_step;
};

struct BlockLattice {
    Index repeats = 1;                   // n
    std::vector<LatticePoint> vertices;  // ascending: vertex_at searches them
    std::vector<Quad> quads;             // square by square, row by row
    std::vector<BlockSquare> squares;    // 18 g + 14

    /// Number of the vertex at a lattice position that is known to carry one.
    [[nodiscard]] Index vertex_at(const LatticePoint& position) const;
};

/// Numbers of quads without building them (doubles: they may exceed an Index): all, and those that one of the
/// reflections maps to themselves with their corners exchanged.
struct BlockQuadCount {
    double all, self_mirrored;
};
BlockQuadCount count_block_quads(Index genus, Index repeats);

/// The skin for genus >= 1, n = `repeats` >= 1.
BlockLattice make_block_lattice(Index genus, Index repeats);

}  // namespace ricci
