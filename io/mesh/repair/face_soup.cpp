#include "io/mesh/repair/face_soup.h"

#include <algorithm>
#include <string>

#include "io/mesh/formats/coincident.h"

namespace ricci {
namespace {

bool repeats(std::span<const Index> corners) {
    if (corners.size() == 3) {
        return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    }
    std::vector<Index> sorted(corners.begin(), corners.end());
    std::sort(sorted.begin(), sorted.end());
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

/// Merges cyclically neighbouring equal corners.
void merge_neighbours(std::vector<Index>& corners) {
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
}

void add_repeated(std::span<const Index> corners, std::size_t f, bool drop, DefectList& errors) {
    errors.add("repeated_vertex_in_face", "face", static_cast<std::int64_t>(f), [&] {
        return "face " + std::to_string(f) + " (vertices " + listed(corners) + ") repeats a vertex; " +
               (drop ? "the repeats are not neighbours, so that --repair drop-degenerate does not help"
                     : "--repair drop-degenerate merges neighbouring repeats and drops the face if fewer "
                       "than three "
                       "corners remain");
    });
}

void append(FaceSoup& faces, std::span<const Index> corners, std::size_t f) {
    faces.corners.insert(faces.corners.end(), corners.begin(), corners.end());
    faces.first.push_back(faces.corners.size());
    faces.source.push_back(static_cast<Index>(f));
}

void note_faces(DefectList& notes, const char* code, const std::string& what,
                const std::vector<Index>& faces) {
    if (faces.empty()) return;
    notes.add(code, "face", faces.front(), std::to_string(faces.size()) + " " + what + ": " + listed(faces));
}

}  // namespace

std::string listed(std::span<const Index> numbers) {
    constexpr std::size_t kListed = 20;
    std::string text;
    for (std::size_t i = 0; i < numbers.size() && i < kListed; ++i) {
        text += (i > 0 ? ", " : "") + std::to_string(numbers[i]);
    }
    return text + (numbers.size() > kListed ? ", ..." : "");
}

void weld_vertices(PolygonSoup& soup, DefectList& notes) {
    std::vector<std::uint8_t> used(soup.points.size(), 0);
    for (const std::int64_t v : soup.corners) used[static_cast<std::size_t>(v)] = 1;
    const std::vector<Index> first = first_at_position(soup.points, used);
    std::vector<Index> merged;
    for (std::size_t v = 0; v < first.size(); ++v) {
        if (to_size(first[v]) != v) merged.push_back(static_cast<Index>(v));
    }
    for (std::int64_t& v : soup.corners) v = first[static_cast<std::size_t>(v)];
    if (merged.empty()) {
        notes.add("welded", "file", -1, "0 vertices welded: no two used vertices have equal coordinates");
    } else {
        notes.add("welded", "vertex", merged.front(),
                  std::to_string(merged.size()) +
                      " vertices welded to the lowest vertex at the same position: " + listed(merged));
    }
}

FaceSoup distinct_corners(const PolygonSoup& soup, bool drop, DefectList& errors, DefectList& notes) {
    FaceSoup faces;
    faces.corners.reserve(soup.corners.size());
    faces.first.reserve(soup.face_count() + 1);
    faces.source.reserve(soup.face_count());
    std::vector<Index> corners;
    std::vector<Index> dropped;
    std::vector<Index> reduced;
    for (std::size_t f = 0; f < soup.face_count(); ++f) {
        corners.clear();
        for (std::size_t k = soup.face_first[f]; k < soup.face_first[f + 1]; ++k) {
            corners.push_back(static_cast<Index>(soup.corners[k]));
        }
        const bool repeated = repeats(corners);
        if (repeated && drop) merge_neighbours(corners);
        if (corners.size() < 3) {
            dropped.push_back(static_cast<Index>(f));
        } else if (repeated && repeats(corners)) {
            add_repeated(corners, f, drop, errors);
        } else {
            if (repeated) reduced.push_back(static_cast<Index>(f));
            append(faces, corners, f);
        }
    }
    note_faces(notes, "dropped_face", "faces dropped that had fewer than three different vertices", dropped);
    note_faces(notes, "merged_corners", "polygons kept after merging neighbouring corners at the same vertex",
               reduced);
    return faces;
}

}  // namespace ricci
