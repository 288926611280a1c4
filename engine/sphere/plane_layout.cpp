#include "engine/sphere/plane_layout.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "kernels/triangle.h"

namespace ricci {
namespace {

using Complex = std::complex<long double>;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// e^{i theta} of the angle at the tail of halfedge h.
Complex corner_rotation(const IntrinsicTriangulation<long double>& t, Index h) {
    const long double a = t.log_chord[at(h)], b = t.log_chord[at(next_halfedge(h))],
                      c = t.log_chord[at(prev_halfedge(h))];
    const long double top = std::max({a, b, c});
    const auto terms = triangle_terms<0>(std::exp(a - top), std::exp(b - top), std::exp(c - top));
    const Complex corner(terms.numerator[0], terms.root);
    return corner / std::abs(corner);
}

}  // namespace

std::vector<Complex> lay_out_plane(const IntrinsicTriangulation<long double>& t, Index seed) {
    const Connectivity& c = t.connectivity;
    std::vector<Complex> position(at(c.vertex_count));
    std::vector<std::uint8_t> placed(at(c.vertex_count), 0), done(at(c.face_count()), 0);
    std::vector<Complex> direction(c.tail.size());  // of each halfedge, unit length
    using Entry = std::pair<long double, Index>;    // distance from the origin, halfedge with known ends
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto push = [&](Index h) {
        const Complex from = position[at(c.tail[at(h)])], to = position[at(c.head(h))];
        queue.emplace(std::max(std::abs(from), std::abs(to)), h);
    };
    placed[at(c.tail[at(seed)])] = placed[at(c.head(seed))] = 1;
    position[at(c.head(seed))] = std::exp(t.log_chord[at(seed)]);
    direction[at(seed)] = 1.0L;
    push(seed);
    while (!queue.empty()) {
        const Index h = queue.top().second;
        queue.pop();
        if (done[at(face_of(h))]) continue;
        done[at(face_of(h))] = 1;
        const Index next = next_halfedge(h), previous = prev_halfedge(h), apex = c.tail[at(previous)];
        const Complex to_apex = direction[at(h)] * corner_rotation(t, h);
        direction[at(previous)] = -to_apex;
        direction[at(next)] = -direction[at(h)] * std::conj(corner_rotation(t, next));
        if (!placed[at(apex)]) {
            placed[at(apex)] = 1;
            // From the nearer end of the edge, which is the more exact one.
            const Index i = c.tail[at(h)], j = c.head(h);
            position[at(apex)] =
                std::abs(position[at(i)]) <= std::abs(position[at(j)])
                    ? position[at(i)] + std::exp(t.log_chord[at(previous)]) * to_apex
                    : position[at(j)] + std::exp(t.log_chord[at(next)]) * direction[at(next)];
        }
        for (const Index side : {h, next, previous}) {
            const Index twin = c.twin[at(side)];
            if (twin == kNoTwin || done[at(face_of(twin))]) continue;
            direction[at(twin)] = -direction[at(side)] / std::abs(direction[at(side)]);
            push(twin);
        }
    }
    return position;
}

}  // namespace ricci
