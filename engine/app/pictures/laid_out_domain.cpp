#include "engine/app/pictures/laid_out_domain.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Puts the corners along one halfedge in order: the first starts where no other ends, or (both ends of a
/// loop are one vertex) at the vertex of lowest number, which is the input's.
void sort_chain(const CommonRefinement& r, std::span<Index> chain) {
    if (chain.size() < 2) return;
    const auto start_of = [&](Index c) { return r.vertex[at(c)]; };
    std::sort(chain.begin(), chain.end(), [&](Index a, Index b) { return start_of(a) < start_of(b); });
    std::vector<Index> ends;
    for (const Index c : chain) ends.push_back(r.vertex[at(r.next(c))]);
    std::sort(ends.begin(), ends.end());
    const auto first = std::find_if(chain.begin(), chain.end(), [&](Index c) {
        return !std::binary_search(ends.begin(), ends.end(), start_of(c));
    });
    std::vector<Index> ordered{first == chain.end() ? chain.front() : *first};
    while (ordered.size() < chain.size()) {
        const Index end = r.vertex[at(r.next(ordered.back()))];
        const auto next = std::lower_bound(chain.begin(), chain.end(), end,
                                           [&](Index c, Index v) { return start_of(c) < v; });
        if (next == chain.end() || start_of(*next) != end) return;
        ordered.push_back(*next);
    }
    std::copy(ordered.begin(), ordered.end(), chain.begin());
}

double distance_to_segment(const PlanePoint& p, const PlanePoint& a, const PlanePoint& b) {
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const double along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    const double t = square > 0.0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
    return std::hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}

}  // namespace

EdgeChains::EdgeChains(const CommonRefinement& r) {
    Index halfedges = 0;
    for (const Index h : r.input_halfedge) halfedges = std::max(halfedges, h + 1);
    halfedges = 3 * ((halfedges + 2) / 3);
    first_.assign(at(halfedges) + 1, 0);
    for (const Index h : r.input_halfedge)
        if (h >= 0) ++first_[at(h) + 1];
    for (std::size_t h = 0; h < at(halfedges); ++h) first_[h + 1] += first_[h];
    corner_.resize(at(first_.back()));
    std::vector<Index> filled(first_.begin(), first_.end() - 1);
    for (Index c = 0; c < r.corner_count(); ++c)
        if (const Index h = r.input_halfedge[at(c)]; h >= 0) corner_[at(filled[at(h)]++)] = c;
    for (Index h = 0; h < halfedges; ++h)
        sort_chain(r, std::span(corner_).subspan(at(first_[at(h)]), at(first_[at(h) + 1] - first_[at(h)])));
}

std::span<const Index> EdgeChains::of(Index h) const {
    if (h < 0 || h >= halfedge_count()) return {};
    return std::span(corner_).subspan(at(first_[at(h)]), at(first_[at(h) + 1] - first_[at(h)]));
}

LaidOutDomain::LaidOutDomain(const StoredLayout& stored, LayoutModel model)
    : stored_(&stored), geometry_(model, stored.layout.kappa), chains_(stored.refinement) {
    for (const auto& position : stored.layout.position) {
        shown_.push_back(geometry_.shows(position) ? 1 : 0);
        point_.push_back(shown_.back() ? geometry_.point(position) : PlanePoint{});
    }
}

ViewBox LaidOutDomain::bounds() const {
    if (geometry_.disk()) return {-1.0, -1.0, 2.0, 2.0};
    std::vector<PlanePoint> points;
    for (std::size_t v = 0; v < point_.size(); ++v)
        if (shown_[v]) points.push_back(point_[v]);
    ViewBox box = box_of(points);
    if (geometry_.half_plane()) {
        box.height += box.bottom;
        box.bottom = 0.0;
    }
    return box;
}

std::vector<Index> LaidOutDomain::halfedge_vertices(Index h) const {
    std::vector<Index> vertices;
    const std::span<const Index> chain = chains_.of(h);
    for (const Index c : chain) vertices.push_back(stored_->layout.corner_vertex[at(c)]);
    if (!chain.empty())
        vertices.push_back(stored_->layout.corner_vertex[at(stored_->refinement.next(chain.back()))]);
    return vertices;
}

std::vector<PlanePoint> LaidOutDomain::shown_points(const std::vector<Index>& vertices) const {
    std::vector<PlanePoint> points;
    for (const Index v : vertices) {
        if (!shown_[at(v)]) return {};
        points.push_back(point_[at(v)]);
    }
    return points;
}

std::vector<PlanePoint> LaidOutDomain::edge_points(Index h) const {
    return shown_points(halfedge_vertices(h));
}

std::vector<PlanePoint> LaidOutDomain::face_outline(Index face, double tolerance) const {
    std::vector<PlanePoint> outline;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
        const std::vector<PlanePoint> points = edge_points(h);
        if (points.empty()) return {};
        for (std::size_t i = 0; i + 1 < points.size(); ++i)
            geometry_.append_geodesic(outline, points[i], points[i + 1], tolerance);
    }
    return outline;
}

std::vector<Index> LaidOutDomain::side_vertices(const CutSide& side) const {
    std::vector<Index> vertices;
    for (const Index h : side.halfedges) {
        const std::vector<Index> along = halfedge_vertices(h);
        if (!along.empty() && !vertices.empty() && vertices.back() == along.front()) vertices.pop_back();
        vertices.insert(vertices.end(), along.begin(), along.end());
    }
    return vertices;
}

std::vector<PlanePoint> LaidOutDomain::side_points(const CutSide& side) const {
    return shown_points(side_vertices(side));
}

std::vector<PlanePoint> LaidOutDomain::outline(double tolerance) const {
    std::vector<PlanePoint> outline;
    for (const CutSide& side : stored_->cut.sides) {
        const std::vector<PlanePoint> points = side_points(side);
        if (points.size() < 2) return {};
        for (std::size_t i = 0; i + 1 < points.size(); ++i)
            geometry_.append_geodesic(outline, points[i], points[i + 1], tolerance);
    }
    return outline;
}

void LaidOutDomain::append_to(SvgPath& path, std::span<const PlanePoint> points) const {
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
        path.arc(geometry_.geodesic(points[i], points[i + 1]));
}

std::vector<PlanePoint> simplified(std::span<const PlanePoint> points, double tolerance) {
    if (points.size() < 3) return {points.begin(), points.end()};
    std::vector<std::uint8_t> kept(points.size(), 0);
    kept.front() = kept.back() = 1;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
    while (!open.empty()) {
        const auto [a, b] = open.back();
        open.pop_back();
        std::size_t farthest = a;
        double distance = tolerance;
        for (std::size_t i = a + 1; i < b; ++i) {
            const double d = distance_to_segment(points[i], points[a], points[b]);
            if (d > distance) {
                distance = d;
                farthest = i;
            }
        }
        if (farthest == a) continue;
        kept[farthest] = 1;
        open.emplace_back(a, farthest);
        open.emplace_back(farthest, b);
    }
    std::vector<PlanePoint> result;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (kept[i]) result.push_back(points[i]);
    return result;
}

ViewBox box_of(std::span<const PlanePoint> points) {
    if (points.empty()) throw std::invalid_argument("there is nothing to draw");
    PlanePoint low = points.front(), high = points.front();
    for (const PlanePoint& p : points)
        for (std::size_t k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    if (!std::isfinite(high[0] - low[0]) || !std::isfinite(high[1] - low[1]))
        throw std::invalid_argument("what is to be drawn is larger than double precision can say");
    return {low[0], low[1], high[0] - low[0], high[1] - low[1]};
}

}  // namespace ricci::app
