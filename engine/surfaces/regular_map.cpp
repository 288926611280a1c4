#include "engine/surfaces/regular_map.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

namespace ricci {
namespace {

using Matrix = std::array<int, 4>;  // row by row, entries modulo a prime

/// A matrix group modulo `prime`, where `projective` identifies a matrix with its negative.
struct MatrixGroup {
    int prime;
    bool projective;

    [[nodiscard]] Matrix normal_form(Matrix m) const {
        for (int& x : m) x = ((x % prime) + prime) % prime;
        Matrix negative = m;
        for (int& x : negative) x = (prime - x) % prime;
        return projective ? std::min(m, negative) : m;
    }
    [[nodiscard]] Matrix multiply(const Matrix& a, const Matrix& b) const {
        return normal_form({a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2],
                            a[2] * b[1] + a[3] * b[3]});
    }
};

/// The elements of a group as halfedges of a triangulation: the halfedge after g is g y, its twin is g x,
/// with y of order three and x of order two. Multiplication from the left then is a symmetry, so that the
/// symmetries carry every halfedge to every other; the order of x y is the valence.
SurfaceMesh regular_map(const MatrixGroup& group, const Matrix& x, const Matrix& y) {
    std::map<Matrix, Index> number;
    std::vector<Matrix> elements;
    const auto add_face = [&](Matrix g) {
        for (int k = 0; k < 3; ++k, g = group.multiply(g, y)) {
            number[g] = static_cast<Index>(elements.size());
            elements.push_back(g);
        }
    };
    add_face(group.normal_form({1, 0, 0, 1}));
    std::vector<Index> twin;
    for (std::size_t h = 0; h < elements.size(); ++h) {  // grows while it runs: neighbours of known faces
        const Matrix opposite = group.multiply(elements[h], x);
        if (!number.contains(opposite)) add_face(opposite);
        twin.push_back(number[opposite]);
    }
    Index vertex_count = 0;
    std::vector<Index> tail(elements.size(), -1);
    for (Index start = 0; start < static_cast<Index>(tail.size()); ++start) {
        if (tail[static_cast<std::size_t>(start)] >= 0) continue;
        Index h = start;
        do {
            tail[static_cast<std::size_t>(h)] = vertex_count;
            h = next_halfedge(twin[static_cast<std::size_t>(h)]);
        } while (h != start);
        ++vertex_count;
    }
    SurfaceMesh mesh;
    mesh.edge_length.assign(elements.size(), 1.0);
    mesh.connectivity = connectivity_from_gluing(std::move(tail), std::move(twin), vertex_count);
    mesh.input_vertex.resize(static_cast<std::size_t>(vertex_count));
    std::iota(mesh.input_vertex.begin(), mesh.input_vertex.end(), Index{0});
    return mesh;
}

}  // namespace

SurfaceMesh make_klein_quartic() {
    // PSL(2,7), 168 elements, with the modular group's generators; x y is a translation, of order 7.
    return regular_map({7, true}, {0, -1, 1, 0}, {0, -1, 1, 1});
}

SurfaceMesh make_bolza() {
    // GL(2,3), 48 elements; x y has trace 1 and determinant -1, hence order 8.
    return regular_map({3, false}, {0, 1, 1, 0}, {1, 1, 0, 1});
}

}  // namespace ricci
