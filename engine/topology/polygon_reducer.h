// Cutting and pasting a polygon until its handles stand by themselves (canonical_basis.h).
#pragma once

#include <vector>

#include "engine/topology/words.h"

namespace ricci {

/// How a handle was cut out: x A y B x^-1 C y^-1 = C [a, b] B A with b = B A y and a = C^-1 x B^-1, or
/// a = C^-1 x A y.
struct HandleCut {
    Index x = 0, y = 0;  // letters, with sign
    Word gap_a, gap_b, gap_c;
    bool along_y = false;  // the latter a
};

/// Part of the cyclic word that is no longer cut: a handle [a,b] with words a, b, or a puncture with one
/// word.
struct PolygonBlock {
    std::vector<Word> words;
    HandleCut cut;    // of handles: their words as they were made, in letters that were left then
    Index made = -1;  // of handles: their number in the order in which they were made
    Word moved;       // by which the words have been conjugated since, in letters that were left then

    [[nodiscard]] bool is_handle() const { return words.size() == 2; }
    /// The element it stands for.
    [[nodiscard]] Word value() const { return is_handle() ? commutator(words[0], words[1]) : words[0]; }
    void conjugate(std::span<const Index> by) {
        for (Word& word : words) word = conjugated(word, by);
        moved = product(by, moved);
    }
};

/// The blocks that the polygon whose boundary is `relator` falls into, in cyclic order. Punctures are blocks
/// from the start, or letters that may enter the words of handles. Throws std::invalid_argument where the
/// polygon has more than one vertex besides the punctures. `relator` must have the letters that
/// make_canonical_basis asks for.
std::vector<PolygonBlock> reduce_polygon(const Word& relator, Index loops, bool puncture_blocks);

}  // namespace ricci
