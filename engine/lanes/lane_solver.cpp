#include "engine/lanes/lane_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/lane_vectors.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Anderson's acceleration of one lane: minimises the residual over the last changes in the norm of the
/// preconditioner, <r, f> with f the preconditioned r. Of the changes' Gram matrix <dr_a, df_b>, which the
/// preconditioner makes symmetric, only what the newest change adds is computed.
struct Acceleration {
    int count = 0;
    std::array<double, kLaneHistory> projection{}, weight{};
    std::array<std::array<double, kLaneHistory>, kLaneHistory> gram{};

    /// After global step number `steps` (0: the first).
    void remember(const LaneProducts& products, std::size_t lane, int steps, int depth) {
        weight = {};
        if (steps == 0 || depth == 0) {
            count = 0;
            return;
        }
        const auto last = static_cast<std::size_t>(depth) - 1;
        for (std::size_t a = last; a > 0; --a)
            for (std::size_t b = last; b > 0; --b) gram[a][b] = gram[a - 1][b - 1];
        for (std::size_t a = last; a > 0; --a) {
            gram[a][0] = gram[0][a] = products.change[a].lane[lane] - projection[a - 1];
            projection[a] = products.change[a].lane[lane];
        }
        gram[0][0] = products.change[0].lane[lane] - products.newest_before.lane[lane];
        projection[0] = products.change[0].lane[lane];
        count = std::min(count + 1, depth);
        // The first change is the jump from the flat start: nothing to learn from.
        solve(static_cast<std::size_t>(std::min(count, steps - 1)));
    }

  private:
    /// Cholesky, newest first, so that a vanishing pivot drops the oldest.
    void solve(std::size_t size) {
        std::array<std::array<double, kLaneHistory>, kLaneHistory> factor{};
        std::size_t used = 0;
        for (; used < size; ++used) {
            for (std::size_t b = 0; b <= used; ++b) {
                double value = gram[used][b];
                for (std::size_t k = 0; k < b; ++k) value -= factor[used][k] * factor[b][k];
                factor[used][b] = b < used ? value / factor[b][b] : value;
            }
            if (!(factor[used][used] > 1e-5 * gram[used][used])) break;
            factor[used][used] = std::sqrt(factor[used][used]);
        }
        for (std::size_t a = 0; a < used; ++a) {
            double value = projection[a];
            for (std::size_t k = 0; k < a; ++k) value -= factor[a][k] * weight[k];
            weight[a] = value / factor[a][a];
        }
        for (std::size_t a = used; a-- > 0;) {
            for (std::size_t k = a + 1; k < used; ++k) weight[a] -= factor[k][a] * weight[k];
            weight[a] /= factor[a][a];
        }
    }
};

/// Rings of the patch for a cone.
int rings_for(double cone_curvature) {
    const double chi = std::abs(cone_curvature) / (2.0 * std::numbers::pi);
    // Measured: fewer rings cost global steps, more cost time on the patch.
    return std::clamp(3 + static_cast<int>(std::lround(chi)), 4, 14);
}

}  // namespace

/// One singularity under way.
struct LaneSolver::Lane {
    Lane(const LaneSurface& surface, int number, std::vector<LaneMask>& owned)
        : index(number), region(surface, number, owned) {}

    int index;
    OwnedRegion region;
    bool active = false;
    Index vertex = 0;
    int steps = 0;
    double residual = 0.0, best = 0.0;
    int no_progress = 0;
    bool sound = true;     // the region's faces are triangles, its flips ended
    bool checked = false;  // Delaunay everywhere at the current u
    Acceleration acceleration;
    Clock::time_point begun;
};

LaneSolver::LaneSolver(std::shared_ptr<const LaneSurface> surface, Index vertex_count,
                       const LaneOptions& options)
    : surface_(std::move(surface)), options_(options), vertex_count_(vertex_count) {
    const LaneSurface& s = *surface_;
    options_.lanes = std::clamp(options_.lanes, 1, kLanes);
    options_.history = std::clamp(options_.history, 0, kLaneHistory);
    if (options_.rings <= 0) options_.rings = rings_for(options_.cone_curvature);
    row_of_vertex_ = s.rows_of_vertices(vertex_count);
    const std::size_t rows = at(s.rows());
    for (auto* array : {&u_, &shrink_, &residual_}) array->assign(rows, LaneRow<double>{});
    for (auto* array : {&step_, &right_, &previous_right_, &solution_, &previous_solution_})
        array->assign(rows, LaneRow<float>{});
    history_.right.assign(static_cast<std::size_t>(options_.history), LaneArray<float>(rows));
    history_.point = history_.right;
    owned_.assign(at(s.faces.face_count()), 0);
    for (int l = 0; l < options_.lanes; ++l) lanes_.push_back(std::make_unique<Lane>(s, l, owned_));
}

LaneSolver::~LaneSolver() = default;

std::int64_t LaneSolver::predicted_bytes(Index rows, Index faces, const LaneOptions& options) {
    const std::int64_t per_row = kLanes * (3 * 8 + (5 + 2 * options.history) * 4) + 4;
    const std::int64_t lanes = options.lanes;
    // A lane: its two maps, and a region that rarely holds a fifth of the faces.
    const std::int64_t region = 4 * rows + 12 * static_cast<std::int64_t>(faces) + 110 * (faces / 5);
    return per_row * rows + 2 * faces + lanes * region;
}

bool LaneSolver::any_active() const {
    return std::any_of(lanes_.begin(), lanes_.end(), [](const auto& lane) { return lane->active; });
}

void LaneSolver::run(const LaneStream& stream) {
    for (const auto& lane : lanes_) fill(*lane, stream);
    while (any_active()) {
        step();
        follow_lanes();
        measure();
        judge(stream);
    }
}

void LaneSolver::fill(Lane& lane, const LaneStream& stream) {
    const LaneSurface& s = *surface_;
    const std::optional<Index> vertex = stream.next();
    lane.active = vertex.has_value();
    const auto l = static_cast<std::size_t>(lane.index);
    const auto start = [&](std::size_t r, double value) {
        u_[r].lane[l] = 0.0;
        right_[r].lane[l] = static_cast<float>(value);
    };
    if (!vertex) {
        for (std::size_t r = 0; r < u_.size(); ++r) start(r, 0.0);
        lane.region.clear();
        return;
    }
    for (std::size_t r = 0; r < u_.size(); ++r) start(r, s.residual[r]);
    lane.begun = Clock::now();
    lane.vertex = *vertex;
    lane.steps = lane.no_progress = 0;
    lane.sound = true;
    const Index cone = row_of_vertex_[at(*vertex)];
    right_[at(cone)].lane[l] += static_cast<float>(options_.cone_curvature / s.side);
    lane.residual = lane.best = std::numeric_limits<double>::infinity();
    lane.region.start(cone, options_.cone_curvature, options_.rings);
}

void LaneSolver::finish(Lane& lane, const LaneStream& stream, bool converged,
                        std::optional<Status> interrupted) {
    LaneSolve solve;
    solve.vertex = lane.vertex;
    solve.converged = converged;
    solve.interrupted = interrupted;
    solve.residual_max = lane.residual;
    double change = 0.0;
    for (const LaneRow<double>& row : residual_) change += row.lane[static_cast<std::size_t>(lane.index)];
    solve.gauss_bonnet_error =
        std::abs(surface_->gauss_bonnet_excess + options_.cone_curvature - surface_->side * change);
    solve.steps = lane.steps;
    solve.patch_steps = lane.region.newton_steps();
    solve.flips = lane.region.flips();
    solve.conformal_factor.assign(at(vertex_count_), 0.0);
    const LaneSurface& s = *surface_;
    const auto l = static_cast<std::size_t>(lane.index);
    double mean = 0.0;
    if (s.scale_free) {
        for (std::size_t r = 0; r < at(s.unknowns); ++r) mean += u_[r].lane[l];
        mean /= static_cast<double>(s.unknowns);
    }
    for (std::size_t r = 0; r < at(s.unknowns); ++r)
        solve.conformal_factor[at(s.vertex_of_row[r])] = u_[r].lane[l] - mean;
    stream.finished(std::move(solve));
    if (!converged) forget(lane);
    fill(lane, stream);
}

void LaneSolver::forget(const Lane& lane) {
    const auto l = static_cast<std::size_t>(lane.index);
    const auto clear = [l](LaneArray<float>& array) {
        for (LaneRow<float>& row : array) row.lane[l] = 0.0F;
    };
    for (auto* array : {&step_, &right_, &previous_right_, &solution_, &previous_solution_}) clear(*array);
    for (auto* changes : {&history_.right, &history_.point})
        for (LaneArray<float>& change : *changes) clear(change);
}

void LaneSolver::precondition() {
    const LaneSurface& s = *surface_;
    std::copy(right_.begin(), right_.begin() + s.unknowns, solution_.begin());
    if (s.pinned_row >= 0) solution_[at(s.pinned_row)] = LaneRow<float>{};
    s.factor->solve(solution_);
}

void LaneSolver::step() {
    const LaneSurface& s = *surface_;
    precondition();
    if (options_.history > 0) {
        std::rotate(history_.right.begin(), history_.right.end() - 1, history_.right.end());
        std::rotate(history_.point.begin(), history_.point.end() - 1, history_.point.end());
    }
    const LaneProducts products =
        lane_products(s.unknowns, right_, previous_right_, solution_, previous_solution_, history_);
    LaneRow<float> mean{};
    std::array<LaneRow<float>, kLaneHistory> weight{};
    LaneMask active = 0;
    for (const auto& lane : lanes_) {
        if (!lane->active) continue;
        const auto l = static_cast<std::size_t>(lane->index);
        active = static_cast<LaneMask>(active | (1U << lane->index));
        if (s.scale_free) mean.lane[l] = static_cast<float>(products.sum.lane[l] / s.unknowns);
        lane->acceleration.remember(products, l, lane->steps, options_.history);
        for (std::size_t a = 0; a < static_cast<std::size_t>(options_.history); ++a)
            weight[a].lane[l] = static_cast<float>(lane->acceleration.weight[a]);
    }
    lane_step(s.unknowns, active, solution_, previous_solution_, mean, weight, history_, step_, u_);
    lane_exponentials(u_, shrink_);
    std::swap(right_, previous_right_);
    std::swap(solution_, previous_solution_);
}

void LaneSolver::follow_lanes() {
    // Edges flip while the first steps are made, and hardly ever later: a look at the end makes sure.
    const auto wants_flips = [&](const Lane& lane) {
        return lane.residual > 1e-4 || lane.residual < 100.0 * options_.tolerance;
    };
    LaneMask wanted = 0;
    for (const auto& lane : lanes_) {
        if (!lane->active) continue;
        if (wants_flips(*lane)) wanted = static_cast<LaneMask>(wanted | (1U << lane->index));
        OwnedRegion& region = lane->region;
        region.load(u_, shrink_);
        if (lane->steps == 0) {
            lane->sound = region.relax_first(shrink_);
            for (int halving = 0; !lane->sound && halving < 8 && !region.exhausted(); ++halving) {
                shorten_step(*lane);
                region.load(u_, shrink_);
                lane->sound = region.relax_first(shrink_);
            }
        } else {
            const double goal = std::max(1e-2 * lane->residual, 1e-2 * options_.tolerance);
            lane->sound = region.relax(goal, false, shrink_) || region.relax(goal, true, shrink_);
            // A global step that breaks triangles is too long.
            for (int halving = 0; !lane->sound && halving < 6 && !region.exhausted(); ++halving) {
                shorten_step(*lane);
                region.load(u_, shrink_);
                lane->sound = region.relax(goal, true, shrink_);
            }
        }
        region.store(u_, shrink_, step_);
        ++lane->steps;
        lane->checked = false;
    }
    if (wanted == 0) return;
    find_lane_flips(surface_->edges, shrink_, owned_, flips_);
    for (const auto& lane : lanes_) {
        const LaneMask bit = static_cast<LaneMask>(1U << lane->index);
        if ((wanted & bit) == 0) continue;
        for (const LaneFlip& flip : flips_)
            if ((flip.lanes & bit) != 0) lane->region.take_edge(flip.edge, shrink_);
        lane->sound = lane->region.make_delaunay(shrink_) && lane->sound;
        lane->checked = true;
    }
}

void LaneSolver::shorten_step(const Lane& lane) {
    const auto l = static_cast<std::size_t>(lane.index);
    for (std::size_t r = 0; r < at(surface_->unknowns); ++r) {
        step_[r].lane[l] *= 0.5F;
        u_[r].lane[l] -= static_cast<double>(step_[r].lane[l]);
        shrink_[r].lane[l] = std::exp(-u_[r].lane[l]);
    }
}

void LaneSolver::measure() {
    const LaneSurface& s = *surface_;
    lane_broadcast(s.residual, residual_);
    broken_ = add_angle_changes(s.faces, shrink_, owned_, residual_);
    for (const auto& lane : lanes_)
        if (lane->active) lane->sound = lane->region.add_residual(residual_) && lane->sound;
    const LaneRow<double> largest = lane_round(residual_, s.unknowns, right_);
    for (const auto& lane : lanes_)
        lane->residual = s.side * largest.lane[static_cast<std::size_t>(lane->index)];
}

void LaneSolver::judge(const LaneStream& stream) {
    for (const auto& entry : lanes_) {
        Lane& lane = *entry;
        if (!lane.active) continue;
        const bool whole = lane.sound && (broken_ & (1U << lane.index)) == 0;
        if (whole && lane.checked && lane.residual <= options_.tolerance) {
            finish(lane, stream, true, std::nullopt);
            continue;
        }
        const bool halved = lane.residual <= 0.5 * lane.best;
        lane.no_progress = halved ? 0 : lane.no_progress + 1;
        lane.best = std::min(lane.best, lane.residual);
        const bool lost = !std::isfinite(lane.residual) || !lane.sound || lane.no_progress > 8;
        if (lost || lane.steps >= options_.max_steps) {
            finish(lane, stream, false, std::nullopt);
            continue;
        }
        if (!stream.interrupted) continue;
        const double seconds = std::chrono::duration<double>(Clock::now() - lane.begun).count();
        if (const auto status = stream.interrupted(seconds)) finish(lane, stream, false, status);
    }
}

}  // namespace ricci
