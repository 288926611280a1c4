#include "engine/flow/hessian.h"

#include <algorithm>

namespace ricci {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

void HessianAssembler::build(const Connectivity& c, std::span<const Index> unknown, Index unknown_count) {
    unknown_.assign(unknown.begin(), unknown.end());
    const auto n = at(unknown_count);
    // Bucket the lower-triangle entries by column: every unknown's diagonal, then one entry per edge.
    std::vector<Index> begin(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) begin[i + 1] = 1;
    const auto for_edges = [&](auto&& visit) {
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            const Index t = c.twin[at(h)];
            if (t != kNoTwin && t < h) continue;
            const Index i = unknown_[at(c.tail[at(h)])], j = unknown_[at(c.head(h))];
            if (i >= 0 && j >= 0 && i != j) visit(std::min(i, j), std::max(i, j));
        }
    };
    for_edges([&](Index column, Index) { ++begin[at(column) + 1]; });
    for (std::size_t i = 0; i < n; ++i) begin[i + 1] += begin[i];
    std::vector<Index> rows(at(begin[n])), fill(begin.begin(), begin.end() - 1);
    for (std::size_t i = 0; i < n; ++i) rows[at(fill[i]++)] = static_cast<Index>(i);
    for_edges([&](Index column, Index row) { rows[at(fill[at(column)]++)] = row; });
    pattern_.column_begin.assign(1, 0);
    pattern_.row.clear();
    diagonal_position_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        std::sort(rows.begin() + begin[i], rows.begin() + begin[i + 1]);
        diagonal_position_[i] = static_cast<Index>(pattern_.row.size());  // the lowest row of the lower triangle
        for (Index p = begin[i]; p < begin[i + 1]; ++p)
            if (p == begin[i] || rows[at(p)] != rows[at(p) - 1]) pattern_.row.push_back(rows[at(p)]);
        pattern_.column_begin.push_back(static_cast<Index>(pattern_.row.size()));
    }
    edge_position_.assign(at(c.edge_count), -1);
    for (Index h = 0; h < c.halfedge_count(); ++h)
        edge_position_[at(c.edge[at(h)])] = find(unknown_[at(c.tail[at(h)])], unknown_[at(c.head(h))]);
}

Index HessianAssembler::find(Index i, Index j) const {
    if (i < 0 || j < 0) return -1;
    const auto begin = pattern_.row.begin() + pattern_.column_begin[at(std::min(i, j))];
    const auto end = pattern_.row.begin() + pattern_.column_begin[at(std::min(i, j)) + 1];
    const auto found = std::lower_bound(begin, end, std::max(i, j));
    return found != end && *found == std::max(i, j) ? static_cast<Index>(found - pattern_.row.begin()) : -2;
}

bool HessianAssembler::follow_flips(const Connectivity& c, std::span<const Index> touched_faces) {
    for (const Index f : touched_faces) {
        for (Index slot = 3 * f; slot < 3 * f + 3; ++slot) {
            const Index position = find(unknown_[at(c.tail[at(slot)])], unknown_[at(c.head(slot))]);
            if (position == -2) {
                const std::vector<Index> unknown = std::move(unknown_);
                build(c, unknown, static_cast<Index>(diagonal_position_.size()));
                return true;
            }
            edge_position_[at(c.edge[at(slot)])] = position;
        }
    }
    return false;
}

void HessianAssembler::assemble(const Connectivity& c, std::span<const double> off, std::span<const double> diagonal,
                                Index pinned, std::vector<double>& values) const {
    values.assign(pattern_.row.size(), 0.0);
    for (std::size_t h = 0; h < off.size(); ++h) {
        const Index i = unknown_[at(c.tail[h])];
        if (i < 0) continue;
        const Index diagonal_of_i = diagonal_position_[at(i)];
        values[at(diagonal_of_i)] -= diagonal[h];
        const Index position = edge_position_[at(c.edge[h])];
        if (position < 0) continue;
        // A loop adds both H_ij and H_ji to the diagonal.
        values[at(position)] -= position == diagonal_of_i ? 2.0 * off[h] : off[h];
    }
    if (pinned < 0) return;
    for (Index j = 0; j < pattern_.size(); ++j)
        for (Index p = pattern_.column_begin[at(j)]; p < pattern_.column_begin[at(j) + 1]; ++p)
            if (j == pinned || pattern_.row[at(p)] == pinned) values[at(p)] = 0.0;
    values[at(diagonal_position_[at(pinned)])] = 1.0;
}

}  // namespace ricci
