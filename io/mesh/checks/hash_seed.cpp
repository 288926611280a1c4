#include "io/mesh/checks/hash_seed.h"

#include <random>

namespace ricci {

std::uint64_t hash_seed() {
    static const std::uint64_t seed = [] {
        std::random_device device;
        return (static_cast<std::uint64_t>(device()) << 32U) ^ device();
    }();
    return seed;
}

}  // namespace ricci
