// The modulus of a flat torus, read from its triangulation by development into the plane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "kernels/connectivity.h"
#include "tests/support/small_surfaces.h"

namespace ricci::testing {

using Complex = std::complex<double>;

/// A shortest basis of a lattice, and how far the translations it came from are from its points.
struct Lattice {
    Complex first, second;  // |first| <= |second|, Im(second / first) > 0
    double error = 0.0;     // relative to |first|: rotations of the holonomy and failure to close

    [[nodiscard]] Complex modulus() const { return second / first; }
};

/// Gauss reduction: the shortest basis of the lattice that a and b span.
inline void reduce(Complex& a, Complex& b) {
    for (;;) {
        if (std::norm(a) > std::norm(b)) std::swap(a, b);
        const double k = std::round((b / a).real());
        if (k == 0.0 || std::norm(b - k * a) >= std::norm(b) * (1 - 1e-14)) return;
        b -= k * a;
    }
}

/// Places every face next to its parent in a breadth-first tree of faces; the positions of its three corners.
inline std::vector<std::array<Complex, 3>> develop(const Connectivity& c, const std::vector<double>& length,
                                                   std::vector<bool>& tree_edge) {
    std::vector<std::array<Complex, 3>> place(at(c.face_count()));
    std::vector<bool> placed(place.size(), false);
    tree_edge.assign(at(c.edge_count), false);
    // Corner k+2 of a face whose halfedge k runs from p to q.
    const auto apex = [&](Index h, Complex p, Complex q) {
        const double l = length[at(h)], to = length[at(prev_halfedge(h))],
                     from = length[at(next_halfedge(h))];
        const double x = (l * l + to * to - from * from) / (2 * l);
        const double s = (l + to + from) / 2;
        const double y = 2 * std::sqrt(s * (s - l) * (s - to) * (s - from)) / l;
        return p + (q - p) / l * Complex(x, y);
    };
    const auto put = [&](Index h, Complex p, Complex q) {
        auto& f = place[at(face_of(h))];
        const auto k = at(h % 3);
        f[k] = p;
        f[(k + 1) % 3] = q;
        f[(k + 2) % 3] = apex(h, p, q);
        placed[at(face_of(h))] = true;
    };
    put(0, 0.0, length[0]);
    std::vector<Index> queue = {0};
    for (std::size_t next = 0; next < queue.size(); ++next)
        for (Index k = 0; k < 3; ++k) {
            const Index h = 3 * queue[next] + k, t = c.twin[at(h)];
            if (placed[at(face_of(t))]) continue;
            const auto& f = place[at(queue[next])];
            put(t, f[at((k + 1) % 3)], f[at(k)]);
            tree_edge[at(c.edge[at(h)])] = true;
            queue.push_back(face_of(t));
        }
    return place;
}

/// The lattice of a closed flat triangulation of genus one.
inline Lattice lattice_of(const Connectivity& c, const std::vector<double>& length) {
    std::vector<bool> tree;
    const auto place = develop(c, length, tree);
    double size = 0.0, turn = 0.0;
    for (const double l : length) size = std::max(size, l);
    std::vector<Complex> translations;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        if (tree[at(c.edge[at(h)])] || t < h) continue;
        const auto corner = [&](Index g) { return place[at(face_of(g))][at(g % 3)]; };
        const Complex from_tail = corner(h) - corner(next_halfedge(t)),
                      from_head = corner(next_halfedge(h)) - corner(t);
        turn = std::max(turn, std::abs(from_tail - from_head));  // 0: a pure translation
        if (std::abs(from_tail) > 1e-6 * size) translations.push_back(from_tail);
    }
    Lattice lattice;
    Complex a = 0.0, b = 0.0;
    const double tiny = 1e-6 * size;
    for (Complex v : translations) {
        if (a == 0.0) {
            a = v;
            continue;
        }
        // Three vectors span a lattice of rank two: reduce until one of them vanishes.
        for (int round = 0; round < 1000 && std::abs(v) > tiny; ++round) {
            if (b == 0.0) {
                const double k = std::round((v / a).real());
                v -= k * a;
                if (std::abs(v) <= tiny) break;
                if (std::abs((v / a).imag()) > 1e-6) {
                    b = v;
                    v = 0.0;
                    reduce(a, b);
                } else {
                    std::swap(a, v);
                }
                continue;
            }
            reduce(a, b);
            const double determinant = (std::conj(a) * b).imag();
            const double x = (std::conj(v) * b).imag() / determinant,
                         y = (std::conj(a) * v).imag() / determinant;
            v -= std::round(x) * a + std::round(y) * b;
            if (std::abs(v) > tiny) std::swap(v, b);
        }
        if (std::abs(v) <= tiny) lattice.error = std::max(lattice.error, std::abs(v));
    }
    reduce(a, b);
    if ((b / a).imag() < 0.0) b = -b;
    lattice.first = a;
    lattice.second = b;
    lattice.error = std::max(lattice.error, turn) / std::abs(a);
    return lattice;
}

}  // namespace ricci::testing
