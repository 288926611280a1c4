// Hash tables over what a file says: seeded anew in every process, so that no file can be made to collide.
#pragma once

#include <cstdint>

namespace ricci {

/// A number that differs from process to process. Results must not depend on it: hash tables only answer
/// whether something was seen.
std::uint64_t hash_seed();

/// Hashes a pair of vertices packed into one number (SplitMix64's finaliser over key and seed).
struct SeededHash {
    std::uint64_t seed = hash_seed();

    [[nodiscard]] std::size_t operator()(std::uint64_t key) const {
        key = (key ^ seed) * 0x9E3779B97F4A7C15U;
        key = (key ^ (key >> 30U)) * 0xBF58476D1CE4E5B9U;
        key = (key ^ (key >> 27U)) * 0x94D049BB133111EBU;
        return key ^ (key >> 31U);
    }
};

}  // namespace ricci
