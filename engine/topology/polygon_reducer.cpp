#include "engine/topology/polygon_reducer.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

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
                add_block(puncture(letter), items_);
            }
        }
    }

    /// The blocks in order, when no handle letters are left.
    std::vector<PolygonBlock> reduce() {
        for (Index made = 0; 2 * made < loops_; ++made) {
            index_items();
            const LinkedPair pair = cheapest_pair();
            if (pair.cost == std::numeric_limits<std::size_t>::max())
                throw std::invalid_argument("canonical basis: the polygon has more than one vertex");
            make_handle(pair);
        }
        start_with_first_handle();
        std::vector<PolygonBlock> ordered;
        for (const Item& item : items_)
            ordered.push_back(item.letter != 0 ? puncture(item.letter) : std::move(blocks_[at(item.block)]));
        return ordered;
    }

  private:
    static PolygonBlock puncture(Index letter) { return {{Word{letter}}, {}, -1, {}}; }

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

    void add_block(PolygonBlock block, std::vector<Item>& items) {
        const auto number = static_cast<Index>(blocks_.size());
        items.push_back({0, number});
        if (block.is_handle()) block.made = number;
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

    static PolygonBlock handle_of(const Word& gap_a, const Word& gap_b, const Word& gap_c, Index x, Index y) {
        Word a = product(inverse(gap_c), Word{x}), b = product(gap_b, gap_a);
        const bool along_y = gap_a.size() < gap_b.size();
        if (along_y) {
            append_reduced(a, gap_a);
            append_reduced(a, Word{y});
        } else {
            append_reduced(a, inverse(gap_b));
        }
        append_reduced(b, Word{y});
        return {{std::move(a), std::move(b)}, {x, y, gap_a, gap_b, gap_c, along_y}, -1, {}};
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
    std::vector<PolygonBlock> blocks_;
    std::vector<std::size_t> partner_;  // items
    std::vector<std::size_t> before_;   // 2 * items + 1
    // A block's place is the number of letters before it. Of the blocks at places below each number, how many
    // words they have, and the sum of their places, counted once per word. // 2 * letters + 2
    std::vector<std::size_t> words_below_, place_sum_;
};

}  // namespace

std::vector<PolygonBlock> reduce_polygon(const Word& relator, Index loops, bool puncture_blocks) {
    return PolygonReducer(relator, loops, puncture_blocks).reduce();
}

}  // namespace ricci
