#include "engine/topology/words.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/random.h"

namespace ricci {
namespace {

using testing::Random;

Word random_word(Random& random, Index length) {
    Word word;
    for (Index i = 0; i < length; ++i)
        word.push_back((random.below(3) + 1) * (random.below(2) == 0 ? 1 : -1));
    return word;
}

TEST(Words, FreeReduction) {
    EXPECT_EQ(reduced(Word{1, 2, -2, -1}), Word{});
    EXPECT_EQ(reduced(Word{1, 2, -2, 1, -3}), (Word{1, 1, -3}));
    EXPECT_EQ(cyclically_reduced(Word{3, 1, 2, -3, 3, -3}), (Word{1, 2}));
    EXPECT_EQ(cyclically_reduced(Word{}), Word{});
    EXPECT_EQ(inverse(Word{1, -2, 3}), (Word{-3, 2, -1}));
    EXPECT_EQ(commutator(Word{1}, Word{2}), (Word{1, 2, -1, -2}));
}

TEST(Words, AreAGroup) {
    Random random(3);
    for (int trial = 0; trial < 200; ++trial) {
        const Word u = random_word(random, random.below(9)), v = random_word(random, random.below(9)),
                   w = random_word(random, random.below(9));
        EXPECT_EQ(product(product(u, v), w), product(u, product(v, w)));
        EXPECT_EQ(product(u, inverse(u)), Word{});
        EXPECT_EQ(inverse(product(u, v)), product(inverse(v), inverse(u)));
        EXPECT_EQ(conjugated(product(u, v), w), product(conjugated(u, w), conjugated(v, w)));
        EXPECT_TRUE(are_conjugate(conjugated(u, w), u));
        EXPECT_TRUE(are_conjugate(product(u, v), product(v, u)));
    }
}

TEST(Words, TellConjugacyClassesApart) {
    EXPECT_FALSE(are_conjugate(Word{1, 2, -1, -2}, Word{2, 1, -2, -1}));
    EXPECT_FALSE(are_conjugate(Word{1, 1, 2}, Word{1, 2}));
    EXPECT_FALSE(are_conjugate(Word{1}, Word{-1}));
}

TEST(Words, AsText) {
    const std::vector<std::string> names = {"a1", "b1"};
    EXPECT_EQ(to_text(Word{1, -2, 1}, names), "a1 b1^-1 a1");
    EXPECT_EQ(to_text(Word{}, names), "1");
    EXPECT_THROW(to_text(Word{3}, names), std::invalid_argument);
    EXPECT_THROW(to_text(Word{0}, names), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
