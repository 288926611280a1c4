#include "engine/lanes/owned_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/squared_triangles.h"
#include "kernels/triangle.h"
#include "kernels/vector_math.h"

namespace ricci {
namespace {

constexpr double kTie = 1e-12;  // relative: cocircular to rounding

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The chords of a quadrilateral i, l, j, k around its diagonal ij.
struct Quadrilateral {
    double ij, jk, ki, il, lj;
};

/// Whether the diagonal is not Delaunay, beyond ties: the sum of the cosines opposite is linear in exp(-u)
/// once both are over 2 exp(-(u_i+u_j)/2).
bool fails_delaunay(const Quadrilateral& q, double shrink_i, double shrink_j, double shrink_k,
                    double shrink_l) {
    const double k = q.jk * q.ki, l = q.lj * q.il, c = q.ij * q.ij;
    const double held =
        shrink_i * (q.jk * q.jk * l + q.lj * q.lj * k) + shrink_j * (q.ki * q.ki * l + q.il * q.il * k);
    const double against = c * (l * shrink_k + k * shrink_l);
    return held * (1.0 + kTie) < against;
}

}  // namespace

OwnedRegion::OwnedRegion(const LaneSurface& surface, int lane, std::vector<LaneMask>& owned)
    : surface_(&surface),
      lane_(lane),
      owned_(&owned),
      local_halfedge_(surface.triangulation.tail.size(), -1),
      local_vertex_(at(surface.rows()), -1) {}

bool OwnedRegion::exhausted() const {
    // Several times what solves that end well need; beyond, Newton's method on the whole surface is cheaper.
    return work_ + flips_ > 200000 + 4 * static_cast<std::int64_t>(surface_->faces.face_count());
}

void OwnedRegion::clear() {
    for (const Index row : row_) local_vertex_[at(row)] = -1;
    for (std::size_t h = 0; h < tail_.size(); ++h)
        if (twin_[h] < 0) local_halfedge_[at(start_halfedge_[h])] = -1;
    const auto keep = static_cast<LaneMask>(~(1U << lane_));
    for (const Index f : taken_) (*owned_)[at(f)] &= keep;
    taken_.clear();
    tail_.clear();
    twin_.clear();
    start_halfedge_.clear();
    chord_.clear();
    row_.clear();
    u_.clear();
    loaded_u_.clear();
    shrink_.clear();
    start_angle_.clear();
    patch_ = 0;
    flips_ = 0;
    newton_steps_ = 0;
    work_ = 0;
    factor_first_ = -1;
    core_stale_ = true;
}

Index OwnedRegion::vertex_of_row(Index row, const LaneArray<double>* shrink) {
    Index& v = local_vertex_[at(row)];
    if (v < 0) {
        v = static_cast<Index>(row_.size());
        row_.push_back(row);
        u_.push_back(0.0);
        loaded_u_.push_back(0.0);
        shrink_.push_back(shrink != nullptr ? (*shrink)[at(row)].lane[lane_] : 1.0);
        start_angle_.push_back(0.0);
    }
    return v;
}

void OwnedRegion::start(Index cone, double curvature, int rings) {
    clear();
    const LaneSurface& s = *surface_;
    cone_row_ = cone;
    cone_curvature_ = curvature / s.side;
    // Breadth first by rows; local_vertex_ marks those seen until they are numbered the other way round.
    queue_.assign(1, cone);
    local_vertex_[at(cone)] = 0;
    std::vector<Index>& ring_end = ring_begin_;
    ring_end.assign(1, 1);
    for (std::size_t k = 0, ring = 0; static_cast<int>(ring) < rings; ++ring) {
        for (const std::size_t end = queue_.size(); k < end; ++k) {
            for (Index c = s.corner_begin[at(queue_[k])]; c < s.corner_begin[at(queue_[k]) + 1]; ++c) {
                const Index h = s.corner[at(c)];
                for (const Index neighbour : {next_halfedge(h), prev_halfedge(h)}) {
                    const Index row = s.triangulation.tail[at(neighbour)];
                    if (row >= s.unknowns || local_vertex_[at(row)] >= 0) continue;
                    local_vertex_[at(row)] = 0;
                    queue_.push_back(row);
                }
            }
        }
        // Something must be left to hold the patch.
        if (4 * static_cast<Index>(queue_.size()) > s.unknowns && ring_end.size() > 1) {
            for (std::size_t q = at(ring_end.back()); q < queue_.size(); ++q)
                local_vertex_[at(queue_[q])] = -1;
            queue_.resize(at(ring_end.back()));
            break;
        }
        ring_end.push_back(static_cast<Index>(queue_.size()));
    }
    for (const Index row : queue_) local_vertex_[at(row)] = -1;
    patch_ = static_cast<Index>(queue_.size());
    for (Index& end : ring_begin_) end = patch_ - end;
    for (auto row = queue_.rbegin(); row != queue_.rend(); ++row) vertex_of_row(*row, nullptr);
    for (Index v = 0; v < patch_; ++v) {
        const auto row = at(row_[at(v)]);
        for (Index c = s.corner_begin[row]; c < s.corner_begin[row + 1]; ++c)
            add_face(face_of(s.corner[at(c)]), nullptr);
    }
}

void OwnedRegion::add_face(Index face, const LaneArray<double>* shrink) {
    const auto bit = static_cast<LaneMask>(1U << lane_);
    if (((*owned_)[at(face)] & bit) != 0) return;
    (*owned_)[at(face)] |= bit;
    taken_.push_back(face);
    const LaneSurface& s = *surface_;
    const auto first = static_cast<Index>(tail_.size());
    for (Index k = 0; k < 3; ++k) {
        const Index h = 3 * face + k;
        const Index v = vertex_of_row(s.triangulation.tail[at(h)], shrink);
        start_angle_[at(v)] += s.angle[at(h)];
        tail_.push_back(v);
        chord_.push_back(s.chord[at(h)]);
        twin_.push_back(-1);
        start_halfedge_.push_back(h);
        local_halfedge_[at(h)] = first + k;
    }
    for (Index k = 0; k < 3; ++k) {
        const Index h = first + k, outside = s.triangulation.twin[at(3 * face + k)];
        if (outside == kNoTwin || twin_[at(h)] >= 0) continue;
        const Index other = local_halfedge_[at(outside)];
        if (other < 0) continue;
        twin_[at(h)] = other;
        twin_[at(other)] = h;
        local_halfedge_[at(outside)] = -1;
        local_halfedge_[at(3 * face + k)] = -1;
    }
    core_stale_ = true;
}

void OwnedRegion::take_edge(Index edge, const LaneArray<double>& shrink) {
    add_face(surface_->edges.face[2 * at(edge)], &shrink);
    add_face(surface_->edges.face[2 * at(edge) + 1], &shrink);
}

void OwnedRegion::load(const LaneArray<double>& u, const LaneArray<double>& shrink) {
    for (std::size_t v = 0; v < row_.size(); ++v) {
        const auto row = at(row_[v]);
        shrink_[v] = shrink[row].lane[lane_];
        if (v < at(patch_)) loaded_u_[v] = u_[v] = u[row].lane[lane_];
    }
    core_fresh_ = false;
}

void OwnedRegion::store(LaneArray<double>& u, LaneArray<double>& shrink, LaneArray<float>& step) const {
    for (std::size_t v = 0; v < at(patch_); ++v) {
        const auto row = at(row_[v]);
        u[row].lane[lane_] = u_[v];
        shrink[row].lane[lane_] = shrink_[v];
        step[row].lane[lane_] += static_cast<float>(u_[v] - loaded_u_[v]);
    }
}

bool OwnedRegion::edge_fails(Index h, const LaneArray<double>& shrink) const {
    const Index n = next_halfedge(h), p = prev_halfedge(h), t = twin_[at(h)];
    const double i = shrink_[at(tail_[at(h)])], j = shrink_[at(tail_[at(n)])], k = shrink_[at(tail_[at(p)])];
    double il = 0.0, lj = 0.0, l = 0.0;
    if (t >= 0) {
        if (face_of(t) == face_of(h)) return false;
        il = chord_[at(next_halfedge(t))];
        lj = chord_[at(prev_halfedge(t))];
        l = shrink_[at(tail_[at(prev_halfedge(t))])];
    } else {
        const LaneSurface& s = *surface_;
        const Index outside = s.triangulation.twin[at(start_halfedge_[at(h)])];
        if (outside == kNoTwin) return false;
        il = s.chord[at(next_halfedge(outside))];
        lj = s.chord[at(prev_halfedge(outside))];
        l = shrink[at(s.triangulation.tail[at(prev_halfedge(outside))])].lane[lane_];
    }
    return fails_delaunay({chord_[at(h)], chord_[at(n)], chord_[at(p)], il, lj}, i, j, k, l);
}

void OwnedRegion::flip(Index h) {
    const Index t = twin_[at(h)];
    const Index hn = next_halfedge(h), hp = prev_halfedge(h), tn = next_halfedge(t), tp = prev_halfedge(t);
    const double diagonal =
        (chord_[at(hp)] * chord_[at(tp)] + chord_[at(tn)] * chord_[at(hn)]) / chord_[at(h)];
    // Slot h takes over what tn was, slot t what hn was, as in flip_edge().
    const auto moved = [&](Index x) { return x == tn ? h : (x == hn ? t : x); };
    const Index outer_tn = moved(twin_[at(tn)]), outer_hn = moved(twin_[at(hn)]);
    const auto move = [&](Index from, Index to, Index outer) {
        chord_[at(to)] = chord_[at(from)];
        twin_[at(to)] = outer;
        if (outer >= 0) {
            twin_[at(outer)] = to;
        } else {
            start_halfedge_[at(to)] = start_halfedge_[at(from)];
            local_halfedge_[at(start_halfedge_[at(to)])] = to;
        }
    };
    move(tn, h, outer_tn);
    move(hn, t, outer_hn);
    chord_[at(hn)] = chord_[at(tn)] = diagonal;
    tail_[at(hn)] = tail_[at(tp)];
    tail_[at(tn)] = tail_[at(hp)];
    twin_[at(hn)] = tn;
    twin_[at(tn)] = hn;
    ++flips_;
    core_stale_ = true;
}

bool OwnedRegion::make_delaunay(const LaneArray<double>& shrink) {
    stack_.clear();
    for (Index h = static_cast<Index>(tail_.size()) - 1; h >= 0; --h)
        if (twin_[at(h)] < h) stack_.push_back(h);  // every edge once, rim included
    return flip_stack(shrink, 1000 + 2 * static_cast<std::int64_t>(tail_.size()));
}

bool OwnedRegion::make_core_delaunay(Index first, const LaneArray<double>& shrink) {
    find_core(first);
    stack_.clear();
    for (const Index f : core_)
        for (Index h = 3 * f; h < 3 * f + 3; ++h)
            if (twin_[at(h)] < h || !in_core_[at(face_of(twin_[at(h)]))]) stack_.push_back(h);  // once
    // A step so long that edges flip without end is too long.
    return flip_stack(shrink, 20 + static_cast<std::int64_t>(core_.size()));
}

bool OwnedRegion::flip_stack(const LaneArray<double>& shrink, std::int64_t most) {
    const std::int64_t bound = flips_ + most;
    while (!stack_.empty()) {
        const Index h = stack_.back();
        stack_.pop_back();
        if (!edge_fails(h, shrink)) continue;
        if (flips_ >= bound) return false;
        if (twin_[at(h)] < 0) {
            const Index outside = surface_->triangulation.twin[at(start_halfedge_[at(h)])];
            const auto added = static_cast<Index>(tail_.size());
            add_face(face_of(outside), &shrink);
            for (Index side = added; side < added + 3; ++side) stack_.push_back(side);
            if (twin_[at(h)] < 0 || face_of(twin_[at(h)]) == face_of(h)) continue;
        }
        const Index t = twin_[at(h)];
        flip(h);
        for (const Index side : {h, prev_halfedge(h), t, prev_halfedge(t)}) stack_.push_back(side);
    }
    return true;
}

void OwnedRegion::find_core(Index first) {
    if (!core_stale_ && core_first_ == first) return;
    core_.clear();
    rest_.clear();
    in_core_.resize(at(face_count()));
    for (Index f = 0; f < face_count(); ++f) {
        bool inside = false;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index v = tail_[3 * at(f) + k];
            inside = inside || (v >= first && v < patch_);
        }
        (inside ? core_ : rest_).push_back(f);
        in_core_[at(f)] = inside ? 1 : 0;
    }
    core_stale_ = false;
    core_first_ = first;
    core_fresh_ = false;
}

bool OwnedRegion::evaluate_thin(std::size_t h) {
    using Real = long double;
    Real length[3];
    for (std::size_t k = 0; k < 3; ++k)  // relative, so the third corner's factor is left out
        length[k] = Real(chord_[h + k]) * std::sqrt(Real(shrink_[at(tail_[h + (k + 2) % 3])]));
    const TriangleTerms<Real> t = triangle_terms<0>(length[0], length[1], length[2]);
    for (std::size_t k = 0; k < 3; ++k) {
        angle_[h + k] = static_cast<double>(std::atan2(t.root, t.numerator[k]));
        cot_[h + k] = static_cast<double>(t.numerator[k] / t.root);
    }
    return t.radicand > Real(0);
}

bool OwnedRegion::evaluate(std::span<const Index> faces) {
    angle_.resize(tail_.size());
    cot_.resize(tail_.size());
    SquaredTriangles block;
    bool good = true;
    for (std::size_t begin = 0; begin < faces.size(); begin += kFaceBlock) {
        block.count = static_cast<int>(std::min<std::size_t>(kFaceBlock, faces.size() - begin));
        const auto count = static_cast<std::size_t>(block.count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t h = 3 * at(faces[begin + i]);
            block.square[0][i] = chord_[h + 1] * chord_[h + 1] * shrink_[at(tail_[h])];
            block.square[1][i] = chord_[h + 2] * chord_[h + 2] * shrink_[at(tail_[h + 1])];
            block.square[2][i] = chord_[h] * chord_[h] * shrink_[at(tail_[h + 2])];
        }
        evaluate_triangles(block);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t h = 3 * at(faces[begin + i]);
            // Squares of the sides lose half the digits of a thin triangle's area.
            const double largest = std::max({block.square[0][i], block.square[1][i], block.square[2][i]});
            if (!(block.radicand[i] > 1e-6 * largest * largest)) {
                good = evaluate_thin(h) && good;
                continue;
            }
            for (std::size_t k = 0; k < 3; ++k) {
                angle_[h + k] = block.angle[k][i];
                cot_[h + k] = block.cot[k][i];
            }
        }
    }
    return good;
}

double OwnedRegion::patch_residual(Index first) {
    angle_sum_.assign(row_.size(), 0.0);
    for (const Index f : core_)
        for (std::size_t h = 3 * at(f); h < 3 * at(f) + 3; ++h) angle_sum_[at(tail_[h])] += angle_[h];
    residual_.resize(at(patch_));
    double largest = 0.0;
    for (std::size_t v = at(first); v < at(patch_); ++v) {
        double r = surface_->residual[at(row_[v])] + (angle_sum_[v] - start_angle_[v]);
        if (row_[v] == cone_row_) r += cone_curvature_;
        residual_[v] = r;
        largest = std::max(largest, std::abs(r));
        if (!(std::abs(r) < 1e300)) return std::abs(r);
    }
    return largest;
}

namespace {

/// L L^T of a symmetric matrix stored by rows from their first nonzero, in place; the
/// diagonal holds the inverse pivots' roots. False: not positive definite.
RICCI_VECTOR_CLONES bool factor_skyline(std::span<const Index> first, std::span<const Index> begin,
                                        double* value, Index n) {
    for (Index i = 0; i < n; ++i) {
        double* row = value + begin[at(i)] - first[at(i)];  // row[j] is entry (i, j)
        for (Index j = first[at(i)]; j <= i; ++j) {
            const double* other = value + begin[at(j)] - first[at(j)];
            const Index k0 = std::max(first[at(i)], first[at(j)]);
            double sum = 0.0;
#pragma omp simd reduction(+ : sum)
            for (Index k = k0; k < j; ++k) sum += row[k] * other[k];
            if (j < i) {
                row[j] = (row[j] - sum) * other[j];
            } else {
                const double pivot = row[i] - sum;
                if (!(pivot > 0.0)) return false;
                row[i] = 1.0 / std::sqrt(pivot);
            }
        }
    }
    return true;
}

/// Solves with that factor in `x`.
RICCI_VECTOR_CLONES void solve_skyline(std::span<const Index> first, std::span<const Index> begin,
                                       const double* value, double* x, Index n) {
    for (Index i = 0; i < n; ++i) {
        const double* row = value + begin[at(i)] - first[at(i)];
        double sum = 0.0;
#pragma omp simd reduction(+ : sum)
        for (Index k = first[at(i)]; k < i; ++k) sum += row[k] * x[k];
        x[i] = (x[i] - sum) * row[i];
    }
    for (Index i = n - 1; i >= 0; --i) {
        const double* row = value + begin[at(i)] - first[at(i)];
        const double xi = x[i] = x[i] * row[i];
#pragma omp simd
        for (Index k = first[at(i)]; k < i; ++k) x[k] -= row[k] * xi;
    }
}

}  // namespace

bool OwnedRegion::factorize(Index first) {
    const Index n = patch_ - first;
    factor_first_ = -1;
    skyline_first_.resize(at(n));
    skyline_begin_.resize(at(n) + 1);
    for (Index i = 0; i < n; ++i) skyline_first_[at(i)] = i;
    const auto for_edges = [&](auto&& visit) {
        for (const Index f : core_) {
            for (Index h = 3 * f; h < 3 * f + 3; ++h) {
                const Index i = tail_[at(h)] - first, j = tail_[at(next_halfedge(h))] - first;
                if (i != j) visit(i, j, prev_halfedge(h));
            }
        }
    };
    const auto inside = [&](Index i) { return i >= 0 && i < n; };
    for_edges([&](Index i, Index j, Index) {
        if (inside(i) && inside(j)) {
            Index& lowest = skyline_first_[at(std::max(i, j))];
            lowest = std::min(lowest, std::min(i, j));
        }
    });
    skyline_begin_[0] = 0;
    for (Index i = 0; i < n; ++i)
        skyline_begin_[at(i) + 1] = skyline_begin_[at(i)] + (i - skyline_first_[at(i)] + 1);
    skyline_.assign(at(skyline_begin_[at(n)]), 0.0);
    const auto entry = [&](Index i, Index j) -> double& {
        return skyline_[at(skyline_begin_[at(i)] + j - skyline_first_[at(i)])];
    };
    for_edges([&](Index i, Index j, Index opposite) {
        const double weight = 0.5 * cot_[at(opposite)];
        if (inside(i)) entry(i, i) += weight;
        if (inside(j)) entry(j, j) += weight;
        if (inside(i) && inside(j)) entry(std::max(i, j), std::min(i, j)) -= weight;
    });
    if (!factor_skyline(skyline_first_, skyline_begin_, skyline_.data(), n)) return false;
    factor_first_ = first;
    return true;
}

bool OwnedRegion::settle(Index first, bool flips, const LaneArray<double>& shrink) {
    if (exhausted() || (flips && !make_core_delaunay(first, shrink))) return false;
    find_core(first);
    work_ += static_cast<std::int64_t>(core_.size());
    return evaluate(core_);
}

bool OwnedRegion::try_step(Index first, double length, double& largest, bool flips,
                           const LaneArray<double>& shrink) {
    for (std::size_t k = 0; k < direction_.size(); ++k) {
        const std::size_t v = at(first) + k;
        u_[v] = before_u_[k] + length * direction_[k];
        shrink_[v] = std::exp(-u_[v]);
    }
    if (!settle(first, flips, shrink)) return false;
    const double reached = patch_residual(first);
    double slope = 0.0;
    for (std::size_t k = 0; k < direction_.size(); ++k) slope += residual_[at(first) + k] * direction_[k];
    if (!(slope >= 0.0 || reached <= 0.5 * largest)) return false;
    largest = reached;
    return true;
}

bool OwnedRegion::relax_from(Index first, double goal, bool flips, const LaneArray<double>& shrink) {
    constexpr int kSteps = 50, kHalvings = 20;
    if (!settle(first, flips, shrink)) return false;
    double largest = patch_residual(first);
    bool fresh = false;  // the factor is of this very point
    for (int step = 0; largest > goal && step < kSteps; ++step) {
        if (factor_first_ != first || (step > 0 && !fresh)) {
            if (!factorize(first)) break;
            fresh = true;
        }
        direction_.assign(residual_.begin() + first, residual_.end());
        solve_skyline(skyline_first_, skyline_begin_, skyline_.data(), direction_.data(), patch_ - first);
        ++newton_steps_;
        before_u_.assign(u_.begin() + first, u_.begin() + patch_);
        const double before = largest;
        bool accepted = false;
        double length = 1.0;
        for (int attempt = 0; attempt < (fresh ? kHalvings : 1) && !accepted; ++attempt, length *= 0.5)
            accepted = try_step(first, length, largest, flips, shrink);
        if (!accepted) {
            direction_.assign(direction_.size(), 0.0);
            largest = std::numeric_limits<double>::infinity();
            if (!try_step(first, 0.0, largest, flips, shrink)) return false;
            if (fresh) break;  // no way down from here; the global steps go on
            factor_first_ = -1;
            continue;
        }
        // An old factor is good for as long as it keeps halving the digits' worth of work.
        fresh = largest < 0.1 * before;
    }
    return std::isfinite(largest);
}

void OwnedRegion::blunt(int rings) {
    const auto flat = std::clamp<std::size_t>(static_cast<std::size_t>(rings), 1, ring_begin_.size() - 1);
    const Index inner = ring_begin_[flat - 1], outer = ring_begin_[flat];
    double sum = 0.0;
    for (Index v = outer; v < inner; ++v) sum += u_[at(v)];
    const double level = sum / static_cast<double>(std::max<Index>(inner - outer, 1));
    for (Index v = 0; v < patch_; ++v) {
        const bool beyond = cone_curvature_ < 0.0 ? u_[at(v)] < level : u_[at(v)] > level;
        if (!beyond) continue;
        u_[at(v)] = level;
        shrink_[at(v)] = std::exp(-level);
    }
}

bool OwnedRegion::relax_first(const LaneArray<double>& shrink) {
    const double power = 1.0 - surface_->side * cone_curvature_ / (2.0 * std::numbers::pi);
    const int rings = static_cast<int>(ring_begin_.size()) - 1;
    bool usable = false;
    for (int flat = std::max(1, static_cast<int>(std::lround(power - 1.0))); !usable; ++flat) {
        blunt(flat);
        usable = settle(0, true, shrink);
        if (flat >= rings) break;
    }
    if (!usable) return false;
    // The outer rings are worth moving only once the tip has found its shape.
    const std::size_t tip = 3;
    if (tip < ring_begin_.size() && !relax_from(ring_begin_[tip], 0.1, true, shrink)) return false;
    return relax_from(0, 1e-2, true, shrink);
}

bool OwnedRegion::relax(double goal, bool flips, const LaneArray<double>& shrink) {
    const bool usable = relax_from(0, goal, flips, shrink);
    core_fresh_ = usable && core_first_ == 0 && !core_stale_;
    return usable;
}

bool OwnedRegion::add_residual(LaneArray<double>& residual) {
    find_core(0);
    bool good = core_fresh_ || evaluate(core_);
    good = evaluate(rest_) && good;
    angle_sum_.assign(row_.size(), 0.0);
    for (std::size_t h = 0; h < tail_.size(); ++h) angle_sum_[at(tail_[h])] += angle_[h];
    for (std::size_t v = 0; v < row_.size(); ++v)
        residual[at(row_[v])].lane[lane_] += angle_sum_[v] - start_angle_[v];
    residual[at(cone_row_)].lane[lane_] += cone_curvature_;
    return good;
}

}  // namespace ricci
