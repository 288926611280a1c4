// Words in canonical generators, modulo the relator.
#pragma once

#include <span>

#include "engine/topology/words.h"

namespace ricci {

/// A shorter word of the same conjugacy class in the group with generators a1, b1, ..., ag, bg, c1, ..., cn
/// (numbered in this order) and the relator [a1,b1] ... [ag,bg] c1 ... cn, by Dehn's algorithm: a stretch
/// that is more than half of the relator or its inverse, both read cyclically, is replaced by what is left of
/// them. For g >= 2, n = 0 the result is empty exactly when the element is 1 (Dehn 1912); on the torus it is
/// a1^p b1^q. Conjugate words may still have different results. Throws std::invalid_argument for letters out
/// of range.
Word shortened_by_relator(Index genus, Index punctures, std::span<const Index> word);

}  // namespace ricci
