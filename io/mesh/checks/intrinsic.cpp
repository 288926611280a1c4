#include "io/mesh/checks/intrinsic.h"

#include <algorithm>
#include <string>

#include "io/mesh/checks/triangle_soup.h"

namespace ricci {
namespace {

std::string halfedge_name(Index h) {
    return "halfedge " + std::to_string(h) + " (face " + std::to_string(face_of(h)) + ", side " +
           std::to_string(h % 3) + ")";
}

/// Exact: the largest side is below the sum of the others. The difference c - a is exact for a <= c <= 2a
/// (Sterbenz).
bool strict_triangle(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (a > c) std::swap(a, c);  // now c is the largest
    const double longer = std::max(a, b);
    const double shorter = std::min(a, b);
    if (c > 2 * longer) return false;
    return c - longer < shorter;
}

void check_twin(const IntrinsicSoup& soup, Index h, DefectList& errors) {
    const Index t = soup.twin[to_size(h)];
    if (t == kNoTwin) return;
    const auto tail = [&](Index g) { return soup.tail[to_size(g)]; };
    const char* reason = nullptr;
    if (t == h) {
        reason = "is its own twin";
    } else if (soup.twin[to_size(t)] != h) {
        reason = "is not the twin of its twin";
    } else if (tail(t) != tail(next_halfedge(h)) || tail(next_halfedge(t)) != tail(h)) {
        reason = "does not run between the same vertices, reversed, as its twin";
    }
    if (reason != nullptr) {
        errors.add("twin_mismatch", "face", face_of(h),
                   [&] { return halfedge_name(h) + " " + reason + " " + std::to_string(t); });
    } else if (t > h && soup.length[to_size(h)] != soup.length[to_size(t)]) {
        errors.add("length_mismatch", "face", face_of(h), [&] {
            return halfedge_name(h) + " and its twin " + std::to_string(t) + " differ in length";
        });
    }
}

void check_fans(const IntrinsicSoup& soup, DefectList& errors) {
    const auto count = static_cast<Index>(soup.tail.size());
    DisjointSets corners(count);
    for (Index h = 0; h < count; ++h) {
        const Index t = soup.twin[to_size(h)];
        if (t == kNoTwin) continue;
        corners.unite(h, next_halfedge(t));
        corners.unite(next_halfedge(h), t);
    }
    std::vector<Index> fans(to_size(soup.vertex_count), 0);
    for (Index h = 0; h < count; ++h) fans[to_size(soup.tail[to_size(h)])] += corners.find(h) == h ? 1 : 0;
    for (std::size_t v = 0; v < fans.size(); ++v) {
        if (fans[v] <= 1) continue;
        errors.add("non_manifold_vertex", "vertex", static_cast<Index>(v), [&] {
            return "vertex " + std::to_string(v) + " joins " + std::to_string(fans[v]) +
                   " fans of faces that the twins do not connect (a pinch)";
        });
    }
}

}  // namespace

void check_intrinsic(const IntrinsicSoup& soup, DefectList& errors) {
    const auto count = static_cast<Index>(soup.tail.size());
    for (Index h = 0; h < count; ++h) check_twin(soup, h, errors);
    for (Index f = 0; f < count / 3; ++f) {
        const double* side = soup.length.data() + 3 * to_size(f);
        if (strict_triangle(side[0], side[1], side[2])) continue;
        errors.add("triangle_inequality", "face", f, [&] {
            return "face " + std::to_string(f) +
                   ": one length is not smaller than the sum of the other two, so that there is no such "
                   "triangle";
        });
    }
    // Fans mean something only once the gluing is sound.
    if (errors.count("twin_mismatch") == 0) check_fans(soup, errors);
}

}  // namespace ricci
