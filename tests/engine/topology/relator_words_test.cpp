#include "engine/topology/relator_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/support/random.h"

namespace ricci {
namespace {

using testing::Random;

Word random_word(Index generators, std::size_t length, Random& random) {
    Word word;
    while (word.size() < length) {
        const Index letter = (1 + random.below(generators)) * (random.below(2) == 0 ? 1 : -1);
        if (word.empty() || word.back() != -letter) word.push_back(letter);
    }
    return word;
}

Word relator(Index genus, Index punctures) {
    Word word;
    for (Index i = 1; i <= 2 * genus; i += 2) append_reduced(word, Word{i, i + 1, -i, -i - 1});
    for (Index j = 1; j <= punctures; ++j) word.push_back(2 * genus + j);
    return word;
}

TEST(RelatorWords, ProductsOfConjugatesOfTheRelatorAreTrivial) {
    Random random(5);
    for (int trial = 0; trial < 200; ++trial) {
        const Index genus = 2 + random.below(4);
        Word word;
        for (Index k = 0; k < 1 + trial % 5; ++k) {
            const Word r = relator(genus, 0);
            const Word by = random_word(2 * genus, static_cast<std::size_t>(random.below(12)), random);
            append_reduced(word, conjugated(random.below(2) == 0 ? r : inverse(r), by));
        }
        EXPECT_TRUE(shortened_by_relator(genus, 0, word).empty()) << "trial " << trial;
    }
}

TEST(RelatorWords, KeepsTheElementUpToConjugation) {
    // The homology class does not change, nor does a word that is short already.
    Random random(6);
    for (int trial = 0; trial < 100; ++trial) {
        const Index genus = random.below(4), punctures = genus < 2 ? 2 + random.below(3) : random.below(4);
        const Index generators = 2 * genus + punctures;
        Word word = random_word(generators, 1 + static_cast<std::size_t>(trial % 9), random);
        const Word first = shortened_by_relator(genus, punctures, word);
        Word longer = word;
        const Word by = random_word(generators, 5, random);
        append_reduced(longer, conjugated(relator(genus, punctures), by));
        const Word second = shortened_by_relator(genus, punctures, longer);
        EXPECT_LE(first.size(), word.size());
        EXPECT_EQ(shortened_by_relator(genus, punctures, first), first);
        for (Index k = 1; k <= 2 * genus; ++k)
            EXPECT_EQ(std::ranges::count(second, k) - std::ranges::count(second, -k),
                      std::ranges::count(word, k) - std::ranges::count(word, -k));
    }
}

TEST(RelatorWords, SpecialCases) {
    EXPECT_EQ(shortened_by_relator(1, 0, Word{2, 1, 2, -1, 1, 1, -2, -2, -2}), (Word{1, 1, -2}));
    EXPECT_EQ(shortened_by_relator(0, 3, Word{1, 2}), Word{-3}) << "two boundaries are the third";
    EXPECT_EQ(shortened_by_relator(2, 0, Word{1, 2, -1, -2, 3}), Word{3}) << "conjugate by the relator";
    EXPECT_EQ(shortened_by_relator(1, 1, Word{1, 2, -1, -2}), Word{-3});
    EXPECT_TRUE(shortened_by_relator(2, 0, Word{}).empty());
    EXPECT_THROW(shortened_by_relator(2, 0, Word{5}), std::invalid_argument);
    EXPECT_THROW(shortened_by_relator(2, 0, Word{0}), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
