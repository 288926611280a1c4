#include "engine/atlas/disk_growth.h"

#include <algorithm>
#include <set>
#include <utility>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

DiskGrowth::DiskGrowth(const PolygonSurface& surface, std::span<const std::uint8_t> cone)
    : s_(surface),
      cone_(cone.begin(), cone.end()),
      polygon_in_(at(surface.polygon_count()), 0),
      vertex_in_(at(surface.vertex_count), 0) {}

bool DiskGrowth::is_in(Index polygon) const {
    return polygon >= 0 && polygon_in_[at(polygon)] != 0;
}

bool DiskGrowth::has_a_vertex_twice(Index polygon) const {
    for (Index c = s_.first[at(polygon)]; c < s_.first[at(polygon) + 1]; ++c)
        for (Index d = s_.first[at(polygon)]; d < c; ++d)
            if (s_.vertex[at(c)] == s_.vertex[at(d)]) return true;
    return false;
}

bool DiskGrowth::may_join(Index polygon) const {
    if (is_in(polygon) || has_a_vertex_twice(polygon)) return false;
    if (joined_.empty()) return true;
    Index chains = 0;
    for (Index c = s_.first[at(polygon)]; c < s_.first[at(polygon) + 1]; ++c) {
        const bool before = is_in(s_.across(s_.previous(c))), after = is_in(s_.across(c));
        if (after && !before) ++chains;  // the first side of one
        const Index v = s_.vertex[at(c)];
        // Between two sides the vertex comes to lie inside; off the chain it must not be in the disk.
        if (before && after && cone_[at(v)] != 0) return false;
        if (!before && !after && vertex_in_[at(v)] != 0) return false;
    }
    return chains == 1;  // none as well where all sides are shared
}

void DiskGrowth::join(Index polygon) {
    joined_.push_back(polygon);
    polygon_in_[at(polygon)] = 1;
    for (Index c = s_.first[at(polygon)]; c < s_.first[at(polygon) + 1]; ++c)
        vertex_in_[at(s_.vertex[at(c)])] = 1;
}

std::vector<Index> DiskGrowth::grow(std::span<const Index> start, const std::vector<std::uint8_t>& allowed,
                                    std::size_t limit) {
    joined_.clear();
    std::fill(polygon_in_.begin(), polygon_in_.end(), std::uint8_t{0});
    std::fill(vertex_in_.begin(), vertex_in_.end(), std::uint8_t{0});
    const std::vector<Index> distance = dual_distances(s_, {start.front()}, allowed);
    std::set<std::pair<Index, Index>> open;
    const auto take = [&](Index polygon) {
        join(polygon);
        for (Index c = s_.first[at(polygon)]; c < s_.first[at(polygon) + 1]; ++c) {
            const Index p = s_.across(c);
            if (p >= 0 && !is_in(p) && distance[at(p)] >= 0) open.emplace(distance[at(p)], p);
        }
    };
    for (const Index polygon : start) {
        if (!may_join(polygon)) return {};
        take(polygon);
    }
    // What may not join now is tried again when another of its neighbours has joined.
    while (!open.empty() && joined_.size() < limit) {
        const Index polygon = open.begin()->second;
        open.erase(open.begin());
        if (may_join(polygon)) take(polygon);
    }
    return joined_;
}

}  // namespace ricci
