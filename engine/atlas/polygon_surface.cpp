#include "engine/atlas/polygon_surface.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

PolygonSurface polygons_of(const Connectivity& c) {
    PolygonSurface s;
    s.vertex_count = c.vertex_count;
    s.vertex = c.tail;
    s.twin = c.twin;
    for (Index f = 0; f <= c.face_count(); ++f) s.first.push_back(3 * f);
    for (Index h = 0; h < c.halfedge_count(); ++h) s.polygon.push_back(face_of(h));
    return s;
}

PolygonSurface polygons_of(const CommonRefinement& r) {
    return {r.vertex_count, r.first, r.vertex, r.twin, r.piece};
}

std::vector<Index> lowest_corners(const PolygonSurface& s) {
    std::vector<Index> corner(at(s.vertex_count), -1);
    for (Index c = s.corner_count() - 1; c >= 0; --c) corner[at(s.vertex[at(c)])] = c;
    return corner;
}

std::vector<Index> star_of(const PolygonSurface& s, Index corner) {
    Index first = corner;
    while (s.twin[at(first)] >= 0) {
        first = s.next(s.twin[at(first)]);
        if (first == corner) break;
    }
    std::vector<Index> star;
    for (Index c = first;;) {
        star.push_back(s.polygon[at(c)]);
        c = s.twin[at(s.previous(c))];
        if (c < 0 || c == first) return star;
    }
}

std::vector<Index> dual_distances(const PolygonSurface& s, const std::vector<Index>& sources,
                                  const std::vector<std::uint8_t>& allowed) {
    std::vector<Index> distance(at(s.polygon_count()), -1), queue;
    const auto reach = [&](Index p, Index d) {
        if (distance[at(p)] >= 0 || (!allowed.empty() && allowed[at(p)] == 0)) return;
        distance[at(p)] = d;
        queue.push_back(p);
    };
    for (const Index p : sources) reach(p, 0);
    for (std::size_t i = 0; i < queue.size(); ++i)
        for (Index c = s.first[at(queue[i])]; c < s.first[at(queue[i]) + 1]; ++c) {
            const Index p = s.across(c);
            if (p >= 0) reach(p, distance[at(queue[i])] + 1);
        }
    return distance;
}

}  // namespace ricci
