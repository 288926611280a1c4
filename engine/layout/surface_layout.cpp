#include "engine/layout/surface_layout.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "engine/layout/polished_scales.h"
#include "engine/layout/transport.inl"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

template <class Real>
Isometry<Real> widened(const Isometry<double>& x) {
    return {{Real(x.a.re), Real(x.a.im)}, {Real(x.b.re), Real(x.b.im)}};
}

/// The isometry that takes the origin to a position, straight along the line between them.
Isometry<double> motion_to(int kappa, const std::array<double, 3>& p) {
    const std::array<double, 2> z = conformal_point(kappa, p);
    if (kappa > 0 && p[2] <= -1.0 + 1e-15) return {{0, 0}, {1, 0}};
    Isometry<double> m{{1, 0}, {z[0], z[1]}};
    const double norm = std::sqrt(1.0 + kappa * (z[0] * z[0] + z[1] * z[1]));
    m.a.re /= norm;
    m.b = {m.b.re / norm, m.b.im / norm};
    return m;
}

/// Everything about the disk but its numbers.
struct Domain {
    const CommonRefinement& refinement;
    std::vector<std::uint8_t> blocked;  // C: the side is cut
    std::vector<Index> side_of;         // C: index of the cut side it belongs to, or -1

    Domain(const CommonRefinement& r, const Connectivity& input, const CutGraph& cut)
        : refinement(r), blocked(at(r.corner_count()), 0), side_of(at(r.corner_count()), -1) {
        std::vector<Index> side(input.tail.size(), -1);
        for (std::size_t s = 0; s < cut.sides.size(); ++s)
            for (const Index h : cut.sides[s].halfedges) side[at(h)] = static_cast<Index>(s);
        for (Index c = 0; c < r.corner_count(); ++c) {
            const Index h = r.input_halfedge[at(c)];
            if (h < 0 || r.twin[at(c)] < 0) continue;
            blocked[at(c)] = cut.cut[at(input.edge[at(h)])];
            if (blocked[at(c)]) side_of[at(c)] = side[at(h)];
        }
    }
};

/// Pieces in breadth-first order from `root`, and the corner whose side each was reached across (-1 for the
/// root).
struct Order {
    std::vector<Index> piece, entered;
};

Order breadth_first(const Domain& d, Index root) {
    const CommonRefinement& r = d.refinement;
    Order order;
    order.piece.push_back(root);
    order.entered.assign(at(r.piece_count()), -2);
    order.entered[at(root)] = -1;
    for (std::size_t k = 0; k < order.piece.size(); ++k) {
        const Index p = order.piece[k];
        for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
            const Index t = r.twin[at(c)];
            if (t < 0 || d.blocked[at(c)]) continue;
            Index& entered = order.entered[at(r.piece[at(t)])];
            if (entered != -2) continue;
            entered = c;
            order.piece.push_back(r.piece[at(t)]);
        }
    }
    return order;
}

/// The piece that is the most sides away from the edge of the domain (without one, from piece 0).
Index middle_piece(const Domain& d) {
    const CommonRefinement& r = d.refinement;
    std::vector<std::uint8_t> reached(at(r.piece_count()), 0);
    std::vector<Index> queue;
    const auto reach = [&](Index p) {
        if (reached[at(p)]) return;
        reached[at(p)] = 1;
        queue.push_back(p);
    };
    for (Index c = 0; c < r.corner_count(); ++c)
        if (d.blocked[at(c)] || r.twin[at(c)] < 0) reach(r.piece[at(c)]);
    if (queue.empty()) reach(0);
    for (std::size_t k = 0; k < queue.size(); ++k)
        for (Index c = r.first[at(queue[k])]; c < r.first[at(queue[k]) + 1]; ++c)
            if (r.twin[at(c)] >= 0) reach(r.piece[at(r.twin[at(c)])]);
    return queue.back();
}

/// The moves across every final halfedge. // 3F'
template <class Real>
std::vector<Isometry<Real>> all_crossings(const FinalMetric<Real>& metric, const Connectivity& c) {
    std::vector<Isometry<Real>> result(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        if (t < h) continue;
        result[at(h)] = metric.crossing(c, h);
        result[at(t)] = inverse(result[at(h)]);
    }
    return result;
}

template <class Real>
std::vector<Isometry<Real>> carry_frames(const std::vector<Isometry<Real>>& crossing, int kappa,
                                         const Domain& d, const Order& order) {
    const CommonRefinement& r = d.refinement;
    std::vector<Isometry<Real>> frame(at(r.piece_count()));
    for (std::size_t k = 1; k < order.piece.size(); ++k) {
        const Index side = order.entered[at(order.piece[k])], from = r.piece[at(side)];
        Isometry<Real>& to = frame[at(order.piece[k])];
        const Index g = r.final_halfedge[at(side)];
        to = g < 0 ? frame[at(from)] : compose(kappa, frame[at(from)], crossing[at(g)]);
        if (k % 16 == 0 && kappa >= 0) normalise(kappa, to);
    }
    return frame;
}

/// Position of a corner in the frame of its final face.
template <class Real>
std::array<Real, 3> local_position(const FinalMetric<Real>& metric, const CommonRefinement& r, Index corner) {
    using std::sqrt;
    const auto vertex = metric.corners(r.final_face[at(r.piece[at(corner)])]);
    std::array<Real, 3> x{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Real w(r.weight[at(corner)][k]);
        for (std::size_t i = 0; i < 3; ++i) x[i] += w * vertex[k][i];
    }
    const Real norm = sqrt(x[2] * x[2] + Real(metric.kappa) * (x[0] * x[0] + x[1] * x[1]));
    for (Real& value : x) value /= norm;
    return x;
}

/// Groups corners to layout vertices.
void number_vertices(const Domain& d, SurfaceLayout& layout, std::vector<Index>& first_corner) {
    const CommonRefinement& r = d.refinement;
    layout.corner_vertex.assign(at(r.corner_count()), -1);
    const auto ccw = [&](Index c) {
        const Index side = r.previous(c);
        return d.blocked[at(side)] ? Index{-1} : r.twin[at(side)];
    };
    const auto cw = [&](Index c) {
        if (d.blocked[at(c)] || r.twin[at(c)] < 0) return Index{-1};
        return r.next(r.twin[at(c)]);
    };
    for (Index c = 0; c < r.corner_count(); ++c) {
        if (layout.corner_vertex[at(c)] >= 0) continue;
        const auto number = static_cast<Index>(layout.refinement_vertex.size());
        layout.refinement_vertex.push_back(r.vertex[at(c)]);
        first_corner.push_back(c);
        for (Index k = c; k >= 0 && layout.corner_vertex[at(k)] < 0; k = ccw(k))
            layout.corner_vertex[at(k)] = number;
        for (Index k = cw(c); k >= 0 && layout.corner_vertex[at(k)] < 0; k = cw(k))
            layout.corner_vertex[at(k)] = number;
    }
}

/// Pairings from the middle of each side, spreads, and the closing error.
template <class Real>
void pair_sides(const std::vector<Isometry<Real>>& crossing, const Domain& d, const CutGraph& cut,
                const Order& order, const std::vector<Isometry<Real>>& frame, SurfaceLayout& layout) {
    const CommonRefinement& r = d.refinement;
    const int kappa = layout.kappa;
    const auto across = [&](Index c) {
        const Index g = r.final_halfedge[at(c)];
        const Isometry<Real>& from = frame[at(r.piece[at(c)])];
        return g < 0 ? from : compose(kappa, from, crossing[at(g)]);
    };
    layout.pairings.clear();
    layout.closing_error = 0.0;
    std::vector<Isometry<Real>> element(cut.sides.size());
    std::vector<double> spread(cut.sides.size(), 0.0);
    std::vector<Index> middle(cut.sides.size(), -1);
    for (std::size_t s = 0; s < cut.sides.size(); ++s) {
        const std::vector<Index>& chain = cut.sides[s].halfedges;
        if (cut.sides[s].partner >= 0) middle[s] = chain[chain.size() / 2];
    }
    for (Index c = 0; c < r.corner_count(); ++c) {
        const Index s = d.side_of[at(c)];
        if (s < 0 || r.input_halfedge[at(c)] != middle[at(s)]) continue;
        middle[at(s)] = -1;  // the first piece along it
        element[at(s)] = compose(kappa, across(c), inverse(frame[at(r.piece[at(r.twin[at(c)])])]));
    }
    for (Index c = 0; c < r.corner_count(); ++c) {
        const Index t = r.twin[at(c)];
        if (t < 0) continue;
        const Index s = d.side_of[at(c)];
        // Each side once; across those that the frames came over, they agree by construction.
        if (s < 0 &&
            (t < c || order.entered[at(r.piece[at(t)])] == c || order.entered[at(r.piece[at(c)])] == t))
            continue;
        Isometry<Real> there = frame[at(r.piece[at(t)])];
        if (s >= 0) there = compose(kappa, element[at(s)], there);
        const auto error =
            static_cast<double>(distance_to_identity(compose(kappa, inverse(there), across(c))));
        layout.closing_error =
            error > layout.closing_error || std::isnan(error) ? error : layout.closing_error;
        if (s >= 0) spread[at(s)] = std::max(spread[at(s)], error);
    }
    for (std::size_t s = 0; s < cut.sides.size(); ++s)
        if (cut.sides[s].partner >= 0)
            layout.pairings.push_back({static_cast<Index>(s), rounded(element[s]), spread[s]});
}

/// Motion that brings the domain into its place: its middle to the origin (the boundary circle of a disk on
/// the sphere to the equator), and in the plane the first translation along x.
Isometry<double> placing(const SurfaceLayout& layout, const CommonRefinement& r) {
    const int kappa = layout.kappa;
    if (kappa > 0) {
        Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
        Eigen::Vector3d inside = Eigen::Vector3d::Zero();
        bool bounded = false;
        for (Index c = 0; c < r.corner_count(); ++c) {
            const Eigen::Vector3d p(layout.position[at(layout.corner_vertex[at(c)])].data());
            inside += p;
            if (r.twin[at(c)] >= 0) continue;
            bounded = true;
            moments += p * p.transpose();
        }
        if (!bounded) return {};
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
        Eigen::Vector3d normal = solver.eigenvectors().col(0);
        if (normal.dot(inside) < 0) normal = -normal;
        return inverse(motion_to(kappa, {normal[0], normal[1], normal[2]}));
    }
    std::array<double, 3> centre{};
    for (const auto& p : layout.position)
        for (std::size_t k = 0; k < 3; ++k) centre[k] += p[k] / static_cast<double>(layout.position.size());
    const double norm =
        kappa == 0
            ? centre[2]
            : std::sqrt(std::max(0.0, centre[2] * centre[2] - centre[0] * centre[0] - centre[1] * centre[1]));
    if (!(norm > 0) || !std::isfinite(norm)) return {};
    for (double& value : centre) value /= norm;
    Isometry<double> place = inverse(motion_to(kappa, centre));
    if (kappa < 0) return place;
    for (const SidePairing& pairing : layout.pairings) {
        const Complex<double> shift = pairing.element.a * pairing.element.b;
        const double length = std::hypot(shift.re, shift.im);
        if (std::abs(pairing.element.a.im) > 1e-6 || length < 1e-9) continue;
        const double angle = std::atan2(shift.im, shift.re);
        return compose(0, Isometry<double>{{std::cos(angle / 2), -std::sin(angle / 2)}, {}}, place);
    }
    return place;
}

/// Lays out with the given arithmetic, the root's final face at the origin; where asked moves the domain to
/// its place.
template <class Real>
SurfaceLayout lay_out(const FinalMetric<Real>& metric, const Domain& d, const CutGraph& cut, Index root,
                      bool place) {
    const CommonRefinement& r = d.refinement;
    const int kappa = metric.kappa;
    SurfaceLayout layout;
    layout.kappa = kappa;
    layout.root_piece = root;
    const std::vector<Isometry<Real>> crossing = all_crossings(metric, r.final_triangulation.connectivity);
    const Order order = breadth_first(d, root);
    std::vector<Isometry<Real>> frame = carry_frames(crossing, kappa, d, order);
    std::vector<Index> first_corner;
    number_vertices(d, layout, first_corner);
    std::vector<std::array<Real, 3>> position;
    const auto round_positions = [&] {
        layout.position.clear();
        for (const auto& x : position)
            layout.position.push_back(
                {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])});
    };
    for (const Index c : first_corner)
        position.push_back(apply(kappa, frame[at(r.piece[at(c)])], local_position(metric, r, c)));
    round_positions();
    pair_sides(crossing, d, cut, order, frame, layout);
    if (place) {
        const Isometry<double> rough = placing(layout, r);
        Isometry<Real> motion = widened<Real>(rough);
        normalise(kappa, motion);
        for (Isometry<Real>& f : frame) f = compose(kappa, motion, f);
        for (auto& x : position) x = apply(kappa, motion, x);
        round_positions();
        for (SidePairing& pairing : layout.pairings)
            pairing.element = compose(kappa, compose(kappa, rough, pairing.element), inverse(rough));
    }
    for (const Isometry<Real>& f : frame) layout.frame.push_back(rounded(f));
    return layout;
}

/// Signed area of a piece's image by its stored positions, doubled, and how much of it rounding may account
/// for. Sides are geodesics, so a hyperbolic piece is seen from its first corner in Klein's model, where they
/// are straight.
struct StoredArea {
    double twice = 0, rounding = 0;
};

StoredArea stored_area(const CommonRefinement& r, const SurfaceLayout& layout, Index piece) {
    constexpr double kUlp = 1e-15;
    const Index begin = r.first[at(piece)], end = r.first[at(piece) + 1];
    const std::array<double, 3>& o = layout.position[at(layout.corner_vertex[at(begin)])];
    const std::array<double, 2> z0 = conformal_point(layout.kappa, o);
    // A position is known as well as frames close, and rounded.
    const double unit =
        layout.kappa < 0 ? (kUlp + layout.closing_error) * (1 + o[2]) : 4 * kUlp + layout.closing_error;
    const auto offset = [&](Index c) -> std::array<double, 3> {
        const std::array<double, 3>& p = layout.position[at(layout.corner_vertex[at(c)])];
        if (layout.kappa > 0) return {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
        const std::array<double, 2> z = conformal_point(layout.kappa, p);
        const Complex<double> d{z[0] - z0[0], z[1] - z0[1]};
        if (layout.kappa == 0) return {d.re, d.im, 0};
        // (z - z0) / (1 - conj(z0) z), then 2 w / (1 + |w|^2).
        const Complex<double> e{1 - z0[0] * z[0] - z0[1] * z[1], z0[1] * z[0] - z0[0] * z[1]};
        const double size = squared(e);
        const Complex<double> w{(d.re * e.re + d.im * e.im) / size, (d.im * e.re - d.re * e.im) / size};
        const double klein = 2 / (1 + squared(w));
        return {klein * w.re, klein * w.im, 0};
    };
    const auto extent = [](const std::array<double, 3>& d) {
        return std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
    };
    StoredArea area;
    std::array<double, 3> u = offset(begin + 1);
    for (Index c = begin + 2; c < end; ++c) {
        const std::array<double, 3> v = offset(c);
        area.twice += layout.kappa > 0
                          ? o[0] * (u[1] * v[2] - u[2] * v[1]) + o[1] * (u[2] * v[0] - u[0] * v[2]) +
                                o[2] * (u[0] * v[1] - u[1] * v[0])
                          : u[0] * v[1] - u[1] * v[0];
        area.rounding += unit * (extent(u) + extent(v));
        u = v;
    }
    return area;
}

}  // namespace

SurfaceLayout make_surface_layout(int kappa, const CommonRefinement& refinement, const Connectivity& input,
                                  const HomotopyBasis& basis, const CutGraph& cut,
                                  const LayoutOptions& options) {
    const Domain domain(refinement, input, cut);
    const FinalMetric<double> metric = make_final_metric(kappa, refinement);
    Index root = middle_piece(domain);
    if (options.seed_face >= 0)
        root = static_cast<Index>(
            std::find(refinement.input_face.begin(), refinement.input_face.end(), options.seed_face) -
            refinement.input_face.begin());
    const bool place = options.seed_face < 0;
    SurfaceLayout layout = lay_out(metric, domain, cut, root, place);
    if (kappa < 0 && !(layout.closing_error <= options.goal)) {
        PolishedScales own, &scales = options.scales != nullptr ? *options.scales : own;
        climb_precision(options.max_digits, [&]<class Real>(int digits, Real) {
            layout = lay_out(scales.solve<Real>(refinement).metric, domain, cut, root, place);
            layout.digits = digits;
            return !(layout.closing_error <= options.goal);
        });
    }
    for (const auto& p : layout.position) {
        const double across = std::hypot(p[0], p[1]);
        const double r = kappa == 0 ? across : (kappa < 0 ? std::asinh(across) : std::atan2(across, p[2]));
        layout.radius = std::max(layout.radius, r);
    }
    const PieceWalks walks(refinement, input, basis);
    layout.base_frame = layout.frame[at(refinement.piece[at(walks.home(basis.base()))])];
    return layout;
}

void count_orientations(const CommonRefinement& r, SurfaceLayout& layout) {
    layout.flipped = layout.degenerate = layout.unresolved = 0;
    const PieceAreas areas = piece_areas(r);
    for (Index p = 0; p < r.piece_count(); ++p) {
        if (areas.flat[at(p)] < -areas.flat_rounding[at(p)] ||
            areas.final_share[at(p)] < -areas.share_rounding[at(p)]) {
            ++layout.flipped;
        } else if (!(areas.flat[at(p)] > 0) || !(areas.final_share[at(p)] > 0)) {
            ++layout.degenerate;
        } else {
            const StoredArea area = stored_area(r, layout, p);
            if (!(std::abs(area.twice) > area.rounding)) {
                ++layout.unresolved;
            } else if (area.twice < 0) {
                ++layout.flipped;
            }
        }
    }
}

std::array<double, 2> conformal_point(int kappa, const std::array<double, 3>& p) {
    return kappa == 0 ? std::array<double, 2>{p[0], p[1]}
                      : std::array<double, 2>{p[0] / (1 + p[2]), p[1] / (1 + p[2])};
}

std::array<double, 2> projective_point(const std::array<double, 3>& p) {
    return {p[0] / p[2], p[1] / p[2]};
}

std::array<double, 2> half_plane_point(const std::array<double, 3>& p) {
    // w = i (1 + z) / (1 - z), z = x / (1 + t): imaginary part 1 / (t - x), real part -y / (t - x).
    // t - x without cancellation where x > 0: (1 + y^2) / (t + x).
    const double below = p[0] > 0 ? (1 + p[1] * p[1]) / (p[2] + p[0]) : p[2] - p[0];
    return {-p[1] / below, 1 / below};
}

namespace {

/// Points that are far apart compared with rounding, filed by where they are.
class PointFile {
  public:
    /// `cell`: about half the least distance of two points; kappa as everywhere.
    PointFile(int kappa, double cell) : kappa_(kappa), cell_(cell) {}

    /// Whether the point is new.
    bool insert(const std::array<double, 3>& p) {
        const double across = std::hypot(p[0], p[1]);
        const double r = kappa_ < 0 ? std::asinh(across) : across;
        const double angle = std::atan2(p[1], p[0]);
        // Rings of width `cell`, each cut into sectors about as long.
        for (std::int64_t ring = ring_of(r) - 1; ring <= ring_of(r) + 1; ++ring)
            for (std::int64_t turn = -1; turn <= 1; ++turn) {
                const auto found = filed_.find({ring, wrapped(sector_of(ring, angle) + turn, ring)});
                if (found == filed_.end()) continue;
                for (const auto& q : found->second)
                    if (near(p, q)) return false;
            }
        filed_[{ring_of(r), wrapped(sector_of(ring_of(r), angle), ring_of(r))}].push_back(p);
        return true;
    }

  private:
    [[nodiscard]] std::int64_t ring_of(double r) const { return static_cast<std::int64_t>(r / cell_); }
    [[nodiscard]] std::int64_t sectors(std::int64_t ring) const {
        const double r = (static_cast<double>(ring) + 0.5) * cell_;
        const double around = 2 * std::numbers::pi * (kappa_ < 0 ? std::sinh(r) : r);
        return std::max<std::int64_t>(3, static_cast<std::int64_t>(std::min(around / cell_, 1e15)));
    }
    [[nodiscard]] std::int64_t sector_of(std::int64_t ring, double angle) const {
        return static_cast<std::int64_t>((angle / (2 * std::numbers::pi) + 0.5) *
                                         static_cast<double>(sectors(ring)));
    }
    [[nodiscard]] std::int64_t wrapped(std::int64_t sector, std::int64_t ring) const {
        const std::int64_t n = sectors(ring);
        return ((sector % n) + n) % n;
    }
    [[nodiscard]] bool near(const std::array<double, 3>& p, const std::array<double, 3>& q) const {
        // In units in which a step of `cell` at p is at least cell: rounding grows like the coordinates.
        const double size = kappa_ < 0 ? p[2] : 1.0;
        return std::hypot(p[0] - q[0], p[1] - q[1]) < 1e-3 * cell_ + 1e-7 * size;
    }

    int kappa_;
    double cell_;
    std::map<std::array<std::int64_t, 2>, std::vector<std::array<double, 3>>> filed_;
};

}  // namespace

std::vector<Isometry<double>> tessellate(const SurfaceLayout& layout, std::size_t count,
                                         double max_distance) {
    std::vector<Isometry<double>> copies{{}};
    const int kappa = layout.kappa;
    // Images of one point tell the copies apart; no element but the identity fixes a point.
    const Isometry<double> probe = motion_to(kappa, layout.position.front());
    const auto image = [&](const Isometry<double>& g) {
        return image_of_origin(kappa, compose(kappa, g, probe));
    };
    const auto distance = [&](const std::array<double, 3>& p, const std::array<double, 3>& q) {
        const double chord = std::hypot(p[0] - q[0], p[1] - q[1]);
        if (kappa == 0) return chord;
        return 2 * std::asinh(std::sqrt(std::max(0.0, chord * chord - (p[2] - q[2]) * (p[2] - q[2]))) / 2);
    };
    double least = std::numeric_limits<double>::infinity();
    for (const SidePairing& pairing : layout.pairings)
        least = std::min(least, distance(image({}), image(pairing.element)));
    if (layout.pairings.empty() || !(least > 0)) return copies;
    PointFile seen(kappa, std::min(least / 4, 0.25));
    seen.insert(image({}));
    for (std::size_t k = 0; k < copies.size(); ++k)
        for (const SidePairing& pairing : layout.pairings) {
            if (copies.size() >= count) return copies;
            Isometry<double> next = compose(kappa, copies[k], pairing.element);
            normalise(kappa, next);
            const std::array<double, 3> origin = image_of_origin(kappa, next);
            const double across = std::hypot(origin[0], origin[1]);
            if (!((kappa < 0 ? std::asinh(across) : across) <= max_distance)) continue;
            if (seen.insert(image(next))) copies.push_back(next);
        }
    return copies;
}

}  // namespace ricci
