#include "engine/topology/words.h"

#include <algorithm>
#include <stdexcept>

namespace ricci {

Word inverse(std::span<const Index> word) {
    Word result(word.rbegin(), word.rend());
    for (Index& letter : result) letter = -letter;
    return result;
}

void append_reduced(Word& word, std::span<const Index> tail) {
    for (const Index letter : tail) {
        if (!word.empty() && word.back() == -letter) {
            word.pop_back();
        } else {
            word.push_back(letter);
        }
    }
}

Word reduced(std::span<const Index> word) {
    Word result;
    append_reduced(result, word);
    return result;
}

Word cyclically_reduced(std::span<const Index> word) {
    const Word free = reduced(word);
    std::size_t begin = 0, end = free.size();
    while (end - begin > 1 && free[begin] == -free[end - 1]) {
        ++begin;
        --end;
    }
    return {free.begin() + static_cast<std::ptrdiff_t>(begin),
            free.begin() + static_cast<std::ptrdiff_t>(end)};
}

Word product(std::span<const Index> first, std::span<const Index> second) {
    Word result = reduced(first);
    append_reduced(result, second);
    return result;
}

Word conjugated(std::span<const Index> word, std::span<const Index> by) {
    Word result = product(by, word);
    append_reduced(result, inverse(by));
    return result;
}

Word commutator(std::span<const Index> a, std::span<const Index> b) {
    Word result = product(a, b);
    append_reduced(result, inverse(a));
    append_reduced(result, inverse(b));
    return result;
}

bool are_conjugate(std::span<const Index> first, std::span<const Index> second) {
    const Word a = cyclically_reduced(first), b = cyclically_reduced(second);
    if (a.size() != b.size()) return false;
    if (a.empty()) return true;
    Word twice = a;  // every rotation of a is a stretch of a a
    twice.insert(twice.end(), a.begin(), a.end());
    return std::search(twice.begin(), twice.end(), b.begin(), b.end()) != twice.end();
}

std::string to_text(std::span<const Index> word, std::span<const std::string> names) {
    if (word.empty()) return "1";
    std::string text;
    for (const Index letter : word) {
        const Index k = generator_of(letter);
        if (k < 0 || static_cast<std::size_t>(k) >= names.size())
            throw std::invalid_argument("to_text: letter " + std::to_string(letter) + " has no name");
        if (!text.empty()) text += ' ';
        text += names[static_cast<std::size_t>(k)];
        if (letter < 0) text += "^-1";
    }
    return text;
}

}  // namespace ricci
