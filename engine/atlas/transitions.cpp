#include "engine/atlas/transitions.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/layout/surface_group.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Parts of a set of pieces (ascending) that are connected across sides, each ascending, by lowest piece.
/// `mark`: P, all 0, and left so.
std::vector<std::vector<Index>> components(const CommonRefinement& r, const std::vector<Index>& pieces,
                                           std::vector<std::uint8_t>& mark) {
    for (const Index p : pieces) mark[at(p)] = 1;
    std::vector<std::vector<Index>> parts;
    for (const Index seed : pieces) {
        if (mark[at(seed)] == 0) continue;
        mark[at(seed)] = 0;
        std::vector<Index> part{seed};
        for (std::size_t i = 0; i < part.size(); ++i)
            for (Index c = r.first[at(part[i])]; c < r.first[at(part[i]) + 1]; ++c) {
                const Index t = r.twin[at(c)];
                if (t < 0 || mark[at(r.piece[at(t)])] == 0) continue;
                mark[at(r.piece[at(t)])] = 0;
                part.push_back(r.piece[at(t)]);
            }
        std::sort(part.begin(), part.end());
        parts.push_back(std::move(part));
    }
    return parts;
}

}  // namespace

const Isometry<double>& frame_in(const Chart& chart, Index p) {
    const auto found = std::lower_bound(chart.pieces.begin(), chart.pieces.end(), p);
    return chart.frame[static_cast<std::size_t>(found - chart.pieces.begin())];
}

Isometry<double> change_at(int kappa, const Chart& to, const Chart& from, Index p) {
    Isometry<double> map = compose(kappa, frame_in(to, p), inverse(frame_in(from, p)));
    normalise(kappa, map);
    return map;
}

std::vector<Transition> make_transitions(const CommonRefinement& r, const Atlas& atlas) {
    std::vector<std::uint8_t> mark(at(r.piece_count()), 0);
    std::vector<Transition> transitions;
    for (std::size_t a = 0; a < atlas.charts.size(); ++a)
        for (std::size_t b = a + 1; b < atlas.charts.size(); ++b) {
            const Chart &to = atlas.charts[a], &from = atlas.charts[b];
            std::vector<Index> common;
            std::set_intersection(to.pieces.begin(), to.pieces.end(), from.pieces.begin(), from.pieces.end(),
                                  std::back_inserter(common));
            for (std::vector<Index>& part : components(r, common, mark)) {
                Transition t;
                t.to = static_cast<Index>(a);
                t.from = static_cast<Index>(b);
                t.map = change_at(atlas.kappa, to, from, part.front());
                t.matrix = atlas.kappa == 0 ? plane_matrix(t.map) : projective_matrix(atlas.kappa, t.map);
                t.pieces = std::move(part);
                transitions.push_back(std::move(t));
            }
        }
    return transitions;
}

std::array<double, 3> model_point(AtlasKind kind, const std::array<double, 3>& x) {
    switch (kind) {
        case AtlasKind::hyperbolic:
            return {x[0] / (1.0 + x[2]), x[1] / (1.0 + x[2]), 0.0};
        case AtlasKind::projective:
            return {x[0] / x[2], x[1] / x[2], 0.0};
        case AtlasKind::spherical:
            return x;
        case AtlasKind::affine:
            break;
    }
    return {x[0], x[1], 0.0};
}

std::array<double, 3> apply_transition(AtlasKind kind, const Transition& t, const std::array<double, 3>& x) {
    if (kind == AtlasKind::hyperbolic) {
        const Complex<double> z{x[0], x[1]};
        const Complex<double> above = t.map.a * z + t.map.b,
                              below = conjugate(t.map.b) * z + conjugate(t.map.a);
        const Complex<double> quotient = above * conjugate(below);
        return {quotient.re / squared(below), quotient.im / squared(below), 0.0};
    }
    const std::array<double, 9>& m = t.matrix;
    const double last = kind == AtlasKind::spherical ? x[2] : 1.0;
    std::array<double, 3> y{};
    for (std::size_t i = 0; i < 3; ++i) y[i] = m[3 * i] * x[0] + m[3 * i + 1] * x[1] + m[3 * i + 2] * last;
    if (kind == AtlasKind::spherical) return y;
    return {y[0] / y[2], y[1] / y[2], 0.0};
}

}  // namespace ricci
