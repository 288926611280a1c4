#include "engine/surfaces/block_lattice.h"

#include <algorithm>

namespace ricci {
namespace {

LatticePoint along(const LatticePoint& start, const LatticePoint& step, Index count) {
    return {start[0] + count * step[0], start[1] + count * step[1], start[2] + count * step[2]};
}

/// The squares of the skin, each with sides that turn counterclockwise seen from outside.
std::vector<BlockSquare> skin_squares(Index genus, Index repeats) {
    const LatticePoint size = {2 * genus + 1, 3, 1};
    const auto solid = [&](const LatticePoint& cell) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (cell[k] < 0 || cell[k] >= size[k]) return false;
        }
        return !(cell[1] == 1 && cell[0] % 2 == 1);
    };
    const auto add_square = [&](std::vector<BlockSquare>& squares, const LatticePoint& cell, std::size_t axis,
                                bool upper) {
        BlockSquare square{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        for (std::size_t k = 0; k < 3; ++k) square.corner[k] = repeats * (2 * cell[k] - size[k]);
        if (upper) square.corner[axis] += 2 * repeats;
        square.first_step[(axis + (upper ? 1 : 2)) % 3] = 2;
        square.second_step[(axis + (upper ? 2 : 1)) % 3] = 2;
        squares.push_back(square);
    };
    std::vector<BlockSquare> squares;
    for (Index i = 0; i < size[0]; ++i) {
        for (Index j = 0; j < size[1]; ++j) {
            const LatticePoint cell = {i, j, 0};
            if (!solid(cell)) continue;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                for (const bool upper : {false, true}) {
                    LatticePoint neighbour = cell;
                    neighbour[axis] += upper ? 1 : -1;
                    if (!solid(neighbour)) add_square(squares, cell, axis, upper);
                }
            }
        }
    }
    return squares;
}

}  // namespace

Index BlockLattice::vertex_at(const LatticePoint& position) const {
    return static_cast<Index>(std::lower_bound(vertices.begin(), vertices.end(), position) -
                              vertices.begin());
}

BlockQuadCount count_block_quads(Index genus, Index repeats) {
    BlockQuadCount count{0.0, 0.0};
    for (const BlockSquare& square : skin_squares(genus, 1)) {
        count.all += static_cast<double>(repeats) * repeats;
        if (repeats % 2 == 0) continue;  // mirrors run along sides of quads
        int mirrors = 0;                 // that cut the coarse square in the middle
        for (std::size_t k = 0; k < 3; ++k) {
            const Index step = square.first_step[k] + square.second_step[k];
            if (step != 0 && 2 * square.corner[k] + step == 0) ++mirrors;
        }
        if (mirrors > 0) count.self_mirrored += mirrors == 1 ? repeats : 2.0 * repeats - 1.0;
    }
    return count;
}

BlockLattice make_block_lattice(Index genus, Index repeats) {
    BlockLattice lattice;
    lattice.repeats = repeats;
    lattice.squares = skin_squares(genus, repeats);
    for (const BlockSquare& square : lattice.squares) {
        for (Index i = 0; i <= repeats; ++i) {
            for (Index j = 0; j <= repeats; ++j) {
                lattice.vertices.push_back(
                    along(along(square.corner, square.first_step, i), square.second_step, j));
            }
        }
    }
    std::sort(lattice.vertices.begin(), lattice.vertices.end());
    lattice.vertices.erase(std::unique(lattice.vertices.begin(), lattice.vertices.end()),
                           lattice.vertices.end());
    for (const BlockSquare& square : lattice.squares) {
        const auto vertex = [&](Index i, Index j) {
            return lattice.vertex_at(
                along(along(square.corner, square.first_step, i), square.second_step, j));
        };
        for (Index i = 0; i < repeats; ++i) {
            for (Index j = 0; j < repeats; ++j) {
                lattice.quads.push_back(
                    {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
            }
        }
    }
    return lattice;
}

}  // namespace ricci
