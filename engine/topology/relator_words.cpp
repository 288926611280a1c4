#include "engine/topology/relator_words.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

Word relator_of(Index genus, Index punctures) {
    Word relator;
    for (Index i = 0; i < genus; ++i)
        for (const Index letter : {2 * i + 1, 2 * i + 2, -2 * i - 1, -2 * i - 2}) relator.push_back(letter);
    for (Index j = 0; j < punctures; ++j) relator.push_back(2 * genus + j + 1);
    return relator;
}

/// a1^p b1^q.
Word torus_word(std::span<const Index> word) {
    Word result;
    for (const Index k : {1, 2}) {
        const auto exponent = std::ranges::count(word, k) - std::ranges::count(word, -k);
        result.insert(result.end(), static_cast<std::size_t>(std::abs(exponent)), exponent < 0 ? -k : k);
    }
    return result;
}

/// Replaces long stretches of one relator in cyclic words.
class Shortener {
  public:
    Shortener(Index genus, Index punctures)
        : relator_(relator_of(genus, punctures)), place_(2 * at(2 * genus + punctures), -1) {
        for (std::size_t i = 0; i < relator_.size(); ++i) place_[code(relator_[i])] = static_cast<Index>(i);
    }

    /// Replaces one stretch; false where there is none.
    bool shorten(Word& word) const {
        for (std::size_t i = 0; i < word.size(); ++i) {
            const Index place = place_[code(word[i])];
            if (place < 0) continue;
            const std::size_t stretch = matching(word, i, at(place));
            if (2 * stretch <= relator_.size()) continue;
            std::rotate(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(i), word.end());
            Word rest;  // of the relator
            for (std::size_t k = stretch; k < relator_.size(); ++k)
                rest.push_back(relator_[(at(place) + k) % relator_.size()]);
            word = cyclically_reduced(product(inverse(rest), std::span<const Index>(word).subspan(stretch)));
            return true;
        }
        return false;
    }

    /// Number of a signed letter among all.
    static std::size_t code(Index letter) { return 2 * at(generator_of(letter)) + (letter > 0 ? 0 : 1); }

  private:
    [[nodiscard]] std::size_t matching(const Word& word, std::size_t start, std::size_t place) const {
        const std::size_t most = std::min(word.size(), relator_.size());
        std::size_t k = 0;
        while (k < most && word[(start + k) % word.size()] == relator_[(place + k) % relator_.size()]) ++k;
        return k;
    }

    Word relator_;
    std::vector<Index> place_;  // per signed letter, in the relator, or -1
};

}  // namespace

Word shortened_by_relator(Index genus, Index punctures, std::span<const Index> word) {
    for (const Index letter : word)
        if (letter == 0 || generator_of(letter) >= 2 * genus + punctures)
            throw std::invalid_argument("letter " + std::to_string(letter) + " is no canonical generator");
    if (genus == 1 && punctures == 0) return torus_word(word);
    const Shortener shortener(genus, punctures);
    Word result = cyclically_reduced(word);
    for (;;) {
        while (shortener.shorten(result)) {
        }
        // Stretches of the inverse relator are stretches of the relator in the inverse word.
        Word back = inverse(result);
        if (!shortener.shorten(back)) return result;
        result = inverse(back);
    }
}

}  // namespace ricci
