#include "engine/topology/canonical_basis.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Part of the cyclic word that is no longer cut: a handle [a,b] with words a, b, or a puncture with one
/// word.
struct Block {
    std::vector<Word> words;

    [[nodiscard]] bool is_handle() const { return words.size() == 2; }
    /// The element it stands for.
    [[nodiscard]] Word value() const { return is_handle() ? commutator(words[0], words[1]) : words[0]; }
    void conjugate(std::span<const Index> by) {
        for (Word& word : words) word = conjugated(word, by);
    }
};

/// An element of the cyclic word: a letter or a block.
struct Item {
    Index letter = 0;  // 0: a block
    Index block = -1;  // its number
};

/// x at `first`, y at `second`, x^-1 at `third`, y^-1 at `fourth`, in cyclic order.
struct LinkedPair {
    std::size_t first = 0, second = 0, third = 0, fourth = 0;
    std::size_t cost = std::numeric_limits<std::size_t>::max();
};

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

/// The letters among items[begin, end).
Word letters_of(const std::vector<Item>& items, std::size_t begin, std::size_t end) {
    Word word;
    for (std::size_t i = begin; i < end; ++i) {
        if (items[i].letter != 0) word.push_back(items[i].letter);
    }
    return word;
}

class PolygonReducer {
  public:
    /// Punctures are blocks from the start, or letters that may enter the words of handles.
    PolygonReducer(const Word& relator, Index loops, bool puncture_blocks) : loops_(loops) {
        for (const Index letter : relator) {
            if (generator_of(letter) < loops || !puncture_blocks) {
                items_.push_back({letter, -1});
            } else {
                add_block({{Word{letter}}}, items_);
            }
        }
    }

    /// The blocks in order, when no handle letters are left.
    std::vector<Block> reduce() {
        for (Index made = 0; 2 * made < loops_; ++made) {
            index_items();
            const LinkedPair pair = cheapest_pair();
            if (pair.cost == std::numeric_limits<std::size_t>::max())
                throw std::invalid_argument("canonical basis: the polygon has more than one vertex");
            make_handle(pair);
        }
        start_with_first_handle();
        std::vector<Block> ordered;
        for (const Item& item : items_)
            ordered.push_back(item.letter != 0 ? Block{{Word{item.letter}}}
                                               : std::move(blocks_[at(item.block)]));
        return ordered;
    }

  private:
    [[nodiscard]] bool handle_letter(std::size_t i) const {
        return items_[i].letter != 0 && generator_of(items_[i].letter) < loops_;
    }

    void start_with_first_handle() {
        const Index first =
            static_cast<Index>(blocks_.size()) - loops_ / 2;  // blocks of punctures come before
        const auto found = std::find_if(items_.begin(), items_.end(),
                                        [first](const Item& item) { return item.block == first; });
        if (found != items_.end()) std::rotate(items_.begin(), found, items_.end());
    }

    void add_block(Block block, std::vector<Item>& items) {
        items.push_back({0, static_cast<Index>(blocks_.size())});
        blocks_.push_back(std::move(block));
    }

    /// Where the inverse of each handle letter stands, and how many letters stand before each item, once
    /// around and once again.
    void index_items() {
        const std::size_t n = items_.size();
        partner_.assign(n, n);
        before_.assign(2 * n + 1, 0);
        std::vector<std::size_t> seen(at(loops_), n);
        for (std::size_t i = 0; i < 2 * n; ++i)
            before_[i + 1] = before_[i] + (items_[i % n].letter != 0 ? 1 : 0);
        for (std::size_t i = 0; i < n; ++i) {
            if (!handle_letter(i)) continue;
            std::size_t& other = seen[at(generator_of(items_[i].letter))];
            if (other != n) {
                partner_[i] = other;
                partner_[other] = i;
            }
            other = i;
        }
        index_blocks();
    }

    void index_blocks() {
        const std::size_t n = items_.size();
        words_below_.assign(before_.back() + 2, 0);
        place_sum_.assign(before_.back() + 2, 0);
        for (std::size_t i = 0; i < 2 * n; ++i) {
            const Item& item = items_[i % n];
            if (item.letter != 0) continue;
            const std::size_t words = blocks_[at(item.block)].words.size();
            words_below_[before_[i] + 1] += words;
            place_sum_[before_[i] + 1] += words * before_[i];
        }
        std::partial_sum(words_below_.begin(), words_below_.end(), words_below_.begin());
        std::partial_sum(place_sum_.begin(), place_sum_.end(), place_sum_.begin());
    }

    /// Letters strictly between two places, begin < end in places counted on from the first lap.
    [[nodiscard]] std::size_t gap(std::size_t begin, std::size_t end) const {
        return before_[end] - before_[begin + 1];
    }

    /// Letters that moving the blocks out of [first, fourth] adds, on both sides of each of their words.
    [[nodiscard]] std::size_t moving_cost(std::size_t first, std::size_t fourth) const {
        const std::size_t low = before_[first], high = before_[fourth + 1], middle = (low + high) / 2 + 1;
        const std::size_t to_left =
            (place_sum_[middle] - place_sum_[low + 1]) - low * (words_below_[middle] - words_below_[low + 1]);
        const std::size_t to_right =
            high * (words_below_[high] - words_below_[middle]) - (place_sum_[high] - place_sum_[middle]);
        return 2 * (to_left + to_right);
    }

    void consider(std::size_t i, std::size_t j, std::size_t pi, std::size_t pj, LinkedPair& best) const {
        const std::size_t a = gap(i, j), b = gap(j, pi), c = gap(pi, pj);
        std::size_t cost = a + b + c + std::min(a, b);
        if (cost >= best.cost) return;
        cost += moving_cost(i, pj);
        if (cost < best.cost) best = {i, j, pi, pj, cost};
    }

    [[nodiscard]] LinkedPair cheapest_pair() const {
        const std::size_t n = items_.size();
        LinkedPair best;
        for (std::size_t i = 0; i < n; ++i) {
            if (!handle_letter(i)) continue;
            const std::size_t pi = partner_[i] > i ? partner_[i] : partner_[i] + n;
            for (std::size_t j = i + 1; j < pi; ++j) {
                if (!handle_letter(j % n)) continue;
                std::size_t pj = partner_[j % n];
                if (pj < i) pj += n;
                if (pj > pi) consider(i, j, pi, pj, best);
            }
        }
        return best;
    }

    /// Replaces the pair by its handle; blocks in its gaps go to the nearer side.
    void make_handle(const LinkedPair& pair) {
        std::rotate(items_.begin(), items_.begin() + static_cast<std::ptrdiff_t>(pair.first), items_.end());
        const std::size_t y = pair.second - pair.first, x_inverse = pair.third - pair.first,
                          end = pair.fourth - pair.first + 1;
        const Word gap_a = letters_of(items_, 1, y), gap_b = letters_of(items_, y + 1, x_inverse),
                   gap_c = letters_of(items_, x_inverse + 1, end - 1);
        std::vector<Item> result, right;
        slide_apart(end, result, right);
        const auto append = [&result](const Word& word) {
            for (const Index letter : word) result.push_back({letter, -1});
        };
        append(gap_c);
        add_block(handle_of(gap_a, gap_b, gap_c, items_[0].letter, items_[y].letter), result);
        append(gap_b);
        append(gap_a);
        result.insert(result.end(), right.begin(), right.end());
        result.insert(result.end(), items_.begin() + static_cast<std::ptrdiff_t>(end), items_.end());
        items_ = std::move(result);
    }

    static Block handle_of(const Word& gap_a, const Word& gap_b, const Word& gap_c, Index x, Index y) {
        Word a = product(inverse(gap_c), Word{x}), b = product(gap_b, gap_a);
        if (gap_a.size() < gap_b.size()) {
            append_reduced(a, gap_a);
            append_reduced(a, Word{y});
        } else {
            append_reduced(a, inverse(gap_b));
        }
        append_reduced(b, Word{y});
        return {{std::move(a), std::move(b)}};
    }

    /// Moves the blocks among the first `end` items out to the nearer side: z H = (z H z^-1) z and
    /// H z = z (z^-1 H z).
    void slide_apart(std::size_t end, std::vector<Item>& left, std::vector<Item>& right) {
        const Word letters = letters_of(items_, 0, end);
        std::size_t before = 0;
        for (std::size_t i = 0; i < end; ++i) {
            if (items_[i].letter != 0) {
                ++before;
                continue;
            }
            const std::span<const Index> word(letters);
            const bool to_left = 2 * before <= letters.size();
            if (to_left) {
                blocks_[at(items_[i].block)].conjugate(word.first(before));
            } else {
                blocks_[at(items_[i].block)].conjugate(inverse(word.subspan(before)));
            }
            (to_left ? left : right).push_back(items_[i]);
        }
    }

    Index loops_;
    std::vector<Item> items_;
    std::vector<Block> blocks_;
    std::vector<std::size_t> partner_;  // items
    std::vector<std::size_t> before_;   // 2 * items + 1
    // A block's place is the number of letters before it. Of the blocks at places below each number, how many
    // words they have, and the sum of their places, counted once per word. // 2 * letters + 2
    std::vector<std::size_t> words_below_, place_sum_;
};

/// Brings the blocks of one kind together by moving them past the others, which keep their words.
class BlockGatherer {
  public:
    BlockGatherer(std::vector<Block> blocks, bool move_handles)
        : blocks_(std::move(blocks)), move_handles_(move_handles), passed_(blocks_.size() + 1, 0) {}

    CanonicalBasis gather() {
        rotate_to_cheapest();
        const std::size_t total = passed_.back();
        std::vector<Word> ahead(blocks_.size() + 1);  // product of the blocks that stay, from each place on
        for (std::size_t i = blocks_.size(); i > 0; --i)
            ahead[i - 1] = moves(i - 1) ? ahead[i] : product(blocks_[i - 1].value(), ahead[i]);
        Word behind;
        CanonicalBasis right, left;
        for (std::size_t i = 0; i < blocks_.size(); ++i) {
            const bool to_left = moves(i) && 2 * passed_[i] <= total;
            if (!moves(i)) {
                append_reduced(behind, blocks_[i].value());
            } else {
                blocks_[i].conjugate(to_left ? behind : inverse(ahead[i]));
            }
            append(to_left ? left : right, blocks_[i]);
        }
        for (std::size_t i = 0; i < left.a.size(); ++i) append(right, Block{{left.a[i], left.b[i]}});
        for (const Word& word : left.punctures) append(right, Block{{word}});
        return right;
    }

  private:
    [[nodiscard]] bool moves(std::size_t i) const { return blocks_[i].is_handle() == move_handles_; }

    static void append(CanonicalBasis& basis, const Block& block) {
        if (block.is_handle()) {
            basis.a.push_back(block.words[0]);
            basis.b.push_back(block.words[1]);
        } else {
            basis.punctures.push_back(block.words[0]);
        }
    }

    /// Starts the cyclic order where the distances to the nearer end, in letters passed, have the least sum;
    /// among equals with the block that comes first. Leaves in passed_ the letters before each block.
    void rotate_to_cheapest() {
        const std::size_t n = blocks_.size();
        std::vector<std::size_t> size(n);
        for (std::size_t i = 0; i < n; ++i) size[i] = moves(i) ? 0 : blocks_[i].value().size();
        const std::size_t total = std::accumulate(size.begin(), size.end(), std::size_t{0});
        std::size_t best = 0, least = std::numeric_limits<std::size_t>::max();
        for (std::size_t start = 0; start < n; ++start) {
            std::size_t cost = 0, before = 0;
            for (std::size_t k = 0; k < n; ++k) {
                const std::size_t i = (start + k) % n;
                if (moves(i)) cost += std::min(before, total - before);
                before += size[i];
            }
            if (cost < least) {
                least = cost;
                best = start;
            }
        }
        const auto first = static_cast<std::ptrdiff_t>(best);
        std::rotate(blocks_.begin(), blocks_.begin() + first, blocks_.end());
        std::rotate(size.begin(), size.begin() + first, size.end());
        std::partial_sum(size.begin(), size.end(), passed_.begin() + 1);
    }

    std::vector<Block> blocks_;
    bool move_handles_;
    std::vector<std::size_t> passed_;  // blocks + 1
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

CanonicalBasis make_canonical_basis(const Word& relator, Index loops, Index punctures) {
    check_letters(relator, loops, punctures);
    CanonicalBasis best;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const bool puncture_blocks : {true, false}) {
        const std::vector<Block> blocks = PolygonReducer(relator, loops, puncture_blocks).reduce();
        for (const bool move_handles : {true, false}) {
            CanonicalBasis basis = BlockGatherer(blocks, move_handles).gather();
            if (basis.longest() >= least) continue;
            least = basis.longest();
            best = std::move(basis);
        }
        if (punctures == 0) break;
    }
    return best;
}

}  // namespace ricci
