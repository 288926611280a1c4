// SweepWorker::run: vertices in lanes, with Newton's method for what they leave.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

#include "engine/sweep/area_distortion.h"
#include "engine/sweep/sweep_solver.h"

namespace ricci {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

/// What a solve by Newton's method comes after.
struct SweepWorker::Start {
    Index vertex = 0;
    double elapsed = 0.0;  // seconds in a lane, which count for a time-out
    double seconds = 0.0;  // its share of them
};

/// Stands between a SweepStream and a LaneSolver for one run of the latter: keeps the time of each lane, and
/// what is left over for Newton's method.
class SweepWorker::LaneFeed {
  public:
    LaneFeed(const SweepSurface& surface, const SweepStream& stream, int lanes)
        : surface_(&surface), stream_(&stream), lanes_(static_cast<std::size_t>(lanes)) {
        // Where memory runs out later, no vertex is lost.
        under_way_.reserve(lanes_);
        left_over_.reserve(2 * lanes_);
    }

    [[nodiscard]] LaneStream lane_stream() {
        return {[this] { return next(); }, [this](LaneSolve solve) { finish(std::move(solve)); },
                stream_->interrupted};
    }
    /// The stream had no more.
    [[nodiscard]] bool ended() const { return ended_; }
    [[nodiscard]] const std::vector<Start>& left_over() const { return left_over_; }

    void leave_all_under_way() {
        advance();
        for (const UnderWay& lane : under_way_)
            left_over_.push_back({lane.vertex, seconds_since(lane.begun), share_ - lane.share});
        under_way_.clear();
    }

  private:
    struct UnderWay {
        Index vertex;
        Clock::time_point begun;
        double share;
    };

    std::optional<Index> next() {
        // Newton's turn first, lest one worker gathers many while others have nothing to do.
        if (left_over_.size() >= lanes_) return std::nullopt;
        advance();
        const std::optional<Index> vertex = stream_->next();
        if (!vertex) {
            ended_ = true;
            return std::nullopt;
        }
        const std::vector<Index>& candidates = surface_->candidates();
        if (!std::binary_search(candidates.begin(), candidates.end(), *vertex))
            throw std::invalid_argument(
                fmt::format("vertex {} is no interior vertex of this surface", *vertex));
        last_ = Clock::now();
        under_way_.push_back({*vertex, last_, share_});
        return vertex;
    }

    void finish(LaneSolve solve) {
        advance();
        const auto lane = std::find_if(under_way_.begin(), under_way_.end(), [&](const UnderWay& candidate) {
            return candidate.vertex == solve.vertex;
        });
        const double seconds = share_ - lane->share;
        if (solve.converged || solve.interrupted) {
            stream_->finished(result_of(std::move(solve), seconds));
        } else {
            left_over_.push_back({solve.vertex, seconds_since(lane->begun), seconds});
        }
        under_way_.erase(lane);
        last_ = Clock::now();
    }

    [[nodiscard]] SweepSolve result_of(LaneSolve solve, double seconds) const {
        SweepSolve result;
        result.vertex = solve.vertex;
        result.status = solve.interrupted.value_or(Status::converged);
        result.residual_max = solve.residual_max;
        result.gauss_bonnet_error = solve.gauss_bonnet_error;
        result.newton_iterations = solve.steps;
        result.flips = solve.flips;
        result.seconds = seconds;
        result.conformal_factor = std::move(solve.conformal_factor);
        if (solve.interrupted) {
            result.area_distortion = std::numeric_limits<double>::quiet_NaN();
            result.message = fmt::format("residual {:.3g} after {} steps", solve.residual_max, solve.steps);
        } else {
            result.area_distortion = area_distortion_of_scaling(
                surface_->area_, surface_->mesh_.connectivity.tail, result.conformal_factor);
        }
        return result;
    }

    /// Moves `share_` on to now: it grows by the time over the lanes under way, so that the difference over a
    /// solve is its share. The stream's own time does not count.
    void advance() {
        const auto now = Clock::now();
        if (!under_way_.empty())
            share_ +=
                std::chrono::duration<double>(now - last_).count() / static_cast<double>(under_way_.size());
        last_ = now;
    }

    const SweepSurface* surface_;
    const SweepStream* stream_;
    std::size_t lanes_;
    bool ended_ = false;
    std::vector<UnderWay> under_way_;
    std::vector<Start> left_over_;
    double share_ = 0.0;
    Clock::time_point last_ = Clock::now();
};

void SweepWorker::run(const SweepStream& stream) {
    if (lanes_ == 0) {
        while (const auto vertex = stream.next()) stream.finished(solve_alone({*vertex}, stream));
        return;
    }
    for (bool ended = false; !ended;) {
        LaneFeed feed(*shared_, stream, lanes_);
        run_lanes(feed);
        for (const Start& start : feed.left_over()) stream.finished(solve_alone(start, stream));
        ended = feed.ended();
    }
}

void SweepWorker::run_lanes(LaneFeed& feed) {
    if (!lane_solver_)
        lane_solver_ = std::make_unique<LaneSolver>(
            shared_->lane_surface_, shared_->mesh_.connectivity.vertex_count, shared_->lane_options(lanes_));
    try {
        lane_solver_->run(feed.lane_stream());
    } catch (const std::bad_alloc&) {
        lane_solver_.reset();
        feed.leave_all_under_way();
    } catch (...) {
        lane_solver_.reset();  // its lanes are half done
        throw;
    }
}

SweepSolve SweepWorker::solve_alone(const Start& start, const SweepStream& stream) {
    const auto begun = Clock::now();
    const auto interrupted = [&]() -> std::optional<Status> {
        return stream.interrupted ? stream.interrupted(start.elapsed + seconds_since(begun)) : std::nullopt;
    };
    SweepSolve result;
    try {
        result = solve(start.vertex, interrupted);
        result.seconds += start.seconds;
    } catch (const std::bad_alloc&) {
        drop_newton();
        result.vertex = start.vertex;
        result.status = Status::out_of_memory;
        result.area_distortion = std::numeric_limits<double>::quiet_NaN();
        result.seconds = start.seconds + seconds_since(begun);
        result.message = "memory ran out during the solve";
    }
    return result;
}

}  // namespace ricci
