#include "engine/app/pictures/copy_colours.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ricci::app {
namespace {

using Key = std::array<double, 3>;

double distance(const Key& p, const Key& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// Finds copies by where they take the origin: deck transformations move it to different points.
class CopyIndex {
  public:
    CopyIndex(int kappa, std::span<const Isometry<double>> copies) {
        for (std::size_t i = 0; i < copies.size(); ++i) {
            const Key key = image_of_origin(kappa, copies[i]);
            by_first_.emplace(key[0], std::pair(key, i));
        }
    }

    /// Number of the copy that takes the origin there, or -1.
    [[nodiscard]] std::ptrdiff_t find(const Key& key) const {
        // Far images come from long products and differ by more than near ones.
        const double slack = 1e-6 * std::max(1.0, std::abs(key[2]));
        for (auto it = by_first_.lower_bound(key[0] - slack);
             it != by_first_.end() && it->first <= key[0] + slack; ++it)
            if (distance(it->second.first, key) <= slack)
                return static_cast<std::ptrdiff_t>(it->second.second);
        return -1;
    }

  private:
    std::multimap<double, std::pair<Key, std::size_t>> by_first_;
};

}  // namespace

std::vector<std::vector<std::size_t>> neighbours_of_copies(const SurfaceLayout& layout,
                                                           std::span<const Isometry<double>> copies) {
    const CopyIndex index(layout.kappa, copies);
    std::vector<std::vector<std::size_t>> neighbours(copies.size());
    for (std::size_t i = 0; i < copies.size(); ++i)
        for (const SidePairing& pairing : layout.pairings) {
            const Isometry<double> next = compose(layout.kappa, copies[i], pairing.element);
            const std::ptrdiff_t j = index.find(image_of_origin(layout.kappa, next));
            if (j >= 0 && j != static_cast<std::ptrdiff_t>(i))
                neighbours[i].push_back(static_cast<std::size_t>(j));
        }
    for (std::vector<std::size_t>& list : neighbours) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return neighbours;
}

std::vector<std::size_t> copy_colours(const std::vector<std::vector<std::size_t>>& neighbours,
                                      std::size_t colours) {
    std::vector<std::size_t> result(neighbours.size(), colours), used(colours, 0);
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
        std::vector<std::size_t> near(colours, 0);
        for (const std::size_t j : neighbours[i])
            if (result[j] < colours) ++near[result[j]];
        std::size_t best = 0;
        for (std::size_t k = 1; k < colours; ++k)
            if (std::pair(near[k], used[k]) < std::pair(near[best], used[best])) best = k;
        result[i] = best;
        ++used[best];
    }
    return result;
}

}  // namespace ricci::app
