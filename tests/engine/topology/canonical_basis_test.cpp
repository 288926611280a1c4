#include "engine/topology/canonical_basis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/engine/topology/topology_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::basis_of;
using testing::Random;
using testing::test_surfaces;
using testing::TestSurface;

CanonicalBasis canonical_of(const HomotopyBasis& basis) {
    return make_canonical_basis(basis.relator(), basis.loops(), basis.punctures());
}

/// The canonical relator after random cuttings and pastings x P Q x^-1 R -> x Q P x^-1 R, which keep the
/// surface, and with punctures of either sign anywhere.
Word random_relator(Index genus, Index punctures, Random& random) {
    Word word;
    for (Index i = 0; i < genus; ++i)
        for (const Index letter : {2 * i + 1, 2 * i + 2, -2 * i - 1, -2 * i - 2}) word.push_back(letter);
    for (Index i = 1; i <= punctures; ++i) {
        const Index letter = (2 * genus + i) * (random.below(2) == 0 ? 1 : -1);
        word.insert(word.begin() + random.below(static_cast<std::ptrdiff_t>(word.size()) + 1), letter);
    }
    for (Index move = 0; move < 20 * genus; ++move) {
        std::rotate(word.begin(), word.begin() + random.below(static_cast<std::ptrdiff_t>(word.size())),
                    word.end());
        const auto end = std::find(word.begin(), word.end(), -word[0]);
        if (end == word.end() || end - word.begin() < 3) continue;
        std::rotate(word.begin() + 1, word.begin() + 1 + random.below(end - word.begin() - 1), end);
    }
    return word;
}

/// Generators in the order of their numbers.
std::vector<Word> generators_of(const CanonicalBasis& basis) {
    std::vector<Word> words;
    for (std::size_t i = 0; i < basis.a.size(); ++i) {
        words.push_back(basis.a[i]);
        words.push_back(basis.b[i]);
    }
    words.insert(words.end(), basis.punctures.begin(), basis.punctures.end());
    return words;
}

/// Substituting generators into letters and letters into generators is the identity of the free group.
/// Returns the length of the longest letter.
std::size_t expect_inverse(const CanonicalBasis& basis) {
    const std::vector<Word> generators = generators_of(basis);
    EXPECT_EQ(basis.letters.size(), generators.size());
    std::size_t longest = 0;
    for (std::size_t k = 0; k < generators.size(); ++k) {
        EXPECT_EQ(in_canonical_generators(basis, generators[k], false), Word{static_cast<Index>(k) + 1});
        Word back;
        for (const Index letter : basis.letters[k]) {
            const Word& word = generators[at(generator_of(letter))];
            append_reduced(back, letter > 0 ? word : inverse(word));
        }
        EXPECT_EQ(back, Word{static_cast<Index>(k) + 1});
        longest = std::max(longest, basis.letters[k].size());
    }
    return longest;
}

TEST(CanonicalBasis, LeavesTheCanonicalRelatorAlone) {
    const CanonicalBasis basis = make_canonical_basis(Word{1, 2, -1, -2, 3, 4, -3, -4}, 4, 0);
    EXPECT_EQ(basis.a, (std::vector<Word>{{1}, {3}}));
    EXPECT_EQ(basis.b, (std::vector<Word>{{2}, {4}}));
    EXPECT_EQ(basis.names(), (std::vector<std::string>{"a1", "b1", "a2", "b2"}));
    EXPECT_EQ(basis.longest(), 1u);
    EXPECT_EQ(basis.letters, (std::vector<Word>{{1}, {2}, {3}, {4}}));
}

TEST(CanonicalBasis, LettersAreWordsInTheGenerators) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        expect_inverse(canonical_of(basis_of(surface)));
    }
    Random random(23);
    for (int trial = 0; trial < 300; ++trial) {
        SCOPED_TRACE(trial);
        const Index genus = random.below(9), punctures = random.below(6);
        expect_inverse(make_canonical_basis(random_relator(genus, punctures, random), 2 * genus, punctures));
    }
}

TEST(CanonicalBasis, ClosedCurvesAreReducedCyclicallyAndByTheRelator) {
    const CanonicalBasis basis = make_canonical_basis(Word{1, 2, -1, -2, 3, 4, -3, -4}, 4, 0);
    EXPECT_EQ(in_canonical_generators(basis, Word{1, 2, -1}), Word{2});
    EXPECT_EQ(in_canonical_generators(basis, Word{1, 2, -1, -2, 3}), Word{3});
    EXPECT_EQ(in_canonical_generators(basis, Word{1, 2, -1}, false), (Word{1, 2, -1}));
    EXPECT_TRUE(in_canonical_generators(basis, Word{}).empty());
    EXPECT_THROW(in_canonical_generators(basis, Word{5}), std::invalid_argument);
}

TEST(CanonicalBasis, ProductIsConjugateToTheRelator) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const HomotopyBasis basis = basis_of(surface);
        const CanonicalBasis canonical = canonical_of(basis);
        EXPECT_EQ(canonical.genus(), basis.genus());
        EXPECT_EQ(canonical.punctures.size(), at(basis.punctures()));
        EXPECT_TRUE(are_conjugate(canonical.product(), basis.relator()));
    }
}

TEST(CanonicalBasis, ProductIsConjugateToRandomRelators) {
    Random random(17);
    for (int trial = 0; trial < 300; ++trial) {
        const Index genus = random.below(9), punctures = random.below(6);
        const Word relator = random_relator(genus, punctures, random);
        const CanonicalBasis basis = make_canonical_basis(relator, 2 * genus, punctures);
        EXPECT_EQ(basis.genus(), genus);
        std::vector<std::uint8_t> met(at(punctures), 0);
        for (std::size_t i = 0; i < basis.punctures.size(); ++i) {
            const Index letter = basis.puncture_letter(i);
            EXPECT_EQ(cyclically_reduced(basis.punctures[i]), Word{letter});
            EXPECT_EQ(std::ranges::count(relator, letter), 1);
            EXPECT_EQ(met[at(generator_of(letter) - 2 * genus)]++, 0);
        }
        EXPECT_TRUE(are_conjugate(basis.product(), relator)) << "trial " << trial;
    }
}

TEST(CanonicalBasis, ManagesManyHandlesAndPunctures) {
    Random random(19);
    const Word relator = random_relator(150, 100, random);
    const CanonicalBasis basis = make_canonical_basis(relator, 300, 100);
    EXPECT_TRUE(are_conjugate(basis.product(), relator));
    RecordProperty("longest_word", static_cast<int>(basis.longest()));
    RecordProperty("longest_letter", static_cast<int>(expect_inverse(basis)));
}

TEST(CanonicalBasis, IntersectsAsTheStandardForm) {
    for (const TestSurface& surface : test_surfaces()) {
        SCOPED_TRACE(surface.name);
        const HomotopyBasis basis = basis_of(surface);
        const CanonicalBasis canonical = canonical_of(basis);
        const testing::Intersections intersections(surface.connectivity);
        std::vector<EdgePath> walks;
        for (std::size_t i = 0; i < canonical.a.size(); ++i) {
            walks.push_back(basis.walk(canonical.a[i]));
            walks.push_back(basis.walk(canonical.b[i]));
        }
        for (std::size_t p = 0; p < walks.size(); ++p)
            for (std::size_t q = 0; q < walks.size(); ++q) {
                const Index expected = p / 2 != q / 2 || p == q ? 0 : (p < q ? 1 : -1);
                EXPECT_EQ(intersections.number(walks[p], walks[q]), expected) << p << " . " << q;
            }
    }
}

TEST(CanonicalBasis, RefusesOtherWords) {
    EXPECT_THROW(make_canonical_basis(Word{1, -1, 2, -2}, 2, 0), std::invalid_argument) << "two vertices";
    EXPECT_THROW(make_canonical_basis(Word{1, 2, 1, -2}, 2, 0), std::invalid_argument) << "not orientable";
    EXPECT_THROW(make_canonical_basis(Word{1, 2, -1, -2}, 2, 1), std::invalid_argument) << "no puncture";
    EXPECT_THROW(make_canonical_basis(Word{1, 2, -1, -2, 3}, 2, 0), std::invalid_argument);
    EXPECT_THROW(make_canonical_basis(Word{0}, 0, 1), std::invalid_argument);
    EXPECT_THROW(make_canonical_basis(Word{1, -1}, 1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
