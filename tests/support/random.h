// Reproducible random numbers for tests: the same on every standard library.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace ricci::testing {

/// Uniform numbers from the standard Mersenne twister, whose output the language fixes.
class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }
    /// In [0, bound).
    template <class Integer>
    Integer below(Integer bound) {
        return static_cast<Integer>(engine_() % static_cast<std::uint64_t>(bound));
    }
    std::vector<double> uniforms(std::size_t count, double low, double high) {
        std::vector<double> values(count);
        for (double& value : values) value = uniform(low, high);
        return values;
    }
    /// A permutation of 0 ... count-1.
    template <class Integer>
    std::vector<Integer> permutation(Integer count) {
        std::vector<Integer> p(static_cast<std::size_t>(count));
        for (std::size_t k = 0; k < p.size(); ++k) p[k] = static_cast<Integer>(k);
        for (std::size_t k = p.size(); k > 1; --k) std::swap(p[k - 1], p[below(k)]);
        return p;
    }

  private:
    std::mt19937_64 engine_;
};

}  // namespace ricci::testing
