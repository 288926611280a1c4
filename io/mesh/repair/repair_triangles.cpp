#include "io/mesh/repair/repair_triangles.h"

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>

#include "io/mesh/checks/collinear.h"
#include "io/mesh/checks/hash_seed.h"
#include "io/mesh/checks/orientation.h"
#include "io/mesh/repair/face_soup.h"

namespace ricci {
namespace {

/// Corner (0, 1, 2) that lies strictly between the other two, or -1 where two corners coincide.
int middle_corner(const Triangle& t, std::span<const Point> points) {
    std::array<Point, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = points[to_size(t[k])];
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) return -1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // On a line, a coordinate that is not constant orders the points.
        for (std::size_t k = 0; k < 3; ++k) {
            const double low = std::min(p[(k + 1) % 3][axis], p[(k + 2) % 3][axis]);
            const double high = std::max(p[(k + 1) % 3][axis], p[(k + 2) % 3][axis]);
            if (low < p[k][axis] && p[k][axis] < high) return static_cast<int>(k);
        }
    }
    return -1;
}

class FlatFaceRemover {
  public:
    FlatFaceRemover(TriangleSoup& soup, std::span<const Point> points) : soup_(soup), points_(points) {
        for (std::size_t f = 0; f < soup.triangles.size(); ++f) {
            if (is_flat(soup.triangles[f])) flat_.push_back(static_cast<Index>(f));
        }
    }

    void run(DefectList& notes) {
        // Each round shortens or removes flat faces; a chain of n takes at most about n rounds. A round looks
        // at all faces.
        const std::size_t rounds = flat_rounds(soup_.triangles.size());
        for (std::size_t round = 0; round < rounds && !flat_.empty(); ++round) {
            if (!change_once()) break;
        }
        note(notes, "dropped_face", "faces of zero area on the boundary dropped (they covered nothing)",
             dropped_);
        note(notes, "flipped_edge",
             "edge flips removed faces of zero area without changing the surface: the longest edges of faces",
             flipped_);
    }

  private:
    [[nodiscard]] bool is_flat(const Triangle& t) const {
        return collinear(points_[to_size(t[0])], points_[to_size(t[1])], points_[to_size(t[2])]);
    }

    static std::uint64_t pair_key(Index a, Index b) {
        return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) |
               static_cast<std::uint64_t>(std::max(a, b));
    }

    static void note(DefectList& notes, const char* code, const std::string& what,
                     const std::vector<Index>& faces) {
        if (faces.empty()) return;
        notes.add(code, "face", faces.front(),
                  std::to_string(faces.size()) + " " + what + ": " + listed(faces));
    }

    /// One round over the flat faces; a triangle changes at most once in it. False when nothing changed.
    bool change_once() {
        const SoupEdges edges = soup_edges(soup_, static_cast<Index>(points_.size()));
        touched_.assign(soup_.triangles.size(), 0);
        added_.clear();
        sort_edges(edges);
        std::vector<Index> gone;
        bool changed = false;
        for (const Index f : flat_) {
            const int middle = middle_corner(soup_.triangles[to_size(f)], points_);
            if (touched_[to_size(f)] != 0 || middle < 0) continue;
            const Index longest = next_halfedge(3 * f + middle);  // opposite the middle corner
            const std::span<const Index> faces = edges.of(edges.edge[to_size(longest)]);
            if (faces.size() == 1) {
                gone.push_back(f);
                dropped_.push_back(soup_.source_face[to_size(f)]);
                touch_neighbours(edges, f);
                changed = true;
            } else if (faces.size() == 2) {
                changed = flip(f, middle, faces[0] == longest ? faces[1] : faces[0]) || changed;
            }
        }
        rebuild(gone);
        return changed;
    }

    /// Neighbours of a dropped face wait for the next round, which sees the new boundary.
    void touch_neighbours(const SoupEdges& edges, Index f) {
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            for (const Index g : edges.of(edges.edge[to_size(h)])) touched_[to_size(face_of(g))] = 1;
        }
    }

    /// Flat face (a, b, c) with b in the middle, `h` the halfedge of the neighbour (.., d) along ac: the two
    /// become the neighbour with b in place of c, and with b in place of a.
    bool flip(Index f, int middle, Index h) {
        const Index g = face_of(h);
        const Index b = soup_.triangles[to_size(f)][static_cast<std::size_t>(middle)];
        const Index d = soup_.tail(prev_halfedge(h));
        if (touched_[to_size(g)] != 0 || b == d || is_edge(b, d)) return false;
        Triangle& neighbour = soup_.triangles[to_size(g)];
        if (is_flat(neighbour)) {
            // Two flat faces trade their common edge only if it is the longest of both: then edges get
            // shorter.
            const int other = middle_corner(neighbour, points_);
            if (other < 0 || next_halfedge(3 * g + other) != h) return false;
            if (points_[to_size(b)] == points_[to_size(d)]) return false;
        }
        Triangle second = neighbour;
        neighbour[to_size(next_halfedge(h) % 3)] = b;
        second[to_size(h % 3)] = b;
        soup_.triangles[to_size(f)] = second;
        flipped_.push_back(soup_.source_face[to_size(f)]);
        soup_.source_face[to_size(f)] = soup_.source_face[to_size(g)];
        touched_[to_size(f)] = touched_[to_size(g)] = 1;
        added_.insert(pair_key(b, d));
        return true;
    }

    void sort_edges(const SoupEdges& edges) {
        sorted_.clear();
        for (Index e = 0; e < edges.count(); ++e) {
            const Index h = edges.of(e)[0];
            sorted_.push_back(std::minmax({soup_.tail(h), soup_.head(h)}));
        }
        std::sort(sorted_.begin(), sorted_.end());
    }

    [[nodiscard]] bool is_edge(Index a, Index b) const {
        const std::pair<Index, Index> key = std::minmax({a, b});
        return std::binary_search(sorted_.begin(), sorted_.end(), key) || added_.contains(pair_key(a, b));
    }

    /// Takes dropped triangles out and looks which are flat now.
    void rebuild(const std::vector<Index>& gone) {
        std::vector<std::uint8_t> drop(soup_.triangles.size(), 0);
        for (const Index f : gone) drop[to_size(f)] = 1;
        std::vector<std::uint8_t> candidate(soup_.triangles.size(), 0);
        for (const Index f : flat_) candidate[to_size(f)] = 1;
        TriangleSoup kept;
        flat_.clear();
        for (std::size_t f = 0; f < drop.size(); ++f) {
            if (drop[f] != 0) continue;
            const Triangle& t = soup_.triangles[f];
            if ((candidate[f] != 0 || touched_[f] != 0) && is_flat(t)) {
                flat_.push_back(static_cast<Index>(kept.triangles.size()));
            }
            kept.triangles.push_back(t);
            kept.source_face.push_back(soup_.source_face[f]);
        }
        soup_ = std::move(kept);
    }

    TriangleSoup& soup_;
    std::span<const Point> points_;
    std::vector<Index> flat_;                              // ascending
    std::vector<std::uint8_t> touched_;                    // F, in this round
    std::vector<std::pair<Index, Index>> sorted_;          // edges at the start of the round
    std::unordered_set<std::uint64_t, SeededHash> added_;  // edges made in this round
    std::vector<Index> dropped_, flipped_;                 // faces of the input
};

}  // namespace

void orient_faces(TriangleSoup& soup, Index vertex_count, DefectList& notes) {
    const Orientation orientation = orientation_of(soup, soup_edges(soup, vertex_count));
    std::vector<Index> flipped;
    for (std::size_t f = 0; f < soup.triangles.size(); ++f) {
        if (orientation.flip[f] == 0) continue;
        std::swap(soup.triangles[f][1], soup.triangles[f][2]);
        flipped.push_back(soup.source_face[f]);
    }
    // Triangles of one polygon turn together and count once.
    flipped.erase(std::unique(flipped.begin(), flipped.end()), flipped.end());
    if (flipped.empty()) {
        notes.add("oriented", "file", -1, "0 faces flipped: none stands against the majority of its patch");
    } else {
        notes.add("oriented", "face", flipped.front(),
                  std::to_string(flipped.size()) + " faces flipped: " + listed(flipped));
    }
}

std::size_t flat_rounds(std::size_t faces) {
    constexpr std::size_t kMaxRounds = 1000, kMinRounds = 20, kMaxVisits = 10'000'000;
    return std::clamp(kMaxVisits / std::max<std::size_t>(faces, 1), kMinRounds, kMaxRounds);
}

void remove_flat_faces(TriangleSoup& soup, std::span<const Point> points, DefectList& notes) {
    FlatFaceRemover(soup, points).run(notes);
}

}  // namespace ricci
