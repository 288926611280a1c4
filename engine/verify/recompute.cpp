#include "engine/verify/recompute.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <type_traits>

#include "kernels/extended.h"

namespace ricci {
namespace {

// Of long double or of WideReal, whose own functions are found by their argument.
using std::abs;
using std::asin;
using std::asinh;
using std::atan;
using std::exp;
using std::log;
using std::sin;
using std::sinh;
using std::sqrt;
using std::tan;
using std::tanh;

template <class Real>
Real pi_of() {
    static const Real value = 4 * atan(Real(1));
    return value;
}

template <class Real>
bool is_finite(const Real& x) {
    return x - x == Real(0);
}

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A face by corners and by edges: edge[k] joins corner[k] to corner[k+1].
struct Face {
    std::array<Index, 3> corner, edge;
};

/// An edge by the places where faces use it; `sides` is 1 on a boundary.
template <class Real>
struct Edge {
    struct Place {
        Index face, slot;
    };
    std::array<Place, 2> place;
    int sides = 0;
    Real length{0};  // at u = 0
};

template <class Real>
struct Complex {
    std::vector<Face> faces;
    std::vector<Edge<Real>> edges;
    std::vector<Index> original;  // per vertex: vertex of the input

    void place(Index edge, Index face, Index slot) {
        Edge<Real>& e = edges[at(edge)];
        e.place[at(e.sides++)] = {face, slot};
    }
};

/// Angle opposite `a` by the half-angle tangent; NaN where the triangle does not exist.
template <class Real>
Real euclidean_angle(const Real& a, const Real& b, const Real& c) {
    const Real s = (a + b + c) / 2;
    // s - a and so on from differences of the inputs: b - a is exact where it matters.
    const Real sa = (c + (b - a)) / 2, sb = (c - (b - a)) / 2,
               sc = b >= a ? Real((a - (c - b)) / 2) : Real((b - (c - a)) / 2);
    return 2 * atan(Real(sqrt(Real(sb * sc / (s * sa)))));
}

template <class Real>
Real length_of_chord(Geometry geometry, const Real& chord) {
    if (geometry == Geometry::euclidean) return chord;
    const Real half = chord / 2;
    return 2 * (geometry == Geometry::hyperbolic ? Real(asinh(half)) : Real(asin(half)));
}

template <class Real>
Real angle(Geometry geometry, const Real& a, const Real& b, const Real& c) {
    if (geometry == Geometry::euclidean) return euclidean_angle(a, b, c);
    const Real x = length_of_chord(geometry, a), y = length_of_chord(geometry, b),
               z = length_of_chord(geometry, c), s = (x + y + z) / 2;
    const auto f = [&](const Real& t) {
        return geometry == Geometry::hyperbolic ? Real(sinh(t)) : Real(sin(t));
    };
    return 2 * atan(Real(sqrt(Real(f(s - y) * f(s - z) / (f(s) * f(s - x))))));
}

template <class Real>
Complex<Real> complex_of(const SurfaceMesh& mesh, bool doubled) {
    const Connectivity& c = mesh.connectivity;
    const Index faces = c.face_count();
    Complex<Real> result;
    for (Index v = 0; v < c.vertex_count; ++v) result.original.push_back(v);
    std::vector<Index> image(at(c.vertex_count), -1);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        if (c.twin[at(h)] != kNoTwin) continue;
        image[at(c.tail[at(h)])] = c.tail[at(h)];  // boundary vertices are their own images
        image[at(c.head(h))] = c.head(h);
    }
    result.edges.resize(at(c.edge_count));
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        Real squares(0);
        if (mesh.intrinsic()) {
            squares = Real(mesh.edge_length[at(h)]) * Real(mesh.edge_length[at(h)]);
        } else {
            for (std::size_t k = 0; k < 3; ++k) {
                const Real d = Real(mesh.points[at(c.tail[at(h)])][k]) - Real(mesh.points[at(c.head(h))][k]);
                squares += d * d;
            }
        }
        result.edges[at(c.edge[at(h)])].length = sqrt(squares);
    }
    for (Index f = 0; f < faces; ++f) {
        Face face{};
        for (Index k = 0; k < 3; ++k) {
            face.corner[at(k)] = c.tail[at(3 * f + k)];
            face.edge[at(k)] = c.edge[at(3 * f + k)];
            result.place(face.edge[at(k)], f, k);
        }
        result.faces.push_back(face);
    }
    if (!doubled) return result;
    // The mirror image: corners in the opposite order, boundary edges shared.
    std::vector<Index> edge_image(at(c.edge_count), -1);
    for (Index f = 0; f < faces; ++f) {
        const Face front = result.faces[at(f)];
        Face back{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Index v = front.corner[2 - k];
            if (image[at(v)] < 0) {
                image[at(v)] = static_cast<Index>(result.original.size());
                result.original.push_back(v);
            }
            back.corner[k] = image[at(v)];
            // Corner 2-k to corner 2-k-1 of the front is its edge number 1-k (mod 3).
            const Index e = front.edge[(4 - k) % 3];
            if (result.edges[at(e)].sides == 1 && edge_image[at(e)] < 0) edge_image[at(e)] = e;
            if (edge_image[at(e)] < 0) {
                edge_image[at(e)] = static_cast<Index>(result.edges.size());
                Edge<Real> copy;
                copy.length = result.edges[at(e)].length;
                result.edges.push_back(copy);
            }
            back.edge[k] = edge_image[at(e)];
            result.place(back.edge[k], faces + f, static_cast<Index>(k));
        }
        result.faces.push_back(back);
    }
    return result;
}

/// The metric u on a complex and the flips that keep it Delaunay.
template <class Real>
class Flipper {
  public:
    Flipper(Complex<Real>& complex, const std::vector<Real>& u, bool isometric)
        : complex_(&complex), isometric_(isometric) {
        for (const Real& x : u) scale_.push_back(exp(Real(x / 2)));
    }

    [[nodiscard]] Real scaled(Index face, std::size_t slot) const {
        const Face& f = complex_->faces[at(face)];
        return complex_->edges[at(f.edge[slot])].length * scale_[at(f.corner[slot])] *
               scale_[at(f.corner[(slot + 1) % 3])];
    }

    [[nodiscard]] std::int64_t failing() const {
        std::int64_t count = 0;
        for (std::size_t e = 0; e < complex_->edges.size(); ++e)
            count += fails(static_cast<Index>(e)) ? 1 : 0;
        return count;
    }

    /// Flips until done; the number of flips, or -1 where it does not end.
    std::int64_t run() {
        std::deque<Index> queue;
        std::vector<std::uint8_t> queued(complex_->edges.size(), 1);
        for (std::size_t e = 0; e < complex_->edges.size(); ++e) queue.push_back(static_cast<Index>(e));
        std::int64_t flips = 0;
        const auto bound = static_cast<std::int64_t>(200 * complex_->edges.size() + 1000);
        while (!queue.empty()) {
            const Index e = queue.front();
            queue.pop_front();
            queued[at(e)] = 0;
            if (!fails(e)) continue;
            if (++flips > bound) return -1;
            for (const Index side : flip(e)) {
                if (queued[at(side)]) continue;
                queued[at(side)] = 1;
                queue.push_back(side);
            }
        }
        return flips;
    }

  private:
    /// Cosine of the angle opposite slot, which may lie outside [-1, 1] where Ptolemy lengths break the
    /// triangle.
    [[nodiscard]] Real cosine_opposite(typename Edge<Real>::Place p) const {
        const auto k = at(p.slot);
        const Real c = scaled(p.face, k), a = scaled(p.face, (k + 1) % 3), b = scaled(p.face, (k + 2) % 3);
        return (a / b + b / a - (c / a) * (c / b)) / 2;
    }

    /// Cosines that cancel to this are those of a quadrilateral on a circle.
    static Real tie() { return std::is_same_v<Real, long double> ? Real(1e-16) : Real(1e-40); }

    [[nodiscard]] bool fails(Index edge) const {
        const Edge<Real>& e = complex_->edges[at(edge)];
        if (e.sides < 2 || e.place[0].face == e.place[1].face) return false;
        return cosine_opposite(e.place[0]) + cosine_opposite(e.place[1]) < -tie();
    }

    /// Flips and returns the four edges around.
    std::array<Index, 4> flip(Index edge) {
        Edge<Real>& e = complex_->edges[at(edge)];
        const typename Edge<Real>::Place p = e.place[0], q = e.place[1];
        const auto pk = at(p.slot), qk = at(q.slot);
        const Face f = complex_->faces[at(p.face)], g = complex_->faces[at(q.face)];
        // p: i -> j, then j -> k, k -> i. q: j -> i, then i -> l, l -> j.
        const Index i = f.corner[pk], j = f.corner[(pk + 1) % 3], k = f.corner[(pk + 2) % 3],
                    l = g.corner[(qk + 2) % 3];
        const Index jk = f.edge[(pk + 1) % 3], ki = f.edge[(pk + 2) % 3], il = g.edge[(qk + 1) % 3],
                    lj = g.edge[(qk + 2) % 3];
        const auto length = [&](Index x) { return complex_->edges[at(x)].length; };
        const Real a = length(jk), b = length(ki), d = length(il), h = length(lj), c = e.length;
        if (isometric_) {
            const Real at_i = euclidean_angle(a, b, c) + euclidean_angle(h, d, c);
            // b^2 + d^2 - 2 b d cos(at_i) without cancellation.
            const Real s = sin(Real(at_i / 2));
            e.length = sqrt(Real((b - d) * (b - d) + 4 * b * d * s * s));
        } else {
            e.length = (b * h + d * a) / c;
        }
        const Face first{{l, j, k}, {lj, jk, edge}}, second{{k, i, l}, {ki, il, edge}};
        // Take the six old places out and put the new ones in; an edge may be used twice by the same face.
        for (const Index x : {jk, ki, il, lj}) take_out(x, p.face, q.face);
        complex_->edges[at(edge)].sides = 0;
        complex_->faces[at(p.face)] = first;
        complex_->faces[at(q.face)] = second;
        for (std::size_t s = 0; s < 3; ++s) complex_->place(first.edge[s], p.face, static_cast<Index>(s));
        for (std::size_t s = 0; s < 3; ++s) complex_->place(second.edge[s], q.face, static_cast<Index>(s));
        return {jk, ki, il, lj};
    }

    void take_out(Index edge, Index first, Index second) {
        Edge<Real>& e = complex_->edges[at(edge)];
        int kept = 0;
        for (int s = 0; s < e.sides; ++s) {
            const typename Edge<Real>::Place p = e.place[at(s)];
            if (p.face != first && p.face != second) e.place[at(kept++)] = p;
        }
        e.sides = kept;
    }

    Complex<Real>* complex_;
    std::vector<Real> scale_;  // e^(u/2)
    bool isometric_;
};

/// Curvature per input vertex from angles[face][corner] and the full angle of each vertex of the complex.
template <class Real>
void fold(const Complex<Real>& complex, const SurfaceMesh& mesh, bool doubled,
          const std::vector<std::array<Real, 3>>& angles, Recomputed& result) {
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(mesh.connectivity),
                                    used = used_vertices(mesh.connectivity);
    std::vector<Real> sum(on_boundary.size(), Real(0));
    for (std::size_t s = 0; s < complex.original.size(); ++s) {
        const auto v = at(complex.original[s]);
        sum[v] += (on_boundary[v] && !doubled ? 1 : 2) * pi_of<Real>();
    }
    for (std::size_t f = 0; f < complex.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            sum[at(complex.original[at(complex.faces[f].corner[k])])] -= angles[f][k];
            result.valid = result.valid && is_finite(angles[f][k]);
        }
    result.curvature.resize(sum.size());
    for (std::size_t v = 0; v < sum.size(); ++v)
        result.curvature[v] = used[v] ? static_cast<double>(doubled ? Real(sum[v] / 2) : sum[v]) : 0.0;
}

template <class Real>
Real triangle_area(const Real& a, const Real& b, const Real& c) {
    std::array<Real, 3> x{a, b, c};
    std::sort(x.begin(), x.end());
    const Real p =
        (x[2] + (x[1] + x[0])) * (x[0] - (x[2] - x[1])) * (x[0] + (x[2] - x[1])) * (x[2] + (x[1] - x[0]));
    return sqrt(Real(std::max(p, Real(0)))) / 4;
}

/// Of a triangle of chords, not by its angles: Heron, and L'Huilier's tan(A/4).
template <class Real>
Real area_of(Geometry geometry, const Real& a, const Real& b, const Real& c) {
    if (geometry == Geometry::euclidean) return triangle_area(a, b, c);
    const Real x = length_of_chord(geometry, a), y = length_of_chord(geometry, b),
               z = length_of_chord(geometry, c), s = (x + y + z) / 2;
    const auto t = [&](const Real& length) {
        const Real half = length / 2;
        return geometry == Geometry::hyperbolic ? Real(tanh(half)) : Real(tan(half));
    };
    return 4 * atan(Real(sqrt(Real(t(s) * t(s - x) * t(s - y) * t(s - z)))));
}

template <class Real>
double distortion(const std::vector<Real>& before, const std::vector<Real>& log_ratio) {
    Real sum_before(0), sum_after(0), top = log_ratio[0];
    for (const Real& r : log_ratio) top = std::max(top, r);
    for (std::size_t f = 0; f < before.size(); ++f) {
        sum_before += before[f];
        sum_after += before[f] * exp(Real(log_ratio[f] - top));
    }
    const Real total = log(sum_after) + top - log(sum_before);
    Real mean(0);
    for (const Real& r : log_ratio) mean += (r - total) * (r - total);
    return static_cast<double>(Real(mean / static_cast<double>(before.size())));
}

template <class Real>
std::vector<Real> input_areas(const Complex<Real>& complex, std::size_t faces) {
    std::vector<Real> areas(faces);
    for (std::size_t f = 0; f < faces; ++f) {
        const auto length = [&](std::size_t k) { return complex.edges[at(complex.faces[f].edge[k])].length; };
        areas[f] = triangle_area(length(0), length(1), length(2));
    }
    return areas;
}

/// Curvature, area and what Gauss-Bonnet says of them, from the chords of every face.
template <class Real, class Chord>
void measure(const Complex<Real>& complex, const SurfaceMesh& mesh, bool doubled, Geometry geometry,
             Chord&& chord, Recomputed& result) {
    std::vector<std::array<Real, 3>> angles(complex.faces.size());
    Real area(0);
    for (std::size_t f = 0; f < complex.faces.size(); ++f) {
        const std::array<Real, 3> l{chord(f, 0), chord(f, 1), chord(f, 2)};
        for (std::size_t k = 0; k < 3; ++k)
            angles[f][k] = angle(geometry, l[(k + 1) % 3], l[k], l[(k + 2) % 3]);
        area += area_of(geometry, l[0], l[1], l[2]);
    }
    fold(complex, mesh, doubled, angles, result);
    double total = 0.0;
    for (const double k : result.curvature) total += k;
    const double kappa = curvature_sign(geometry);
    result.gauss_bonnet_error =
        std::abs(total + (doubled ? 0.5 : 1.0) * kappa * static_cast<double>(area) -
                 2.0 * pi_of<double>() * topology_of(mesh.connectivity).euler_characteristic);
}

template <class Real>
Recomputed recompute_in(const SurfaceMesh& mesh, ConformalFactor u, Geometry geometry, Boundary boundary,
                        bool delaunay) {
    Recomputed result;
    const bool has_boundary = topology_of(mesh.connectivity).boundaries > 0;
    const bool doubled = has_boundary && boundary != Boundary::free;
    Complex<Real> complex = complex_of<Real>(mesh, doubled);
    const auto faces = static_cast<std::size_t>(mesh.connectivity.face_count());
    const std::vector<Real> areas = input_areas(complex, faces);
    std::vector<Real> log_ratio(faces);
    for (std::size_t f = 0; f < faces; ++f) {
        Real sum(0);
        for (const Index v : complex.faces[f].corner) sum += u.at<Real>(v);
        log_ratio[f] = 2 * sum / 3;
    }
    result.area_distortion = distortion(areas, log_ratio);
    if (delaunay) {
        result.isometric_flips =
            Flipper<Real>(complex, std::vector<Real>(complex.original.size(), Real(0)), true).run();
    }
    std::vector<Real> factor(complex.original.size());
    for (std::size_t s = 0; s < factor.size(); ++s) factor[s] = u.at<Real>(complex.original[s]);
    Flipper<Real> flipper(complex, factor, false);
    result.ptolemy_flips = flipper.run();
    result.valid = result.isometric_flips >= 0 && result.ptolemy_flips >= 0;
    result.non_delaunay = flipper.failing();
    for (const Face& f : complex.faces) result.triangles.push_back(f.corner);
    measure(
        complex, mesh, doubled, geometry,
        [&](std::size_t f, std::size_t slot) { return flipper.scaled(static_cast<Index>(f), slot); }, result);
    return result;
}

}  // namespace

Recomputed recompute_scaling(const SurfaceMesh& mesh, ConformalFactor u, Geometry geometry, Boundary boundary,
                             bool delaunay, int digits) {
    return digits <= 19 ? recompute_in<long double>(mesh, u, geometry, boundary, delaunay)
                        : recompute_in<WideReal>(mesh, u, geometry, boundary, delaunay);
}

Recomputed recompute_packing(const SurfaceMesh& mesh, std::span<const double> eta,
                             std::span<const double> eps, std::span<const double> u, Geometry geometry) {
    using Real = long double;
    Recomputed result;
    const Complex<Real> complex = complex_of<Real>(mesh, false);
    const std::size_t faces = complex.faces.size();
    std::vector<Real> new_areas(faces), log_ratio(faces);
    const auto chord = [&](std::size_t h, Index i, Index j) {
        const Real ei = static_cast<Real>(eps[at(i)]) * std::exp(2 * static_cast<Real>(u[at(i)]));
        const Real ej = static_cast<Real>(eps[at(j)]) * std::exp(2 * static_cast<Real>(u[at(j)]));
        const Real pair =
            static_cast<Real>(eta[h]) * std::exp(static_cast<Real>(u[at(i)]) + static_cast<Real>(u[at(j)]));
        if (geometry == Geometry::euclidean) return std::sqrt(2 * pair + ei + ej);
        // The length formulas as printed: cosh l and cos l.
        if (geometry == Geometry::hyperbolic) {
            const Real cosh_l = (4 * pair + (1 + ei) * (1 + ej)) / ((1 - ei) * (1 - ej));
            return std::sqrt(2 * (cosh_l - 1));
        }
        const Real cos_l = (-4 * pair + (1 - ei) * (1 - ej)) / ((1 + ei) * (1 + ej));
        return std::sqrt(2 * (1 - cos_l));
    };
    const std::vector<Real> areas = input_areas(complex, faces);
    for (std::size_t f = 0; f < faces; ++f) {
        std::array<Real, 3> l{};
        for (std::size_t k = 0; k < 3; ++k)
            l[k] = chord(3 * f + k, complex.faces[f].corner[k], complex.faces[f].corner[(k + 1) % 3]);
        new_areas[f] = area_of(geometry, l[0], l[1], l[2]);
        log_ratio[f] = std::log(new_areas[f] / areas[f]);
    }
    result.area_distortion = distortion(areas, log_ratio);
    measure(
        complex, mesh, false, geometry,
        [&](std::size_t f, std::size_t k) {
            return chord(3 * f + k, complex.faces[f].corner[k], complex.faces[f].corner[(k + 1) % 3]);
        },
        result);
    return result;
}

}  // namespace ricci
