#include "engine/topology/canonical_basis.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "engine/topology/polygon_reducer.h"
#include "engine/topology/relator_words.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

void check_letters(const Word& relator, Index loops, Index punctures) {
    if (loops < 0 || loops % 2 != 0 || punctures < 0)
        throw std::invalid_argument("canonical basis: the number of handle letters must be even");
    std::vector<Index> plus(at(loops + punctures), 0), minus(at(loops + punctures), 0);
    for (const Index letter : relator) {
        const Index k = generator_of(letter);
        if (k < 0 || k >= loops + punctures)
            throw std::invalid_argument("canonical basis: letter " + std::to_string(letter) +
                                        " is out of range");
        ++(letter > 0 ? plus : minus)[at(k)];
    }
    for (Index k = 0; k < loops + punctures; ++k) {
        const bool fits = k < loops ? plus[at(k)] == 1 && minus[at(k)] == 1 : plus[at(k)] + minus[at(k)] == 1;
        if (!fits)
            throw std::invalid_argument("canonical basis: letter " + std::to_string(k + 1) +
                                        " does not occur as often as it must");
    }
}

/// A block where it comes to stand among the canonical generators.
struct PlacedBlock {
    PolygonBlock block;    // its words are the generators
    Index generator = -1;  // number of the first
    bool stays = true;
    bool to_left = false;  // moved past the blocks before it, else past those behind it
};

/// Brings the blocks of one kind together by moving them past the others, which keep their words.
class BlockGatherer {
  public:
    BlockGatherer(const std::vector<PolygonBlock>& blocks, bool move_handles)
        : passed_(blocks.size() + 1, 0) {
        for (const PolygonBlock& block : blocks)
            placed_.push_back({block, -1, block.is_handle() != move_handles, false});
    }

    /// In their cyclic order, from where it is cheapest to cut it.
    std::vector<PlacedBlock> gather() {
        rotate_to_cheapest();
        const std::size_t total = passed_.back();
        std::vector<Word> ahead(placed_.size() + 1);  // product of the blocks that stay, from each place on
        for (std::size_t i = placed_.size(); i > 0; --i)
            ahead[i - 1] = placed_[i - 1].stays ? product(placed_[i - 1].block.value(), ahead[i]) : ahead[i];
        Word behind;
        for (std::size_t i = 0; i < placed_.size(); ++i) {
            PlacedBlock& here = placed_[i];
            here.to_left = !here.stays && 2 * passed_[i] <= total;
            if (here.stays) {
                append_reduced(behind, here.block.value());
                continue;
            }
            const Word by = here.to_left ? behind : inverse(ahead[i]);
            for (Word& word : here.block.words) word = conjugated(word, by);
        }
        number();
        return std::move(placed_);
    }

  private:
    /// Those that stayed or moved to the right, then those that moved to the left end, which is the right one
    /// of the cyclic word.
    void number() {
        Index handles = 0, punctures = 0;
        for (const PlacedBlock& here : placed_) handles += here.block.is_handle() ? 1 : 0;
        Index next_handle = 0;
        for (const bool left : {false, true})
            for (PlacedBlock& here : placed_)
                if (here.to_left == left)
                    here.generator = here.block.is_handle() ? 2 * next_handle++ : 2 * handles + punctures++;
    }

    /// Starts the cyclic order where the distances to the nearer end, in letters passed, have the least sum;
    /// among equals with the block that comes first. Leaves in passed_ the letters before each block.
    void rotate_to_cheapest() {
        const std::size_t n = placed_.size();
        std::vector<std::size_t> size(n);
        for (std::size_t i = 0; i < n; ++i) size[i] = placed_[i].stays ? placed_[i].block.value().size() : 0;
        const std::size_t total = std::accumulate(size.begin(), size.end(), std::size_t{0});
        std::size_t best = 0, least = std::numeric_limits<std::size_t>::max();
        for (std::size_t start = 0; start < n; ++start) {
            std::size_t cost = 0, before = 0;
            for (std::size_t k = 0; k < n; ++k) {
                const std::size_t i = (start + k) % n;
                if (!placed_[i].stays) cost += std::min(before, total - before);
                before += size[i];
            }
            if (cost < least) {
                least = cost;
                best = start;
            }
        }
        const auto first = static_cast<std::ptrdiff_t>(best);
        std::rotate(placed_.begin(), placed_.begin() + first, placed_.end());
        std::rotate(size.begin(), size.begin() + first, size.end());
        std::partial_sum(size.begin(), size.end(), passed_.begin() + 1);
    }

    std::vector<PlacedBlock> placed_;
    std::vector<std::size_t> passed_;  // blocks + 1
};

/// The reduced word with every letter replaced by its word.
Word substituted(std::span<const Index> word, const std::vector<Word>& words) {
    Word result;
    for (const Index letter : word) {
        const Index k = generator_of(letter);
        if (k < 0 || at(k) >= words.size())
            throw std::invalid_argument("canonical basis: letter " + std::to_string(letter) +
                                        " is out of range");
        append_reduced(result, letter > 0 ? words[at(k)] : inverse(words[at(k)]));
    }
    return result;
}

/// Generators in the order of their numbers.
CanonicalBasis basis_of(const std::vector<PlacedBlock>& placed) {
    CanonicalBasis basis;
    std::vector<const PlacedBlock*> order;
    order.reserve(placed.size());
    for (const PlacedBlock& here : placed) order.push_back(&here);
    std::ranges::sort(order, {}, &PlacedBlock::generator);
    for (const PlacedBlock* here : order) {
        const std::vector<Word>& words = here->block.words;
        if (here->block.is_handle()) {
            basis.a.push_back(words[0]);
            basis.b.push_back(words[1]);
        } else {
            basis.punctures.push_back(words[0]);
        }
    }
    return basis;
}

/// The moves of make_canonical_basis undone: basis letters as words in canonical generators.
class LetterWords {
  public:
    LetterWords(const std::vector<PlacedBlock>& placed, std::size_t letters) : words_(letters) {
        std::vector<std::size_t> order(placed.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        // The handle that was made last has no letters in its gaps but those of punctures that are letters.
        std::ranges::stable_sort(order, [&](std::size_t i, std::size_t j) {
            return rank(placed[i].block) > rank(placed[j].block);
        });
        find_moves(placed);
        for (const std::size_t i : order) undo(placed[i], moves_[i]);
    }

    [[nodiscard]] std::vector<Word> take() { return std::move(words_); }

  private:
    /// Punctures that were letters to the end come first, those that were blocks last.
    static Index rank(const PolygonBlock& block) {
        if (block.is_handle()) return block.made;
        return block.moved.empty() ? std::numeric_limits<Index>::max() : -1;
    }

    /// By which the gathering conjugated each block.
    void find_moves(const std::vector<PlacedBlock>& placed) {
        moves_.resize(placed.size());
        Word behind, ahead;
        for (std::size_t i = 0; i < placed.size(); ++i) {
            if (placed[i].to_left) moves_[i] = behind;
            if (placed[i].stays) append_reduced(behind, value(placed[i]));
        }
        for (std::size_t i = placed.size(); i > 0; --i) {
            const PlacedBlock& here = placed[i - 1];
            if (here.stays) ahead = product(value(here), ahead);
            if (!here.stays && !here.to_left) moves_[i - 1] = inverse(ahead);
        }
    }

    static Word value(const PlacedBlock& here) {
        const Index first = here.generator + 1;
        return here.block.is_handle() ? Word{first, first + 1, -first, -first - 1} : Word{first};
    }

    void set(Index letter, const Word& word) {
        words_[at(generator_of(letter))] = letter > 0 ? word : inverse(word);
    }

    void undo(const PlacedBlock& here, const Word& move) {
        // A generator w u w^-1, w = move moved, as u was when the block was made.
        const Word back = product(inverse(substituted(here.block.moved, words_)), inverse(move));
        const auto original = [&](Index k) { return conjugated(Word{here.generator + 1 + k}, back); };
        if (!here.block.is_handle()) {
            const Index letter = here.block.words[0][here.block.words[0].size() / 2];
            set(letter, original(0));
            return;
        }
        const HandleCut& cut = here.block.cut;
        const Word a = original(0), b = original(1), gap_b = substituted(cut.gap_b, words_);
        set(cut.y, product(inverse(substituted(product(cut.gap_b, cut.gap_a), words_)), b));
        Word x = product(substituted(cut.gap_c, words_), a);
        if (cut.along_y) append_reduced(x, inverse(b));
        append_reduced(x, gap_b);
        set(cut.x, x);
    }

    std::vector<Word> words_;  // per letter, empty until known
    std::vector<Word> moves_;  // per block
};

}  // namespace

Word CanonicalBasis::product() const {
    Word word;
    for (std::size_t i = 0; i < a.size(); ++i) append_reduced(word, commutator(a[i], b[i]));
    for (const Word& puncture : punctures) append_reduced(word, puncture);
    return word;
}

std::size_t CanonicalBasis::longest() const {
    std::size_t longest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) longest = std::max({longest, a[i].size(), b[i].size()});
    for (const Word& puncture : punctures) longest = std::max(longest, puncture.size());
    return longest;
}

std::vector<std::string> CanonicalBasis::names() const {
    std::vector<std::string> names;
    for (Index i = 1; i <= genus(); ++i) {
        names.push_back("a" + std::to_string(i));
        names.push_back("b" + std::to_string(i));
    }
    return names;
}

Word in_canonical_generators(const CanonicalBasis& basis, std::span<const Index> word, bool closed) {
    const Word result = substituted(word, basis.letters);
    return closed ? shortened_by_relator(basis.genus(), static_cast<Index>(basis.punctures.size()), result)
                  : result;
}

CanonicalBasis make_canonical_basis(const Word& relator, Index loops, Index punctures) {
    check_letters(relator, loops, punctures);
    CanonicalBasis best;
    std::vector<PlacedBlock> placed;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const bool puncture_blocks : {true, false}) {
        const std::vector<PolygonBlock> blocks = reduce_polygon(relator, loops, puncture_blocks);
        for (const bool move_handles : {true, false}) {
            std::vector<PlacedBlock> gathered = BlockGatherer(blocks, move_handles).gather();
            CanonicalBasis basis = basis_of(gathered);
            if (basis.longest() >= least) continue;
            least = basis.longest();
            best = std::move(basis);
            placed = std::move(gathered);
        }
        if (punctures == 0) break;
    }
    best.letters = LetterWords(placed, at(loops + punctures)).take();
    return best;
}

}  // namespace ricci
