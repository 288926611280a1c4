// Lines near vertices, to be found again up to rounding.
#pragma once

#include <cmath>
#include <unordered_map>
#include <vector>

#include "engine/shape_space/closed_geodesic.h"

namespace ricci {

/// Numbers of lines by vertex and normal.
class LineTable {
  public:
    /// Number of the line, or -1. Direction does not matter.
    [[nodiscard]] Index find(Index vertex, const Minkowski& normal) const {
        const Index there = find_directed(vertex, normal);
        return there >= 0 ? there : find_directed(vertex, {-normal[0], -normal[1], -normal[2]});
    }
    void insert(Index vertex, const Minkowski& normal, Index number) {
        cells_[key(vertex, cell(normal[0]), cell(normal[1]))].push_back({vertex, normal, number});
    }

  private:
    struct Line {
        Index vertex;
        Minkowski normal;
        Index number;
    };
    static constexpr double kCell = 1e-3;
    static std::int64_t cell(double x) { return static_cast<std::int64_t>(std::floor(x / kCell)); }
    static std::uint64_t key(Index vertex, std::int64_t i, std::int64_t j) {
        std::uint64_t k = static_cast<std::uint64_t>(vertex) * 0x9E3779B97F4A7C15ULL;
        k = (k ^ static_cast<std::uint64_t>(i)) * 0xBF58476D1CE4E5B9ULL;
        return (k ^ (k >> 29) ^ static_cast<std::uint64_t>(j)) * 0x94D049BB133111EBULL;
    }
    [[nodiscard]] Index find_directed(Index vertex, const Minkowski& n) const {
        const double reach = 1e-5;
        for (std::int64_t i = cell(n[0] - reach); i <= cell(n[0] + reach); ++i)
            for (std::int64_t j = cell(n[1] - reach); j <= cell(n[1] + reach); ++j) {
                const auto found = cells_.find(key(vertex, i, j));
                if (found == cells_.end()) continue;
                for (const Line& line : found->second)
                    if (line.vertex == vertex && same_normal(line.normal, n)) return line.number;
            }
        return -1;
    }
    std::unordered_map<std::uint64_t, std::vector<Line>> cells_;
};

}  // namespace ricci
