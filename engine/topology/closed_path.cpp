#include "engine/topology/closed_path.h"

#include <stdexcept>
#include <string>
#include <unordered_map>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

std::string pair_of(Index a, Index b) {
    return "vertices " + std::to_string(a) + " and " + std::to_string(b);
}

/// The steps from some vertices, by tail.
using Departures = std::unordered_multimap<Index, Step>;

Departures departures(const Connectivity& c, std::span<const Index> vertices) {
    std::vector<std::uint8_t> wanted(at(c.vertex_count), 0);
    for (const Index v : vertices) wanted[at(v)] = 1;
    Departures steps;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        if (wanted[at(c.tail[at(h)])] != 0) steps.emplace(c.tail[at(h)], h);
        if (c.twin[at(h)] == kNoTwin && wanted[at(c.head(h))] != 0) steps.emplace(c.head(h), ~h);
    }
    return steps;
}

}  // namespace

EdgePath closed_path(const Connectivity& c, std::span<const Index> vertices) {
    if (vertices.empty()) throw std::invalid_argument("a closed path needs vertices");
    for (const Index v : vertices)
        if (v < 0 || v >= c.vertex_count)
            throw std::invalid_argument("vertex " + std::to_string(v) + " is out of range: there are " +
                                        std::to_string(c.vertex_count));
    const Departures steps = departures(c, vertices);
    EdgePath path;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Index from = vertices[i], to = vertices[(i + 1) % vertices.size()];
        Step found = kNoStep;
        const auto [begin, end] = steps.equal_range(from);
        for (auto step = begin; step != end; ++step) {
            if (step_head(c, step->second) != to) continue;
            if (found != kNoStep)
                throw std::invalid_argument("more than one edge joins " + pair_of(from, to) +
                                            ": the path is ambiguous");
            found = step->second;
        }
        if (found == kNoStep)
            throw std::invalid_argument(
                pair_of(from, to) + " are not joined by an edge" +
                (from == to && vertices.size() > 1
                     ? " (the path closes by itself: the first vertex is not repeated)"
                     : ""));
        path.push_back(found);
    }
    return path;
}

}  // namespace ricci
