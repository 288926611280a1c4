// Words in the generators of a free group.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// A product of letters, read from left to right as a path is walked: +(k+1) is generator k, -(k+1) its
/// inverse; 0 is no letter. The empty word is the identity.
using Word = std::vector<Index>;

/// The generator k of the letter +-(k+1).
constexpr Index generator_of(Index letter) {
    return (letter > 0 ? letter : -letter) - 1;
}

/// The inverse word, letter by letter (not reduced).
Word inverse(std::span<const Index> word);

/// The word without adjacent inverse letters (free reduction).
Word reduced(std::span<const Index> word);

/// The reduced word of the same conjugacy class whose ends do not cancel either.
Word cyclically_reduced(std::span<const Index> word);

/// Appends `tail` to `word`, cancelling where they meet; a reduced word stays reduced.
void append_reduced(Word& word, std::span<const Index> tail);

/// The reduced product first * second.
Word product(std::span<const Index> first, std::span<const Index> second);

/// The reduced word by * word * by^-1.
Word conjugated(std::span<const Index> word, std::span<const Index> by);

/// The reduced commutator a b a^-1 b^-1.
Word commutator(std::span<const Index> a, std::span<const Index> b);

/// Whether two words are conjugate in the free group.
bool are_conjugate(std::span<const Index> first, std::span<const Index> second);

/// "a1 b1^-1": letters separated by blanks, "1" for the empty word. `names`: one per generator; throws
/// std::invalid_argument for a letter without name.
std::string to_text(std::span<const Index> word, std::span<const std::string> names);

}  // namespace ricci
