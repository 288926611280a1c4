#include "engine/flow/hessian.h"

#include <algorithm>
#include <cstdint>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

void HessianAssembler::build(const Connectivity& c, std::span<const Index> unknown, Index unknown_count) {
    unknown_.assign(unknown.begin(), unknown.end());
    const auto n = at(unknown_count);
    // Bucket the lower-triangle entries by column: every unknown's diagonal, then one entry per edge.
    std::vector<Index> begin(n + 1, 1);
    begin[0] = 0;
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
    pattern_.row.reserve(rows.size());
    diagonal_position_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        std::sort(rows.begin() + begin[i], rows.begin() + begin[i + 1]);
        diagonal_position_[i] =
            static_cast<Index>(pattern_.row.size());  // the lowest row of the lower triangle
        for (Index p = begin[i]; p < begin[i + 1]; ++p)
            if (p == begin[i] || rows[at(p)] != rows[at(p) - 1]) pattern_.row.push_back(rows[at(p)]);
        pattern_.column_begin.push_back(static_cast<Index>(pattern_.row.size()));
    }
    edge_position_.assign(at(c.edge_count), kFixed);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        if (t == kNoTwin || t > h)
            edge_position_[at(c.edge[at(h)])] = find(unknown_[at(c.tail[at(h)])], unknown_[at(c.head(h))]);
    }
}

Index HessianAssembler::find(Index i, Index j) const {
    if (i < 0 || j < 0) return kFixed;
    const Index column = std::min(i, j), row = std::max(i, j);
    const auto begin = pattern_.row.begin() + pattern_.column_begin[at(column)];
    const auto end = pattern_.row.begin() + pattern_.column_begin[at(column) + 1];
    const auto found = std::lower_bound(begin, end, row);
    return found != end && *found == row ? static_cast<Index>(found - pattern_.row.begin()) : kAbsent;
}

bool HessianAssembler::reserve(std::span<const std::pair<Index, Index>> pairs) {
    std::vector<std::pair<Index, Index>> fresh;  // (column, row)
    for (const auto& [a, b] : pairs) {
        const Index i = unknown_[at(a)], j = unknown_[at(b)];
        if (find(i, j) == kAbsent) fresh.emplace_back(std::min(i, j), std::max(i, j));
    }
    if (fresh.empty()) return false;
    std::sort(fresh.begin(), fresh.end());
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    // Merge column by column; `shifted` tells where each old entry went.
    std::vector<Index> shifted(pattern_.row.size());
    SymmetricPattern grown;
    grown.row.reserve(pattern_.row.size() + fresh.size());
    grown.column_begin.reserve(pattern_.column_begin.size());
    grown.column_begin.push_back(0);
    auto next = fresh.begin();
    for (Index column = 0; column < pattern_.size(); ++column) {
        for (Index p = pattern_.column_begin[at(column)]; p < pattern_.column_begin[at(column) + 1]; ++p) {
            for (; next != fresh.end() && next->first == column && next->second < pattern_.row[at(p)]; ++next)
                grown.row.push_back(next->second);
            shifted[at(p)] = static_cast<Index>(grown.row.size());
            grown.row.push_back(pattern_.row[at(p)]);
        }
        for (; next != fresh.end() && next->first == column; ++next) grown.row.push_back(next->second);
        grown.column_begin.push_back(static_cast<Index>(grown.row.size()));
    }
    pattern_ = std::move(grown);
    for (Index& p : diagonal_position_) p = shifted[at(p)];
    for (Index& p : edge_position_)
        if (p >= 0) p = shifted[at(p)];
    return true;
}

bool HessianAssembler::follow_flips(const Connectivity& c, std::span<const Index> touched_faces) {
    const auto update = [&](auto&& on_absent) {
        for (const Index f : touched_faces) {
            for (Index slot = 3 * f; slot < 3 * f + 3; ++slot) {
                const Index position = find(unknown_[at(c.tail[at(slot)])], unknown_[at(c.head(slot))]);
                if (position == kAbsent) on_absent(slot);
                edge_position_[at(c.edge[at(slot)])] = position;
            }
        }
    };
    std::vector<std::pair<Index, Index>> missing;
    update([&](Index slot) { missing.emplace_back(c.tail[at(slot)], c.head(slot)); });
    if (missing.empty()) return false;
    std::vector<Index> seeds;
    for (const Index f : touched_faces) seeds.push_back(c.tail[at(3 * f)]);
    const auto likely = likely_flips(c, seeds, 0, 1);
    missing.insert(missing.end(), likely.begin(), likely.end());
    reserve(missing);
    update([](Index) {});
    return true;
}

std::vector<std::pair<Index, Index>> likely_flips(const Connectivity& c, std::span<const Index> seeds,
                                                  int near, int far) {
    std::vector<std::pair<Index, Index>> pairs;
    std::vector<std::uint8_t> inside(at(c.vertex_count), 0), face_inside(at(c.face_count()), 0);
    for (const Index seed : seeds) inside[at(seed)] = 1;
    std::vector<Index> faces;
    for (int ring = 0; ring < far; ++ring) {
        if (ring == near && near > 0 && seeds.size() <= 8)
            for (Index v = 0; v < c.vertex_count; ++v)
                if (inside[at(v)])
                    for (const Index seed : seeds) pairs.emplace_back(seed, v);
        const std::size_t known = faces.size();
        for (Index f = 0; f < c.face_count(); ++f) {
            const auto h = at(3 * f);
            if (face_inside[at(f)] ||
                !(inside[at(c.tail[h])] || inside[at(c.tail[h + 1])] || inside[at(c.tail[h + 2])]))
                continue;
            face_inside[at(f)] = 1;
            faces.push_back(f);
        }
        for (std::size_t k = known; k < faces.size(); ++k)
            for (Index slot = 3 * faces[k]; slot < 3 * faces[k] + 3; ++slot) inside[at(c.tail[at(slot)])] = 1;
    }
    for (const Index f : faces) {
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            const Index t = c.twin[at(h)];
            if (t != kNoTwin) pairs.emplace_back(c.tail[at(prev_halfedge(h))], c.tail[at(prev_halfedge(t))]);
        }
    }
    return pairs;
}

void HessianAssembler::assemble(const Connectivity& c, std::span<const double> off,
                                std::span<const double> diagonal, Index pinned,
                                std::vector<double>& values) const {
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
