#include "engine/atlas/face_patches.h"

#include <algorithm>
#include <limits>

namespace ricci {
namespace {

constexpr Index kFar = std::numeric_limits<Index>::max();

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

std::vector<Index> farthest_seeds(const PolygonSurface& s, Index count) {
    std::vector<Index> seeds, nearest(at(s.polygon_count()), kFar);
    if (nearest.empty()) return seeds;
    const auto measure = [&](Index from) {
        const std::vector<Index> distance = dual_distances(s, {from});
        for (std::size_t p = 0; p < nearest.size(); ++p)
            if (distance[p] >= 0) nearest[p] = std::min(nearest[p], distance[p]);
    };
    const auto farthest = [&] {
        return static_cast<Index>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    };
    measure(0);
    Index seed = farthest();
    std::fill(nearest.begin(), nearest.end(), kFar);
    for (;;) {
        seeds.push_back(seed);
        measure(seed);
        seed = farthest();
        const Index left = nearest[at(seed)];
        // A component not reached needs a seed, wanted or not.
        if (left == 0 || (static_cast<Index>(seeds.size()) >= count && left < kFar)) return seeds;
    }
}

std::vector<Index> nearest_seeds(const PolygonSurface& s, const std::vector<Index>& seeds) {
    std::vector<Index> owner(at(s.polygon_count()), -1), queue = seeds;
    for (std::size_t k = 0; k < seeds.size(); ++k) owner[at(seeds[k])] = static_cast<Index>(k);
    // Breadth first from all at once. At every distance the queue is ascending by owner, so the first to
    // reach a polygon is the lowest.
    for (std::size_t i = 0; i < queue.size(); ++i)
        for (Index c = s.first[at(queue[i])]; c < s.first[at(queue[i]) + 1]; ++c) {
            const Index p = s.across(c);
            if (p < 0 || owner[at(p)] >= 0) continue;
            owner[at(p)] = owner[at(queue[i])];
            queue.push_back(p);
        }
    return owner;
}

void add_rings(const PolygonSurface& s, Index rings, std::vector<std::uint8_t>& polygons) {
    std::vector<std::uint8_t> touched(at(s.vertex_count), 0);
    for (Index ring = 0; ring < rings; ++ring) {
        for (Index c = 0; c < s.corner_count(); ++c)
            if (polygons[at(s.polygon[at(c)])] != 0) touched[at(s.vertex[at(c)])] = 1;
        for (Index c = 0; c < s.corner_count(); ++c)
            if (touched[at(s.vertex[at(c)])] != 0) polygons[at(s.polygon[at(c)])] = 1;
    }
}

}  // namespace ricci
