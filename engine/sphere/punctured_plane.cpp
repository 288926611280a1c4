#include "engine/sphere/punctured_plane.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

namespace ricci {
namespace {

constexpr long double kPi = std::numbers::pi_v<long double>;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// log(e^a + e^b)
long double log_sum(long double a, long double b) {
    return std::max(a, b) + std::log1p(std::exp(std::min(a, b) - std::max(a, b)));
}

/// Halfedges that leave a vertex of a closed surface, in cyclic order.
std::vector<Index> star_of(const Connectivity& c, Index vertex) {
    const auto found = std::find(c.tail.begin(), c.tail.end(), vertex);
    std::vector<Index> star;
    if (found == c.tail.end()) return star;
    const auto first = static_cast<Index>(found - c.tail.begin());
    Index h = first;
    do {
        star.push_back(h);
        h = c.twin[at(prev_halfedge(h))];
    } while (h != kNoTwin && h != first);
    return star;
}

/// Distances along edges from a vertex, its neighbours keeping the lengths of the edges that join them to it.
/// // per vertex, logarithms
std::vector<long double> log_distances(const IntrinsicTriangulation<long double>& t,
                                       std::span<const Index> star) {
    const Connectivity& c = t.connectivity;
    const long double unit = t.log_chord[at(star[0])];
    constexpr long double kFar = std::numeric_limits<long double>::infinity();
    std::vector<long double> distance(at(c.vertex_count), kFar);
    using Entry = std::pair<long double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::vector<std::vector<Index>> leaving(at(c.vertex_count));
    for (Index h = 0; h < c.halfedge_count(); ++h) leaving[at(c.tail[at(h)])].push_back(h);
    std::vector<std::uint8_t> fixed(at(c.vertex_count), 0);
    fixed[at(c.tail[at(star[0])])] = 1;
    for (const Index h : star) {
        const Index i = c.head(h);
        fixed[at(i)] = 1;
        distance[at(i)] = std::exp(t.log_chord[at(h)] - unit);
        queue.emplace(distance[at(i)], i);
    }
    while (!queue.empty()) {
        const auto [d, i] = queue.top();
        queue.pop();
        if (d > distance[at(i)]) continue;
        for (const Index h : leaving[at(i)]) {
            const Index j = c.head(h);
            const long double through = d + std::exp(t.log_chord[at(h)] - unit);
            if (fixed[at(j)] || through >= distance[at(j)]) continue;
            distance[at(j)] = through;
            queue.emplace(through, j);
        }
    }
    for (long double& d : distance) d = std::log(d) + unit;
    return distance;
}

}  // namespace

bool embedded_star(const Connectivity& c, Index vertex) {
    std::vector<Index> link;
    for (const Index h : star_of(c, vertex)) link.push_back(c.head(h));
    link.push_back(vertex);
    const std::size_t size = link.size();
    std::sort(link.begin(), link.end());
    link.erase(std::unique(link.begin(), link.end()), link.end());
    return link.size() == size && size >= 4;
}

PuncturedPlane::PuncturedPlane(const FlowSurface& surface, Index infinity, bool parallel)
    : surface_(&surface),
      parallel_(parallel),
      disk_(surface.triangulation),
      u_(surface.used.size(), 0.0L),
      curvature_(surface.used.size(), 0.0) {
    start_factor(infinity);
    std::vector<std::uint8_t> gone(at(disk_.connectivity.face_count()), 0);
    for (const Index h : star_of(disk_.connectivity, infinity)) gone[at(face_of(h))] = 1;
    remove_faces(gone);
}

/// The rim at distance 1 from infinity; elsewhere the conformal factor of an inversion, by distances along
/// edges. Newton's first step sees to the rest, curvature being nearly linear in u on a fine mesh.
void PuncturedPlane::start_factor(Index infinity) {
    const auto distance = log_distances(disk_, star_of(disk_.connectivity, infinity));
    std::vector<long double> change(u_.size(), 0.0L);
    for (std::size_t s = 0; s < distance.size(); ++s)
        if (std::isfinite(distance[s])) change[at(surface_->orbit[s])] = -2.0L * distance[s];
    scale(change);
}

/// Adds `change` (V) to u and to the lengths.
void PuncturedPlane::scale(std::span<const long double> change) {
    const Connectivity& c = disk_.connectivity;
    for (std::size_t v = 0; v < u_.size(); ++v) u_[v] += change[v];
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        if (t != kNoTwin && t < h) {
            disk_.log_chord[at(h)] = disk_.log_chord[at(t)];
            continue;
        }
        const Index i = surface_->orbit[at(c.tail[at(h)])], j = surface_->orbit[at(c.head(h))];
        disk_.log_chord[at(h)] += (change[at(i)] + change[at(j)]) / 2;
    }
}

void PuncturedPlane::find_rim() {
    const Connectivity& c = disk_.connectivity;
    on_rim_.assign(surface_->orbit.size(), 0);
    rim_orbit_.assign(u_.size(), 0);
    rim_size_ = 0;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        if (c.twin[at(h)] != kNoTwin) continue;
        ++rim_size_;
        on_rim_[at(c.tail[at(h)])] = 1;
        rim_orbit_[at(surface_->orbit[at(c.tail[at(h)])])] = 1;
    }
    unknown_.assign(u_.size(), -1);
    unknown_count_ = 0;
    for (const Index tail : c.tail) {
        const Index v = surface_->orbit[at(tail)];
        if (!rim_orbit_[at(v)]) unknown_[at(v)] = 0;
    }
    for (Index& x : unknown_)
        if (x == 0) x = unknown_count_++;
}

void PuncturedPlane::remove_faces(const std::vector<std::uint8_t>& gone) {
    const Connectivity& c = disk_.connectivity;
    std::vector<Index> slot(c.tail.size(), kNoTwin), tail, twin;
    std::vector<long double> logs;
    for (std::size_t h = 0; h < c.tail.size(); ++h) {
        if (gone[h / 3]) continue;
        slot[h] = static_cast<Index>(tail.size());
        tail.push_back(c.tail[h]);
        twin.push_back(c.twin[h]);
        logs.push_back(disk_.log_chord[h]);
    }
    for (Index& t : twin)
        if (t != kNoTwin) t = slot[at(t)];
    disk_.connectivity = connectivity_from_gluing(std::move(tail), std::move(twin), c.vertex_count);
    disk_.log_chord = std::move(logs);
    find_rim();
}

/// Brings to the rim every vertex whose triangle over a rim edge is broken. Returns whether there was one.
bool PuncturedPlane::admit() {
    const Connectivity& c = disk_.connectivity;
    // A vertex whose mirror image came to the rim follows it, though rounding may keep its triangle whole.
    constexpr long double kFollow = 1e-9L;
    std::vector<Index> best(surface_->orbit.size(), -1);
    const auto chord = [&](Index h) {
        return log_sum(disk_.log_chord[at(next_halfedge(h))], disk_.log_chord[at(prev_halfedge(h))]) -
               disk_.log_chord[at(h)];
    };
    bool any = false;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        if (c.twin[at(h)] != kNoTwin) continue;
        const Index k = c.tail[at(prev_halfedge(h))];
        const bool follows = rim_orbit_[at(surface_->orbit[at(k)])] != 0;
        if (on_rim_[at(k)] || chord(h) > (follows ? kFollow : 0.0L)) continue;
        if (best[at(k)] < 0 || chord(h) < chord(best[at(k)])) best[at(k)] = h;
        any = true;
    }
    if (!any) return false;
    std::vector<long double> change(u_.size(), 0.0L);
    std::vector<std::uint8_t> gone(at(c.face_count()), 0);
    for (std::size_t k = 0; k < best.size(); ++k) {
        if (best[k] < 0) continue;
        gone[at(face_of(best[k]))] = 1;
        const auto orbit = at(surface_->orbit[k]);
        if (!rim_orbit_[orbit]) change[orbit] = std::max(change[orbit], -2.0L * chord(best[k]));
    }
    remove_faces(gone);
    scale(change);
    return true;
}

/// Glues the flat triangle (jk = ji + ik) onto the rim at vertex i.
void PuncturedPlane::add_face_at(Index vertex) {
    Connectivity& c = disk_.connectivity;
    Index out = -1, in = -1;
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        if (c.twin[at(h)] != kNoTwin) continue;
        if (c.tail[at(h)] == vertex) out = h;
        if (c.head(h) == vertex) in = h;
    }
    const Index first = c.halfedge_count(), next = c.head(out), previous = c.tail[at(in)];
    std::vector<Index> tail = c.tail, twin = c.twin;
    tail.insert(tail.end(), {next, vertex, previous});
    twin.insert(twin.end(), {out, in, kNoTwin});
    twin[at(out)] = first;
    twin[at(in)] = first + 1;
    const long double a = disk_.log_chord[at(out)], b = disk_.log_chord[at(in)];
    disk_.log_chord.insert(disk_.log_chord.end(), {a, b, log_sum(a, b)});
    c = connectivity_from_gluing(std::move(tail), std::move(twin), c.vertex_count);
}

/// Takes from the rim vertices with an angle above pi, where total_ was evaluated. Returns whether there was
/// one.
bool PuncturedPlane::release() {
    const Connectivity& c = disk_.connectivity;
    std::vector<std::uint8_t> leaves(u_.size(), 0), stays(u_.size(), 0);
    std::vector<long double> change(u_.size(), 0.0L);
    std::vector<Index> leaving;
    Index left = rim_size_;
    for (Index in = 0; in < c.halfedge_count(); ++in) {
        if (c.twin[at(in)] != kNoTwin) continue;
        const Index i = c.head(in);
        const long double excess = total_[at(i)] - kPi;
        const auto orbit = at(surface_->orbit[at(i)]);
        if (excess <= kReflexAngle || stays[orbit] || left <= 3) continue;
        Index out = next_halfedge(in);
        while (c.twin[at(out)] != kNoTwin) out = next_halfedge(c.twin[at(out)]);
        // Neighbours on the rim wait for the next round: their angles are about to change.
        const auto before = at(surface_->orbit[at(c.tail[at(in)])]),
                   after = at(surface_->orbit[at(c.head(out))]);
        if ((leaves[before] && before != orbit) || (leaves[after] && after != orbit)) continue;
        leaves[orbit] = 1;
        if (before != orbit) stays[before] = 1;
        if (after != orbit) stays[after] = 1;
        // u grows until the new triangle takes half of the excess off: its angle at i is pi - x.
        const long double x = std::min(excess, 2.0L) / 2,
                          ratio = std::exp(disk_.log_chord[at(out)] - disk_.log_chord[at(in)]);
        const long double sine = std::sin(x / 2);
        change[orbit] = -std::log1p(-4.0L * sine * sine * ratio / ((1 + ratio) * (1 + ratio)));
        leaving.push_back(i);
        --left;
    }
    if (leaving.empty()) return false;
    for (const Index i : leaving) add_face_at(i);
    find_rim();
    scale(change);
    return true;
}

/// Evaluates the disk in the metric u (V, or empty for 0). Returns max |K| over everything off the rim.
double PuncturedPlane::evaluate(const IntrinsicTriangulation<long double>& disk, std::span<const double> u,
                                bool derivatives) {
    const Connectivity& c = disk.connectivity;
    std::vector<double> spread(surface_->orbit.size(), 0.0);
    if (!u.empty())
        for (std::size_t s = 0; s < spread.size(); ++s) spread[s] = u[at(surface_->orbit[s])];
    angle_.resize(c.tail.size());
    total_.resize(spread.size());
    FaceFields<long double> fields{angle_, {}, {}, {}};
    if (derivatives) {
        off_.resize(c.tail.size());
        diagonal_.resize(c.tail.size());
        fields.off = off_;
        fields.diagonal = diagonal_;
    }
    evaluate_faces<long double>(Geometry::euclidean, {c.tail, disk.log_chord, spread}, fields, parallel_);
    sum_corners<long double>(c.tail, angle_, total_);
    std::vector<std::uint8_t> present(spread.size(), 0);
    for (const Index v : c.tail) present[at(v)] = 1;
    std::fill(curvature_.begin(), curvature_.end(), 0.0);
    double residual = 0.0;
    for (std::size_t s = 0; s < spread.size(); ++s) {
        if (!present[s] || on_rim_[s]) continue;
        const auto k = static_cast<double>(2 * kPi - total_[s]);
        curvature_[at(surface_->orbit[s])] += k;
        residual = std::isfinite(k) ? std::max(residual, std::abs(k)) : k;
        if (!std::isfinite(k)) return std::numeric_limits<double>::infinity();
    }
    return residual;
}

bool PuncturedPlane::find_direction(SolveOutcome& outcome) {
    const Connectivity& c = disk_.connectivity;
    std::vector<Index> unknown(surface_->orbit.size());
    for (std::size_t s = 0; s < unknown.size(); ++s) unknown[s] = unknown_[at(surface_->orbit[s])];
    HessianAssembler assembler;
    assembler.build(c, unknown, unknown_count_);
    std::vector<double> values, rhs(at(unknown_count_), 0.0);
    assembler.assemble(c, off_, diagonal_, -1, values);
    for (std::size_t v = 0; v < u_.size(); ++v)
        if (unknown_[v] >= 0) rhs[at(unknown_[v])] = -curvature_[v];
    const auto solver = make_symmetric_solver(Definiteness::positive);
    solver->choose_ordering(assembler.pattern(), Ordering::minimum_degree);
    ++outcome.symbolic_analyses;
    double largest = 0.0;
    for (const Index p : assembler.diagonal_positions()) largest = std::max(largest, values[at(p)]);
    double shift = 0.0;
    for (int attempt = 0; attempt < 8; ++attempt, shift = std::max(1e-14, 100.0 * shift)) {
        std::vector<double> shifted = values;
        for (const Index p : assembler.diagonal_positions()) shifted[at(p)] += shift * largest;
        ++outcome.factorizations;
        if (!solver->factorize(shifted)) continue;
        if (shift > 0.0) ++outcome.shifted_factorizations;
        direction_.assign(rhs.size(), 0.0);
        solver->solve(rhs, direction_);
        return std::all_of(direction_.begin(), direction_.end(), [](double d) { return std::isfinite(d); });
    }
    return false;
}

/// Moves along the direction. Returns the step, 0 where none was good enough.
double PuncturedPlane::line_search(double residual) {
    double step = 1.0;
    std::vector<double> spread(surface_->orbit.size(), 0.0);
    for (int attempt = 0; attempt < 40; ++attempt, step *= 0.5) {
        trial_.assign(u_.size(), 0.0);
        for (std::size_t v = 0; v < u_.size(); ++v)
            if (unknown_[v] >= 0) trial_[v] = step * direction_[at(unknown_[v])];
        for (std::size_t s = 0; s < spread.size(); ++s) spread[s] = trial_[at(surface_->orbit[s])];
        trial_disk_ = disk_;
        const FlipCount count =
            make_delaunay<long double>(trial_disk_, spread, FlipRule::ptolemy, workspace_);
        if (!count.finished) continue;
        const double reached = evaluate(trial_disk_, trial_, false);
        double slope = 0.0;
        for (std::size_t v = 0; v < u_.size(); ++v)
            if (unknown_[v] >= 0) slope += direction_[at(unknown_[v])] * curvature_[v];
        // The energy is convex, beyond broken triangles too: its derivative must not have turned positive.
        if (!std::isfinite(reached) || !(slope <= 0.0 || reached <= 0.5 * residual)) continue;
        flips_ += count.flips;
        disk_ = trial_disk_;
        scale(std::vector<long double>(trial_.begin(), trial_.end()));
        return step;
    }
    return 0.0;
}

SolveOutcome PuncturedPlane::flatten(const SolveOptions& options, double floor) {
    SolveOutcome outcome;
    const auto start = std::chrono::steady_clock::now();
    constexpr double kNearlyFlat = 1e-3;  // residual at which angles of the rim are worth a look
    double best = std::numeric_limits<double>::infinity(), step = 0.0;
    int no_progress = 0;
    for (std::int32_t iteration = 0;; ++iteration) {
        do {
            const FlipCount count = make_delaunay<long double>(disk_, {}, FlipRule::ptolemy, workspace_);
            flips_ += count.flips;
            if (!count.finished) return outcome;
        } while (admit());
        const double residual = evaluate(disk_, {}, true);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        outcome.iterations = iteration;
        outcome.residual_max = residual;
        outcome.flips = flips_;
        outcome.log.push_back({iteration, residual, step, flips_, seconds});
        if (options.progress) options.progress(outcome.log.back());
        const auto finish = [&](Status status) {
            outcome.status = status;
            return outcome;
        };
        if (!std::isfinite(residual)) return finish(Status::not_finite);
        no_progress = residual > 0.5 * best ? no_progress + 1 : 0;
        best = std::min(best, residual);
        const bool flat = residual <= options.tolerance || (no_progress >= 2 && residual <= floor);
        if (residual <= kNearlyFlat && release()) {
            best = std::numeric_limits<double>::infinity();
            continue;
        }
        if (flat) return finish(Status::converged);
        if (iteration >= options.max_iterations) return finish(Status::max_iterations);
        if (options.interrupted)
            if (const auto status = options.interrupted()) return finish(*status);
        if (!find_direction(outcome)) return finish(Status::factorization_failed);
        step = line_search(residual);
        if (step == 0.0) return finish(residual <= floor ? Status::converged : Status::stalled);
    }
}

}  // namespace ricci
