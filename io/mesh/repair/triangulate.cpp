#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "io/mesh/checks/collinear.h"
#include "io/mesh/checks/hash_seed.h"
#include "io/mesh/checks/quality.h"
#include "io/mesh/repair/face_soup.h"

namespace ricci {
namespace {

using Long = long double;

/// Twice the vector area of a polygon (Newell), from its first corner.
std::array<Long, 3> vector_area(std::span<const Index> corners, std::span<const Point> points) {
    std::array<Long, 3> sum{};
    const Point& o = points[to_size(corners[0])];
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
        const Point& a = points[to_size(corners[k])];
        const Point& b = points[to_size(corners[k + 1])];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            const std::size_t m = (i + 2) % 3;
            sum[i] += (static_cast<Long>(a[j]) - o[j]) * (static_cast<Long>(b[m]) - o[m]) -
                      (static_cast<Long>(a[m]) - o[m]) * (static_cast<Long>(b[j]) - o[j]);
        }
    }
    return sum;
}

class Triangulator {
  public:
    Triangulator(const FaceSoup& faces, std::span<const Point> points) : faces_(faces), points_(points) {}

    TriangleSoup run(DefectList& errors, DefectList& notes) {
        const bool all_triangles = faces_.corners.size() == 3 * faces_.face_count();
        if (!all_triangles) collect_edges();
        soup_.triangles.reserve(faces_.corners.size());
        soup_.source_face.reserve(faces_.corners.size());
        for (std::size_t f = 0; f < faces_.face_count(); ++f) polygon(f, errors);
        add_notes(notes);
        return std::move(soup_);
    }

  private:
    static std::uint64_t pair_key(Index a, Index b) {
        return (static_cast<std::uint64_t>(std::min(a, b)) << 32) |
               static_cast<std::uint64_t>(std::max(a, b));
    }

    void collect_edges() {
        edges_.reserve(faces_.corners.size());
        for (std::size_t f = 0; f < faces_.face_count(); ++f) {
            const std::span<const Index> face = faces_.face(f);
            for (std::size_t k = 0; k < face.size(); ++k) {
                edges_.insert(pair_key(face[k], face[(k + 1) % face.size()]));
            }
        }
    }

    [[nodiscard]] bool is_edge(Index a, Index b) const { return edges_.contains(pair_key(a, b)); }

    void emit(Index a, Index b, Index c) {
        soup_.triangles.push_back({a, b, c});
        soup_.source_face.push_back(source_);
    }

    void polygon(std::size_t f, DefectList& errors) {
        const std::span<const Index> face = faces_.face(f);
        source_ = faces_.source[f];
        if (face.size() == 3) return emit(face[0], face[1], face[2]);
        if (face.size() > kMaxCorners) {
            errors.add("polygon_too_large", "face", source_, [&] {
                return "face " + std::to_string(source_) + " has " + std::to_string(face.size()) +
                       " corners; more than " + std::to_string(kMaxCorners) +
                       " are not triangulated here, cut the polygon into triangles first";
            });
            return;
        }
        // Ears are tested against all corners: quadratic in a polygon, which is a matter of seconds for one
        // of kMaxCorners and of hours for thousands of them.
        work_ += face.size() > kFreeCorners ? face.size() * face.size() : 0;
        if (work_ > kMaxWork) {
            errors.add("polygon_too_large", "face", source_, [&] {
                return "face " + std::to_string(source_) + " has " + std::to_string(face.size()) +
                       " corners, and the squares of the corner counts of all polygons above " +
                       std::to_string(kFreeCorners) + " corners up to here exceed " +
                       std::to_string(kMaxWork) +
                       "; so many large polygons are not triangulated here, cut them into triangles first";
            });
            return;
        }
        normal_ = vector_area(face, points_);
        if (face.size() == 4) {
            ++quads_;
            quad({face[0], face[1], face[2], face[3]});
        } else {
            ++larger_;
            clip_ears(face);
        }
    }

    /// Smallest angle of a triangle, 0 for zero area, -1 where it faces against the polygon's normal.
    [[nodiscard]] double score(Index a, Index b, Index c) const {
        const std::array<Index, 3> corners = {a, b, c};
        const std::array<Long, 3> own = vector_area(corners, points_);
        const Long along = own[0] * normal_[0] + own[1] * normal_[1] + own[2] * normal_[2];
        if (along < 0) return -1;
        const Point& p = points_[to_size(a)];
        const Point& q = points_[to_size(b)];
        const Point& r = points_[to_size(c)];
        return collinear(p, q, r) ? 0 : min_corner_angle(p, q, r);
    }

    void quad(std::array<Index, 4> q) {
        // Start at the lowest vertex, so that the choice does not depend on where the file starts the
        // polygon.
        std::rotate(q.begin(), std::min_element(q.begin(), q.end()), q.end());
        double first = std::min(score(q[0], q[1], q[2]), score(q[0], q[2], q[3]));
        double second = std::min(score(q[1], q[2], q[3]), score(q[1], q[3], q[0]));
        if (is_edge(q[0], q[2])) first = -2;
        if (is_edge(q[1], q[3])) second = -2;
        // Congruent diagonals differ by rounding only; the lowest vertex then decides.
        constexpr double kTie = 1e-9;
        if (second > first + kTie * std::abs(first)) std::rotate(q.begin(), q.begin() + 1, q.end());
        emit(q[0], q[1], q[2]);
        emit(q[0], q[2], q[3]);
        edges_.insert(pair_key(q[0], q[2]));
    }

    /// Projects along the main axis of the normal, with the polygon's orientation made positive.
    void project(std::span<const Index> face) {
        std::size_t axis = 0;
        for (std::size_t i = 1; i < 3; ++i) {
            if (std::abs(normal_[i]) > std::abs(normal_[axis])) axis = i;
        }
        std::size_t u = (axis + 1) % 3;
        std::size_t v = (axis + 2) % 3;
        if (normal_[axis] < 0) std::swap(u, v);
        flat_.clear();
        for (const Index corner : face)
            flat_.push_back({points_[to_size(corner)][u], points_[to_size(corner)][v]});
    }

    [[nodiscard]] Long side(std::size_t a, std::size_t b, std::size_t c) const {
        return (static_cast<Long>(flat_[b][0]) - flat_[a][0]) *
                   (static_cast<Long>(flat_[c][1]) - flat_[a][1]) -
               (static_cast<Long>(flat_[b][1]) - flat_[a][1]) *
                   (static_cast<Long>(flat_[c][0]) - flat_[a][0]);
    }

    /// Rank of the ear at corner k of the remaining polygon; negative where it must not be cut.
    [[nodiscard]] double ear_score(std::span<const Index> face, std::size_t k) const {
        const std::size_t p = prev_[k];
        const std::size_t n = next_[k];
        if (!(side(p, k, n) > 0)) return -3;
        if (is_edge(face[p], face[n])) return -2;
        for (std::size_t i = next_[n]; i != p; i = next_[i]) {
            // On the border counts as inside: the diagonal must not run over another corner.
            if (side(p, k, i) >= 0 && side(k, n, i) >= 0 && side(n, p, i) >= 0) return -1;
        }
        return score(face[p], face[k], face[n]);
    }

    void clip_ears(std::span<const Index> face) {
        const std::size_t count = face.size();
        project(face);
        next_.resize(count);
        prev_.resize(count);
        for (std::size_t k = 0; k < count; ++k) {
            next_[k] = (k + 1) % count;
            prev_[k] = (k + count - 1) % count;
        }
        ear_.resize(count);
        for (std::size_t k = 0; k < count; ++k) ear_[k] = ear_score(face, k);
        bool simple = true;
        std::size_t start = 0;
        for (std::size_t left = count; left > 3; --left) {
            std::size_t best = start;
            for (std::size_t k = next_[start]; k != start; k = next_[k]) {
                if (ear_[k] > ear_[best]) best = k;
            }
            simple = simple && ear_[best] >= 0;
            start = cut(face, best);
        }
        emit(face[start], face[next_[start]], face[prev_[start]]);
        if (!simple) irregular_.push_back(source_);
    }

    /// Cuts the ear at corner k; returns a corner that remains.
    std::size_t cut(std::span<const Index> face, std::size_t k) {
        const std::size_t p = prev_[k];
        const std::size_t n = next_[k];
        emit(face[p], face[k], face[n]);
        edges_.insert(pair_key(face[p], face[n]));
        next_[p] = n;
        prev_[n] = p;
        ear_[p] = ear_score(face, p);
        ear_[n] = ear_score(face, n);
        return p;
    }

    void add_notes(DefectList& notes) const {
        if (quads_ + larger_ > 0) {
            notes.add("triangulated", "file", -1,
                      std::to_string(quads_ + larger_) + " polygons (" + std::to_string(quads_) + " quads, " +
                          std::to_string(larger_) + " larger) triangulated; " +
                          std::to_string(faces_.face_count()) + " faces became " +
                          std::to_string(soup_.triangles.size()));
        }
        if (!irregular_.empty()) {
            notes.add("irregular_polygon", "face", irregular_.front(),
                      std::to_string(irregular_.size()) +
                          " polygons are not simple in the projection along their normal, or share all "
                          "diagonals with "
                          "other faces; their triangles may overlap: " +
                          listed(irregular_));
        }
    }

    const FaceSoup& faces_;
    std::span<const Point> points_;
    TriangleSoup soup_;
    std::unordered_set<std::uint64_t, SeededHash> edges_;  // of polygons and diagonals chosen so far
    Index source_ = 0;
    std::size_t work_ = 0;  // sum of squares of corner counts
    std::array<Long, 3> normal_{};
    std::vector<std::array<double, 2>> flat_;
    std::vector<std::size_t> next_, prev_;
    std::vector<double> ear_;
    std::int64_t quads_ = 0, larger_ = 0;
    std::vector<Index> irregular_;
};

}  // namespace

TriangleSoup triangulate(const FaceSoup& faces, std::span<const Point> points, DefectList& errors,
                         DefectList& notes) {
    return Triangulator(faces, points).run(errors, notes);
}

}  // namespace ricci
