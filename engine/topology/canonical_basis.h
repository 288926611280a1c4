// Canonical generators a1, b1, ..., ag, bg as words in the letters of a homotopy basis.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/topology/words.h"

namespace ricci {

/// Words with [a1,b1] ... [ag,bg] c_1 ... c_n = 1, where [a,b] = a b a^-1 b^-1 and each c is a conjugate of
/// one puncture letter, with the sign it has in the relator. In the free group the product is conjugate to
/// the relator. Where the relator is the counterclockwise boundary of a disk (homotopy_basis.h), the
/// algebraic intersection number a_i . b_i is +1: (direction of a_i, direction of b_i) is a positive frame,
/// b_i crosses a_i from its right to its left. All other intersection numbers are 0.
struct CanonicalBasis {
    std::vector<Word> a, b;       // g each, reduced
    std::vector<Word> punctures;  // in the order of the product; conjugates w c w^-1, reduced
    // The inverse substitution: each letter of the homotopy basis as a word in the canonical generators, of
    // which 2i is a[i], 2i+1 is b[i], 2g+j is punctures[j]. It holds in the free group.
    std::vector<Word> letters;

    [[nodiscard]] Index genus() const { return static_cast<Index>(a.size()); }
    /// The product above, reduced.
    [[nodiscard]] Word product() const;
    /// The letter, with its sign, of which punctures[i] is a conjugate.
    [[nodiscard]] Index puncture_letter(std::size_t i) const { return punctures[i][punctures[i].size() / 2]; }
    /// Length of the longest of all words.
    [[nodiscard]] std::size_t longest() const;
    /// "a1", "b1", "a2", ... // 2g
    [[nodiscard]] std::vector<std::string> names() const;
};

/// A word in basis letters as one in the canonical generators (numbered as in CanonicalBasis::letters): of a
/// closed curve up to conjugation, shortened by the relator (relator_words.h); else as an element of the free
/// group, reduced. Throws std::invalid_argument for letters out of range.
Word in_canonical_generators(const CanonicalBasis& basis, std::span<const Index> word, bool closed = true);

/// Cuts and pastes the polygon whose boundary is `relator`, letters 1 ... loops once with either sign, the
/// next `punctures` letters once with any sign. A pair of linked letters x, y, cyclically x A y B x^-1 C y^-1
/// D, becomes a handle by
///     x A y B x^-1 C y^-1 = C [a, b] B A,  a = C^-1 x B^-1,  b = B A y  (or a = C^-1 x A y, if shorter).
/// The handle remains where it stands, as a block that is never written out into letters, but moved out of
/// the gaps A, B, C of a later pair at the price of a conjugation. The pair that adds the fewest letters is
/// taken, the first in the word among equals. Punctures either are such blocks too or may become letters of
/// handles, and in the end either handles are moved past punctures or these past those: of the four results
/// the one with the shortest longest word. Throws std::invalid_argument when `relator` does not have the
/// letters stated or its polygon does not close to one vertex besides the punctures. O(g (g + punctures)^2).
CanonicalBasis make_canonical_basis(const Word& relator, Index loops, Index punctures);

}  // namespace ricci
