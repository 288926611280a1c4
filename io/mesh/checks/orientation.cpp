#include "io/mesh/checks/orientation.h"

namespace ricci {
namespace {

constexpr std::uint8_t kUnseen = 2;

/// Spreads the orientation of triangle `seed` over its patch; returns an edge that contradicts it, or -1.
Index spread(const TriangleSoup& soup, const SoupEdges& edges, Index seed, std::vector<std::uint8_t>& side,
             std::vector<Index>& patch) {
    Index contradiction = -1;
    patch.assign(1, seed);
    side[to_size(seed)] = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
        const Index f = patch[i];
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            const Index e = edges.edge[to_size(h)];
            const std::span<const Index> both = edges.of(e);
            if (both.size() != 2) continue;
            const Index other = both[0] == h ? both[1] : both[0];
            const bool agree = soup.tail(h) != soup.tail(other);
            const auto wanted = static_cast<std::uint8_t>(agree ? side[to_size(f)] : 1 - side[to_size(f)]);
            std::uint8_t& found = side[to_size(face_of(other))];
            if (found == kUnseen) {
                found = wanted;
                patch.push_back(face_of(other));
            } else if (found != wanted && contradiction < 0) {
                contradiction = e;
            }
        }
    }
    return contradiction;
}

}  // namespace

Orientation orientation_of(const TriangleSoup& soup, const SoupEdges& edges) {
    Orientation orientation;
    std::vector<std::uint8_t>& side = orientation.flip;
    side.assign(soup.triangles.size(), kUnseen);
    std::vector<Index> patch;
    for (std::size_t f = 0; f < side.size(); ++f) {
        if (side[f] != kUnseen) continue;
        const Index contradiction = spread(soup, edges, static_cast<Index>(f), side, patch);
        std::size_t against = 0;
        for (const Index g : patch) against += side[to_size(g)];
        if (contradiction >= 0) orientation.contradiction.push_back(contradiction);
        const bool swap = 2 * against > patch.size();
        for (const Index g : patch) {
            std::uint8_t& flip = side[to_size(g)];
            flip = contradiction >= 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(swap ? 1 - flip : flip);
        }
    }
    return orientation;
}

}  // namespace ricci
