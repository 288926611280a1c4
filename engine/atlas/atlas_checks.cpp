#include "engine/atlas/atlas_checks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "engine/atlas/transitions.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The larger; not-a-number wins.
double worse(double x, double y) {
    return y > x || std::isnan(y) ? y : x;
}

using Matrix = std::array<double, 9>;

Matrix product(const Matrix& x, const Matrix& y) {
    Matrix z{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) z[3 * i + j] += x[3 * i + k] * y[3 * k + j];
    return z;
}

double difference(const Matrix& x, const Matrix& y) {
    double worst = 0.0;
    for (std::size_t i = 0; i < 9; ++i) worst = worse(worst, std::abs(x[i] - y[i]));
    return worst;
}

std::array<double, 3> point_of(const Atlas& atlas, const Chart& chart, std::size_t i) {
    std::array<double, 3> x{};
    for (std::size_t k = 0; k < at(atlas.dimension); ++k) x[k] = chart.point[i * at(atlas.dimension) + k];
    return x;
}

void check_vertices(const CommonRefinement& r, const Atlas& atlas, AtlasChecks& checks) {
    const auto place = [&](const Chart& chart, Index v) {
        const auto found = std::lower_bound(chart.vertices.begin(), chart.vertices.end(), v);
        return point_of(atlas, chart, static_cast<std::size_t>(found - chart.vertices.begin()));
    };
    for (const Transition& t : atlas.transitions)
        for (const Index p : t.pieces)
            for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
                const Index v = r.vertex[at(c)];
                if (v >= r.input_vertices) continue;
                const auto x = place(atlas.charts[at(t.to)], v),
                           y = apply_transition(atlas.kind, t, place(atlas.charts[at(t.from)], v));
                checks.vertex_disagreement =
                    worse(checks.vertex_disagreement, std::hypot(y[0] - x[0], y[1] - x[1], y[2] - x[2]));
            }
}

void check_pieces(const Atlas& atlas, AtlasChecks& checks) {
    for (const Transition& t : atlas.transitions)
        for (const Index p : t.pieces) {
            const Isometry<double> here =
                change_at(atlas.kappa, atlas.charts[at(t.to)], atlas.charts[at(t.from)], p);
            checks.edge_disagreement = worse(
                checks.edge_disagreement, distance_to_identity(compose(atlas.kappa, inverse(t.map), here)));
        }
}

void check_cocycles(const CommonRefinement& r, const Atlas& atlas, AtlasChecks& checks) {
    std::vector<std::vector<std::size_t>> through(at(r.piece_count()));  // transitions defined on the piece
    for (std::size_t i = 0; i < atlas.transitions.size(); ++i)
        for (const Index p : atlas.transitions[i].pieces) through[at(p)].push_back(i);
    std::set<std::array<std::size_t, 3>> seen;
    for (const std::vector<std::size_t>& list : through)
        for (const std::size_t ab : list)
            for (const std::size_t bc : list) {
                const Transition &x = atlas.transitions[ab], &y = atlas.transitions[bc];
                if (x.from != y.to) continue;
                const auto ac = std::find_if(list.begin(), list.end(), [&](std::size_t i) {
                    return atlas.transitions[i].to == x.to && atlas.transitions[i].from == y.from;
                });
                // Charts that both meet a third in a piece meet each other there.
                if (!seen.insert({ab, bc, ac == list.end() ? atlas.transitions.size() : *ac}).second)
                    continue;
                ++checks.triples;
                const double error =
                    ac == list.end() ? std::nan("")
                                     : difference(product(x.matrix, y.matrix), atlas.transitions[*ac].matrix);
                checks.cocycle_error = worse(checks.cocycle_error, error);
            }
}

/// M^T G M - G, over the square of the largest entry of M: so much rounding is multiplied by.
double form_error(int kappa, const Matrix& m) {
    if (kappa == 0) {
        Matrix turn{m[0], m[1], 0, m[3], m[4], 0, 0, 0, 1}, back{m[0], m[3], 0, m[1], m[4], 0, 0, 0, 1};
        const double row = std::max({std::abs(m[6]), std::abs(m[7]), std::abs(m[8] - 1.0)});
        return worse(row, difference(product(back, turn), {1, 0, 0, 0, 1, 0, 0, 0, 1}));
    }
    const auto sign = static_cast<double>(kappa);
    const Matrix transposed{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]};
    const Matrix form{1, 0, 0, 0, 1, 0, 0, 0, sign};
    const double size = difference(m, {});
    return difference(product(transposed, product(form, m)), form) / (size * size);
}

void check_forms(const Atlas& atlas, AtlasChecks& checks) {
    for (const Transition& t : atlas.transitions) {
        checks.form_error = worse(checks.form_error, form_error(atlas.kappa, t.matrix));
        if (atlas.kappa >= 0) continue;
        for (int i = 0; i < 12; ++i) {
            const double angle = std::numbers::pi * i / 6.0;
            const auto y = apply_transition(atlas.kind, t, {std::cos(angle), std::sin(angle), 0.0});
            checks.circle_error = worse(checks.circle_error, std::abs(std::hypot(y[0], y[1]) - 1.0));
        }
    }
}

bool has_piece(const Chart& chart, Index p) {
    return std::binary_search(chart.pieces.begin(), chart.pieces.end(), p);
}

/// V - E + F = 1 and connected across sides.
bool is_disk(const CommonRefinement& r, const Chart& chart) {
    std::set<Index> vertices, reached{chart.pieces.front()};
    std::size_t sides = 0;
    std::vector<Index> queue{chart.pieces.front()};
    for (std::size_t i = 0; i < queue.size(); ++i)
        for (Index c = r.first[at(queue[i])]; c < r.first[at(queue[i]) + 1]; ++c) {
            vertices.insert(r.vertex[at(c)]);
            const Index t = r.twin[at(c)];
            const bool shared = t >= 0 && has_piece(chart, r.piece[at(t)]);
            if (!shared || c < t) ++sides;
            if (shared && reached.insert(r.piece[at(t)]).second) queue.push_back(r.piece[at(t)]);
        }
    return queue.size() == chart.pieces.size() && vertices.size() + chart.pieces.size() == sides + 1;
}

void check_cover(const CommonRefinement& r, const Atlas& atlas, const std::vector<Index>& cones,
                 AtlasChecks& checks) {
    std::vector<std::uint8_t> vertex(at(r.vertex_count), 0), side(at(r.corner_count()), 0);
    std::vector<Index> whole(vertex.size(), 0), around(vertex.size());
    for (const Index v : r.vertex) ++whole[at(v)];
    for (const Chart& chart : atlas.charts) {
        checks.closing_error = worse(checks.closing_error, chart.closing_error);
        checks.not_disks += is_disk(r, chart) ? 0 : 1;
        std::fill(around.begin(), around.end(), 0);
        for (const Index p : chart.pieces)
            for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
                const Index v = r.vertex[at(c)], t = r.twin[at(c)];
                if (++around[at(v)] == whole[at(v)]) vertex[at(v)] = 1;
                if (t < 0 || has_piece(chart, r.piece[at(t)])) side[at(c)] = 1;
            }
    }
    for (const Index v : cones) vertex[at(v)] = 1;
    for (std::size_t v = 0; v < vertex.size(); ++v)
        checks.uncovered_vertices += whole[v] > 0 && vertex[v] == 0 ? 1 : 0;
    for (Index c = 0; c < r.corner_count(); ++c)
        if (r.twin[at(c)] < c && side[at(c)] == 0) ++checks.uncovered_sides;
}

}  // namespace

AtlasChecks check_atlas(const CommonRefinement& refinement, const Atlas& atlas,
                        const std::vector<Index>& cones) {
    AtlasChecks checks;
    checks.overlaps = static_cast<Index>(atlas.transitions.size());
    check_vertices(refinement, atlas, checks);
    check_pieces(atlas, checks);
    check_cocycles(refinement, atlas, checks);
    check_forms(atlas, checks);
    check_cover(refinement, atlas, cones, checks);
    return checks;
}

}  // namespace ricci
