#include "engine/topology/shortest_paths.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>

namespace ricci {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Distance with the number of avoided vertices on the way, which comes first.
struct Reached {
    Index avoided = std::numeric_limits<Index>::max();
    double distance = kInfinity;
    Index vertex = 0;

    [[nodiscard]] bool before(const Reached& other) const {
        return std::tie(avoided, distance) < std::tie(other.avoided, other.distance);
    }
    bool operator>(const Reached& other) const {
        return std::tie(avoided, distance, vertex) > std::tie(other.avoided, other.distance, other.vertex);
    }
};

/// The reached vertex at the greatest distance, the lowest of several.
Index farthest(const ShortestPaths& paths) {
    Index best = paths.root;
    for (Index v = 0; v < static_cast<Index>(paths.distance.size()); ++v) {
        const double d = paths.distance[at(v)];
        if (d < kInfinity && d > paths.distance[at(best)]) best = v;
    }
    return best;
}

std::vector<Index> base_candidates(const Connectivity& c, std::span<const std::uint8_t> excluded) {
    const std::vector<std::uint8_t> used = used_vertices(c), boundary = boundary_vertices(c);
    std::vector<Index> interior, all;
    for (Index v = 0; v < c.vertex_count; ++v) {
        if (used[at(v)] == 0 || (!excluded.empty() && excluded[at(v)] != 0)) continue;
        all.push_back(v);
        if (boundary[at(v)] == 0) interior.push_back(v);
    }
    return interior.empty() ? all : interior;
}

}  // namespace

VertexStars vertex_stars(const Connectivity& connectivity) {
    const Connectivity& c = connectivity;
    VertexStars stars;
    stars.first.assign(at(c.vertex_count) + 1, 0);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        ++stars.first[at(c.tail[at(h)]) + 1];
        if (c.twin[at(h)] == kNoTwin) ++stars.first[at(c.head(h)) + 1];
    }
    std::partial_sum(stars.first.begin(), stars.first.end(), stars.first.begin());
    stars.step.resize(at(stars.first.back()));
    std::vector<Index> cursor(stars.first.begin(), stars.first.end() - 1);
    for (Index h = c.halfedge_count() - 1; h >= 0; --h) {  // ~h ascends as h descends
        if (c.twin[at(h)] == kNoTwin) stars.step[at(cursor[at(c.head(h))]++)] = ~h;
    }
    for (Index h = 0; h < c.halfedge_count(); ++h) stars.step[at(cursor[at(c.tail[at(h)])]++)] = h;
    return stars;
}

EdgePath ShortestPaths::path_to(const Connectivity& connectivity, Index v) const {
    EdgePath path;
    for (Step s = arriving[at(v)]; s != kNoStep; s = arriving[at(step_tail(connectivity, s))])
        path.push_back(s);
    std::reverse(path.begin(), path.end());
    return path;
}

ShortestPaths shortest_paths(const Connectivity& connectivity, const VertexStars& stars,
                             std::span<const double> length, Index root,
                             std::span<const std::uint8_t> avoided) {
    const std::size_t n = at(connectivity.vertex_count);
    ShortestPaths paths{root, std::vector<double>(n, kInfinity), std::vector<Step>(n, kNoStep)};
    std::vector<Reached> best(n);
    std::vector<std::uint8_t> settled(n, 0);
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
    best[at(root)] = {0, 0.0, root};
    queue.push(best[at(root)]);
    while (!queue.empty()) {
        const Reached from = queue.top();
        queue.pop();
        if (settled[at(from.vertex)] != 0) continue;
        settled[at(from.vertex)] = 1;
        paths.distance[at(from.vertex)] = from.distance;
        const bool through_avoided = !avoided.empty() && avoided[at(from.vertex)] != 0 && from.vertex != root;
        for (const Step s : stars.leaving(from.vertex)) {
            const Index to = step_head(connectivity, s);
            const Reached reached{from.avoided + (through_avoided ? 1 : 0),
                                  from.distance + length[at(halfedge_of(s))], to};
            if (settled[at(to)] != 0 || !reached.before(best[at(to)])) continue;
            best[at(to)] = reached;
            paths.arriving[at(to)] = s;
            queue.push(reached);
        }
    }
    return paths;
}

Index choose_base(const Connectivity& connectivity, std::span<const double> length,
                  std::span<const std::uint8_t> excluded) {
    constexpr int kRounds = 8;
    const std::vector<Index> candidates = base_candidates(connectivity, excluded);
    if (candidates.empty()) return -1;
    const VertexStars stars = vertex_stars(connectivity);
    std::vector<double> bound(at(connectivity.vertex_count), 0.0);  // greatest distance to a landmark
    Index landmark = farthest(shortest_paths(connectivity, stars, length, candidates.front()));
    Index best = candidates.front();
    double best_reach = kInfinity;
    for (int round = 0; round < kRounds; ++round) {
        const ShortestPaths seen = shortest_paths(connectivity, stars, length, landmark);
        for (std::size_t v = 0; v < bound.size(); ++v) bound[v] = std::max(bound[v], seen.distance[v]);
        const Index centre =
            *std::min_element(candidates.begin(), candidates.end(),
                              [&bound](Index v, Index w) { return bound[at(v)] < bound[at(w)]; });
        const ShortestPaths around = shortest_paths(connectivity, stars, length, centre);
        landmark = farthest(around);
        const double reach = around.distance[at(landmark)];
        if (reach < best_reach) {
            best = centre;
            best_reach = reach;
        }
        // No vertex reaches less than the least bound; rounding of sums aside, it is attained here.
        if (reach <= bound[at(centre)] * (1 + 1e-12)) break;
    }
    return best;
}

}  // namespace ricci
