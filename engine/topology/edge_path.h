// Paths along edges, as sequences of steps that also name boundary edges walked against their only halfedge.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// A step along an edge: a halfedge h >= 0 in its own direction, or ~h for a halfedge h without twin against
/// its direction. An interior edge is always named by the halfedge that runs the way of the step.
using Step = Index;
inline constexpr Step kNoStep = std::numeric_limits<Index>::min();  // -1 is ~0, a step

using EdgePath = std::vector<Step>;

constexpr Index halfedge_of(Step step) {
    return step >= 0 ? step : ~step;
}
inline Index step_tail(const Connectivity& connectivity, Step step) {
    return step >= 0 ? connectivity.tail[static_cast<std::size_t>(step)] : connectivity.head(~step);
}
inline Index step_head(const Connectivity& connectivity, Step step) {
    const Index halfedge = halfedge_of(step);
    return step >= 0 ? connectivity.head(halfedge) : connectivity.tail[static_cast<std::size_t>(halfedge)];
}
inline Step reversed_step(const Connectivity& connectivity, Step step) {
    if (step < 0) return ~step;
    const Index twin = connectivity.twin[static_cast<std::size_t>(step)];
    return twin == kNoTwin ? ~step : twin;
}

/// The vertices that a path comes through, from its first to its last; none of an empty path.
inline std::vector<Index> vertices_of(const Connectivity& connectivity, std::span<const Step> path) {
    std::vector<Index> vertices;
    if (path.empty()) return vertices;
    vertices.reserve(path.size() + 1);
    for (const Step step : path) vertices.push_back(step_tail(connectivity, step));
    vertices.push_back(step_head(connectivity, path.back()));
    return vertices;
}

/// The same path walked from its end to its start.
inline EdgePath reversed_path(const Connectivity& connectivity, std::span<const Step> path) {
    EdgePath reversed;
    reversed.reserve(path.size());
    for (std::size_t i = path.size(); i > 0; --i)
        reversed.push_back(reversed_step(connectivity, path[i - 1]));
    return reversed;
}

}  // namespace ricci
