#include "io/mesh/formats/coincident.h"

#include <xxhash.h>

#include <bit>

#include "io/mesh/checks/hash_seed.h"

namespace ricci {
namespace {

using Key = std::array<std::uint64_t, 3>;

Key key_of(const Point& point) {
    Key key{};
    for (std::size_t k = 0; k < 3; ++k) key[k] = point[k] == 0.0 ? 0 : std::bit_cast<std::uint64_t>(point[k]);
    return key;
}

}  // namespace

std::vector<Index> first_at_position(std::span<const Point> points,
                                     std::span<const std::uint8_t> considered) {
    const std::size_t slots = std::bit_ceil(2 * points.size() + 1);
    std::vector<Index> table(slots, -1);  // open addressing, linear probing
    std::vector<Index> first(points.size());
    const std::uint64_t seed = hash_seed();
    for (std::size_t i = 0; i < points.size(); ++i) {
        first[i] = static_cast<Index>(i);
        if (!considered.empty() && considered[i] == 0) continue;
        const Key key = key_of(points[i]);
        std::size_t slot = XXH3_64bits_withSeed(key.data(), sizeof key, seed) & (slots - 1);
        while (table[slot] >= 0 && key_of(points[static_cast<std::size_t>(table[slot])]) != key) {
            slot = (slot + 1) & (slots - 1);
        }
        if (table[slot] < 0) table[slot] = static_cast<Index>(i);
        first[i] = table[slot];
    }
    return first;
}

}  // namespace ricci
